// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "batch/bytes.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <functional>
#include <system_error>
#include <vector>

namespace morula::cli {
namespace {
namespace fs = std::filesystem;

class OpenFile {
 public:
  // A FIFO opens at once for a reader that does not wait.
  explicit OpenFile(const fs::path& path) : file_(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY)) {
    if (file_ < 0) error_ = errno;
  }
  ~OpenFile() {
    if (file_ >= 0) close(file_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  // Nothing when all of it was read, else the reason.
  std::optional<std::string> read_all(const std::function<void(std::string_view)>& take) const {
    const auto words = [](int error) { return "cannot be read: " + std::generic_category().message(error); };
    if (file_ < 0) return words(error_);
    struct stat status {};
    if (fstat(file_, &status) != 0) return words(errno);
    if (!S_ISREG(status.st_mode)) return "is no file";
    std::vector<char> part(1 << 16);
    for (;;) {
      const ssize_t count = read(file_, part.data(), part.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return words(errno);
      if (count == 0) return std::nullopt;
      take({part.data(), static_cast<std::size_t>(count)});
    }
  }

 private:
  int file_ = -1, error_ = 0;
};

std::string kind_of_node(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a FIFO";
  if (S_ISSOCK(mode)) return "a socket";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device";
  return "something else";
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
  if (path.native().find('\0') != std::string::npos) return "the name holds a zero byte";
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) {
    if (S_ISREG(status.st_mode)) return std::nullopt;
    return fmt::format("is {}, not a file", kind_of_node(status.st_mode));
  }
  const int error = errno;
  if (error == ELOOP) return "is a link in a circle of links";
  if (error == ENOENT || error == ENOTDIR) {
    std::error_code no_link;
    const fs::path target = fs::read_symlink(path, no_link);
    return no_link ? "there is no such file" : fmt::format("is a link to {}, which is not there", target.string());
  }
  return "cannot be read: " + std::generic_category().message(error);
}

std::optional<std::string> bytes_of_file(const fs::path& path, std::uintmax_t limit) {
  std::string bytes;
  bool fits = true;
  const auto reason = OpenFile(path).read_all([&](std::string_view part) {
    fits = fits && part.size() <= limit - bytes.size();
    if (fits) bytes += part;
  });
  if (reason || !fits) return std::nullopt;
  return bytes;
}

std::optional<std::string> hash_file(const fs::path& path, Hash128& hash) {
  return OpenFile(path).read_all([&](std::string_view part) { hash.take(part); });
}

}  // namespace morula::cli
