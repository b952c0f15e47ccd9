// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#ifdef __linux__
#include <sys/syscall.h>
#endif
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <system_error>
#include <vector>

namespace morula::platform {
namespace {

int result(int status) {
  return status == 0 ? 0 : errno;
}

NodeKind kind_of_mode(mode_t mode) {
  if (S_ISREG(mode)) return NodeKind::file;
  if (S_ISDIR(mode)) return NodeKind::folder;
  if (S_ISFIFO(mode)) return NodeKind::pipe;
  if (S_ISSOCK(mode)) return NodeKind::socket;
  if (S_ISCHR(mode) || S_ISBLK(mode)) return NodeKind::device;
  return NodeKind::other;
}

void set_permissions(int file, const struct stat& old) {
  if (fchown(file, old.st_uid, old.st_gid) != 0) {
    // A file of another user may still keep its group.
    const int ignored = fchown(file, static_cast<uid_t>(-1), old.st_gid);
    static_cast<void>(ignored);
  }
  fchmod(file, old.st_mode & 07777);
}

}  // namespace

Path openable(const Path& path, std::size_t) {
  return path;
}

NodeKind kind_of(const Path& path, int& error) {
  struct stat status {};
  error = result(stat(path.c_str(), &status));
  return error == 0 ? kind_of_mode(status.st_mode) : NodeKind::missing;
}

NodeKind kind_of(const Path& path) {
  int ignored = 0;
  return kind_of(path, ignored);
}

std::string reason(int error) {
  return std::generic_category().message(error);
}

bool is_same_file(const Path& a, const Path& b) {
  struct stat of_a {
  }, of_b{};
  return stat(a.c_str(), &of_a) == 0 && stat(b.c_str(), &of_b) == 0 && of_a.st_dev == of_b.st_dev &&
         of_a.st_ino == of_b.st_ino;
}

int create_file(const Path& path, bool is_private, int& error) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, is_private ? 0600 : 0666);
  error = file < 0 ? errno : 0;
  return file;
}

int create_folder(const Path& path, bool is_private) {
  return result(mkdir(path.c_str(), is_private ? 0700 : 0777));
}

int append(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return 0;
}

int overwrite(int file, std::uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
  return 0;
}

int sync_file(int file) {
#ifdef F_FULLFSYNC
  // macOS: fsync() leaves the bytes in the disk's own memory.
  if (fcntl(file, F_FULLFSYNC) == 0) return 0;
#endif
  if (fsync(file) == 0) return 0;
  const bool cannot_sync = errno == EINVAL || errno == ENOTSUP || errno == EROFS || errno == EBADF || errno == ENOSYS;
  return cannot_sync ? 0 : errno;
}

int sync_file(const Path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  const int error = sync_file(file);
  close(file);
  return error;
}

void sync_folder(const Path& folder) {
  const int opened = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) return;
  fsync(opened);
  close(opened);
}

int close_file(int file) {
  return result(close(file));
}

int remove_file(const Path& path) {
  return result(unlink(path.c_str()));
}

int remove_folder(const Path& path) {
  return result(rmdir(path.c_str()));
}

void remove_unfinished(const Path& path) {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

void copy_permissions(const Path& from, int to_file) {
  struct stat old {};
  if (stat(from.c_str(), &old) == 0) set_permissions(to_file, old);
}

void copy_folder_permissions(const Path& from, const Path& to) {
  const int folder = open(to.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  copy_permissions(from, folder);
  close(folder);
}

int rename_over(const Path& from, const Path& to) {
  return result(rename(from.c_str(), to.c_str()));
}

bool exchange(const Path& a, const Path& b) {
#if defined(__linux__) && defined(SYS_renameat2)
  constexpr unsigned rename_exchange = 2;
  return syscall(SYS_renameat2, AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), rename_exchange) == 0;
#elif defined(__APPLE__)
  return renamex_np(a.c_str(), b.c_str(), RENAME_SWAP) == 0;
#else
  static_cast<void>(a), static_cast<void>(b);
  return false;
#endif
}

bool has_exchange() {
  return true;
}

int link_file(const Path& file, const Path& name) {
  return result(linkat(AT_FDCWD, file.c_str(), AT_FDCWD, name.c_str(), 0));
}

bool is_mount_point(const Path& folder) {
  struct stat own {
  }, above{};
  if (stat(folder.c_str(), &own) != 0 || stat((folder / "..").c_str(), &above) != 0) return true;
  return own.st_dev != above.st_dev || own.st_ino == above.st_ino;
}

int read_file(const Path& path, const std::function<void(std::string_view)>& take, bool& is_file) {
  is_file = true;
  // A FIFO opens at once for a reader that does not wait.
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  if (file < 0) return errno;
  struct Closer {
    int file;
    ~Closer() { close(file); }
  } const closer{file};
  struct stat status {};
  if (fstat(file, &status) != 0) return errno;
  is_file = S_ISREG(status.st_mode);
  std::vector<char> part(1 << 16);
  while (is_file) {
    const ssize_t count = read(file, part.data(), part.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    if (count == 0) break;
    take({part.data(), static_cast<std::size_t>(count)});
  }
  return 0;
}

Path home_folder() {
  const char* const home = std::getenv("HOME");
  return home == nullptr ? "" : home;
}

std::vector<Path> listed_folders(const char* variable) {
  const char* const value = std::getenv(variable);
  std::vector<Path> folders;
  std::istringstream names(value == nullptr ? "" : value);
  for (std::string name; std::getline(names, name, ':');)
    if (!name.empty()) folders.emplace_back(name);
  return folders;
}

std::uint64_t process_number() {
  return static_cast<std::uint64_t>(getpid());
}

}  // namespace morula::platform
