// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "batch/bytes.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <functional>
#include <platform/files.hpp>
#include <system_error>

namespace morula::cli {
namespace {
namespace fs = std::filesystem;

// Nothing when all of it was read, else the reason.
std::optional<std::string> read_all(const fs::path& path, const std::function<void(std::string_view)>& take) {
  bool is_file = false;
  const int error = platform::read_file(path, take, is_file);
  if (error != 0) return "cannot be read: " + platform::reason(error);
  if (!is_file) return "is no file";
  return std::nullopt;
}

std::string text_of(platform::NodeKind kind) {
  switch (kind) {
    case platform::NodeKind::folder:
      return "a folder";
    case platform::NodeKind::pipe:
      return "a FIFO";
    case platform::NodeKind::socket:
      return "a socket";
    case platform::NodeKind::device:
      return "a device";
    default:
      return "something else";
  }
}

}  // namespace

void Hash128::take(std::string_view bytes) {
  for (const char byte : bytes)
    for (std::uint64_t& h : hash_) h = (h ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
}

std::string Hash128::text() const {
  return fmt::format("{:016x}{:016x}", hash_[0], hash_[1]);
}

std::string hash_of_bytes(std::string_view bytes) {
  Hash128 hash;
  hash.take(bytes);
  return hash.text();
}

std::optional<std::string> why_no_file(const fs::path& path) {
  if (path.native().find(fs::path::value_type{}) != fs::path::string_type::npos) return "the name holds a zero byte";
  int error = 0;
  const platform::NodeKind kind = platform::kind_of(path, error);
  if (kind == platform::NodeKind::file) return std::nullopt;
  if (kind != platform::NodeKind::missing) return fmt::format("is {}, not a file", text_of(kind));
  if (error == ELOOP) return "is a link in a circle of links";
  if (error == ENOENT || error == ENOTDIR) {
    std::error_code no_link;
    const fs::path target = fs::read_symlink(path, no_link);
    return no_link ? "there is no such file" : fmt::format("is a link to {}, which is not there", target.string());
  }
  return "cannot be read: " + platform::reason(error);
}

std::optional<std::string> bytes_of_file(const fs::path& path, std::uintmax_t limit) {
  std::string bytes;
  bool fits = true;
  const auto reason = read_all(path, [&](std::string_view part) {
    fits = fits && part.size() <= limit - bytes.size();
    if (fits) bytes += part;
  });
  if (reason || !fits) return std::nullopt;
  return bytes;
}

std::optional<std::string> hash_file(const fs::path& path, Hash128& hash) {
  return read_all(path, [&](std::string_view part) { hash.take(part); });
}

}  // namespace morula::cli
