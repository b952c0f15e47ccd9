// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/whole_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <morula/io/mesh_file.hpp>
#include <system_error>
#include <utility>

namespace morula {
namespace {

namespace fs = std::filesystem;

std::string reason(int error) {
  return std::generic_category().message(error);
}

class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target) {
    // Exclusive creation finds a free name whoever else is writing here; leftovers of a crash are stepped over.
    constexpr int most_attempts = 1000;
    for (int n = 0; n < most_attempts && !file_; ++n) {
      path_ = fs::path(target).replace_filename(".morula-" + std::to_string(n) + ".tmp");
      errno = 0;
      file_ = std::fopen(path_.string().c_str(), "wbx");
      if (!file_ && errno != EEXIST) break;
    }
    if (!file_)
      throw FileError(target.string() + ": cannot make a file in this folder (" + reason(errno) +
                      "); make the folder first, or choose one that you may write to");
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (file_) std::fclose(file_);
    std::error_code ignored;
    if (!path_.empty()) fs::remove(path_, ignored);
  }

  bool write(std::string_view bytes) { return std::fwrite(bytes.data(), 1, bytes.size(), file_) == bytes.size(); }
  bool close() { return std::fclose(std::exchange(file_, nullptr)) == 0; }
  std::error_code rename_to(const fs::path& target) {
    std::error_code error;
    fs::rename(path_, target, error);
    if (!error) path_.clear();
    return error;
  }

 private:
  fs::path path_;
  std::FILE* file_ = nullptr;
};

}  // namespace

std::uintmax_t size_of_file(const fs::path& path) {
  const std::string name = path.string();
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found)
    throw FileError(name + ": there is no such file; check the name and the folder");
  if (error) throw FileError(name + ": cannot be read (" + error.message() + ")");
  if (fs::is_directory(status)) throw FileError(name + ": is a folder, not a file; name a file in it");
  if (!fs::is_regular_file(status)) throw FileError(name + ": is not a regular file; copy its contents to one");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw FileError(name + ": cannot be read (" + error.message() + ")");
  return size;
}

std::string read_whole(const fs::path& path) {
  return read_part(path, 0, size_of_file(path));
}

std::string read_part(const fs::path& path, std::uintmax_t offset, std::uintmax_t count) {
  const std::string name = path.string();
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw FileError(name + ": cannot be opened (" + reason(errno) + ")");
  std::string bytes;
  try {
    bytes.resize(count);
  } catch (const std::exception&) {
    throw FileError(name + ": " + std::to_string(count) + " bytes of it are too many for this machine's memory");
  }
  in.seekg(static_cast<std::streamoff>(offset));
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  if (!in)
    throw FileError(name + ": reading stopped after " + std::to_string(offset) + " + " + std::to_string(in.gcount()) +
                    " bytes; the disk failed, or another program is writing the file");
  return bytes;
}

void write_whole(const fs::path& path, std::string_view bytes) {
  const std::string name = path.string();
  std::error_code error;
  if (!path.has_filename() || fs::is_directory(path, error))
    throw FileError(name + ": is a folder, not a file; name a file in it");
  TemporaryFile file(path);
  errno = 0;
  if (!file.write(bytes) || !file.close())
    throw FileError(name + ": cannot be written (" + reason(errno) + "); nothing was changed");
  if (const std::error_code failed = file.rename_to(path))
    throw FileError(name + ": cannot be replaced (" + failed.message() + "); nothing was changed");
}

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
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

}  // namespace morula
