// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/whole_file.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <morula/io/files.hpp>
#include <morula/io/mesh_file.hpp>
#include <system_error>

#include "io/first_bytes.hpp"
#include "parallel/interruption.hpp"
#include "platform/files.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {
namespace fs = std::filesystem;

std::string reason(int error) {
  return platform::reason(error);
}

std::uintmax_t size_of_file(const fs::path& path) {
  const std::string name = platform::text_of(path);
  std::error_code error;
  const fs::path opened = platform::openable(path);
  const fs::file_status status = fs::status(opened, error);
  if (status.type() == fs::file_type::not_found)
    throw SystemFileError(path, "there is no such file; check the name and the folder", ENOENT);
  if (error) throw SystemFileError(path, "cannot be read (" + error.message() + ")", error.value());
  if (fs::is_directory(status)) throw SystemFileError(path, "is a folder, not a file; name a file in it", EISDIR);
  if (!fs::is_regular_file(status)) throw FileError(name + ": is not a regular file; copy its contents to one");
  const std::uintmax_t size = fs::file_size(opened, error);
  if (error) throw SystemFileError(path, "cannot be read (" + error.message() + ")", error.value());
  return size;
}

std::string read_whole(const fs::path& path) {
  return read_part(path, 0, size_of_file(path));
}

std::string read_part(const fs::path& path, std::uintmax_t offset, std::uintmax_t count) {
  const std::string name = platform::text_of(path);
  errno = 0;
  std::ifstream in(platform::openable(path), std::ios::binary);
  if (!in) throw SystemFileError(path, "cannot be opened (" + reason(errno) + ")", errno);
  std::string bytes;
  try {
    bytes.reserve(count);
  } catch (const std::exception&) {
    throw FileError(name + ": " + std::to_string(count) + " bytes of it are too many for this machine's memory");
  }
  in.seekg(static_cast<std::streamoff>(offset));
  while (bytes.size() < count) {
    check_interrupt();
    const std::size_t before = bytes.size();
    bytes.resize(static_cast<std::size_t>(std::min<std::uintmax_t>(count, before + bytes_per_look)));
    in.read(bytes.data() + before, static_cast<std::streamsize>(bytes.size() - before));
    if (!in)
      throw FileError(name + ": reading stopped after " + std::to_string(offset) + " + " +
                      std::to_string(before + static_cast<std::size_t>(in.gcount())) +
                      " bytes; the disk failed, or another program is writing the file");
  }
  if (offset == 0 && is_lfs_pointer(bytes)) throw FileError(name + ": " + std::string(lfs_remedy));
  return bytes;
}

std::string lower_extension(const fs::path& path) {
  std::string extension = platform::text_of(path.extension());
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result = "'";
  for (const char c : text.substr(0, longest)) result += c >= ' ' && c <= '~' ? c : '?';
  return result + (text.size() > longest ? "…'" : "'");
}

}  // namespace morula::detail
