// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <morula/io/files.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/whole_output.hpp>
#include <mutex>
#include <random>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "io/whole_file.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

namespace fs = std::filesystem;

constexpr int most_attempts = 100;
constexpr int most_links = 40;  // the system's limit of links to follow

// Hidden names that the process would leave behind if it ended, and the lock for changes of them.
struct Registry {
  std::mutex mutex;
  std::set<fs::path> paths;
};
// It is never destroyed: threads may end after main.
Registry& registry() {
  static Registry& all = *new Registry;
  return all;
}

// Held while a name appears, is replaced or disappears: a thread that abandons the rest then sees all of a change or
// none of it.
std::unique_lock<std::mutex> lock_unfinished() {
  return std::unique_lock(registry().mutex);
}
// The lock is held in all of these.
void note_unfinished(const fs::path& path) {
  registry().paths.insert(path);
}
void forget_unfinished(const fs::path& path) noexcept {
  registry().paths.erase(path);
}
bool is_unfinished(const fs::path& path) {
  return registry().paths.count(path) != 0;
}

/// A name that no thread or process shares: 64 random bits.
fs::path hidden_name() {
  static thread_local std::uint64_t count = 0;
  std::uint64_t bits = 0;
  try {
    std::random_device device;
    bits = std::uint64_t{device()} << 32 | device();
  } catch (const std::exception&) {
    // Without a source of randomness the process and a count are sufficient, because creation is exclusive.
    bits = static_cast<std::uint64_t>(getpid()) << 32 | (++count & 0xffffffffu);
  }
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(bits));
  return ".morula-" + std::string(digits.data()) + ".tmp";
}

/// The target of a path that is a link; the target need not exist.
fs::path through_links(const fs::path& path) {
  fs::path at = path;
  for (int links = 0; links < most_links; ++links) {
    std::error_code not_a_link;
    const fs::path to = fs::read_symlink(at, not_a_link);
    if (not_a_link) return at;
    at = to.is_absolute() ? to : at.parent_path() / to;
  }
  throw FileError(path.string() + ": links lead in a circle; name a file");
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Without a trailing separator, which would make the file name empty.
fs::path without_slash(fs::path path) {
  path = path.lexically_normal();
  return path.has_filename() || !path.has_parent_path() ? path : path.parent_path();
}

/// Some file systems cannot sync and return an error for it, which is no failure.
bool sync_failed(int file) {
  if (fsync(file) == 0) return false;
  return errno != EINVAL && errno != ENOTSUP && errno != EROFS && errno != EBADF && errno != ENOSYS;
}

/// A rename survives a crash only if its folder is also synced. The files in the folder are safe in any case.
void sync_folder(const fs::path& folder) {
  const int opened = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) return;
  fsync(opened);
  close(opened);
}

/// Copies owner and permissions of the replaced file, as far as this user may set them.
void take_over(int file, const struct stat& old) {
  if (fchown(file, old.st_uid, old.st_gid) != 0) {
    // A file of another user may still keep its group.
    const int ignored = fchown(file, static_cast<uid_t>(-1), old.st_gid);
    static_cast<void>(ignored);
  }
  fchmod(file, old.st_mode & 07777);
}

bool exchange(const fs::path& a, const fs::path& b) {
#if defined(__linux__) && defined(SYS_renameat2)
  constexpr unsigned rename_exchange = 2;
  return syscall(SYS_renameat2, AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), rename_exchange) == 0;
#else
  static_cast<void>(a), static_cast<void>(b);
  return false;
#endif
}

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::symlink_status(path, ignored).type() != fs::file_type::not_found;
}

std::vector<fs::path> names_in(const fs::path& folder, std::error_code& error) {
  std::vector<fs::path> names;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator(); entry.increment(error))
    names.push_back(entry->path().filename());
  return names;
}

/// A folder of another file system, or the current folder of this or the calling process, cannot be renamed.
bool stays_where_it_is(const fs::path& folder) {
  struct stat own {
  }, above{};
  if (stat(folder.c_str(), &own) != 0 || stat((folder / "..").c_str(), &above) != 0) return true;
  if (own.st_dev != above.st_dev || own.st_ino == above.st_ino) return true;
  std::error_code error;
  for (fs::path at = fs::current_path(error); !error; at = at.parent_path()) {
    if (is_same_file(at, folder)) return true;
    if (!at.has_relative_path()) return false;
  }
  return true;
}

}  // namespace

void abandon_unfinished() noexcept {
  try {
    std::unique_lock lock = lock_unfinished();
    for (const fs::path& path : registry().paths) {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
    lock.release();  // forever
  } catch (const std::exception&) {
    // The remaining files are hidden and harmless.
  }
}

void require_room(const fs::path& path, std::uint64_t bytes) {
  fs::path at = folder_of(path);
  std::error_code error;
  while (!fs::is_directory(at, error) && at.has_relative_path()) at = folder_of(at);
  const fs::space_info room = fs::space(at, error);
  if (error || room.available == static_cast<std::uintmax_t>(-1) || bytes <= room.available) return;
  const auto gigabytes = [](std::uint64_t count) {
    std::array<char, 32> text{};
    char* const end = text.data() + text.size();
    const double value = 1e-9 * static_cast<double>(count);
    return std::string(text.data(), std::to_chars(text.data(), end, value, std::chars_format::general, 3).ptr) + " GB";
  };
  throw FileError(path.string() + ": takes " + gigabytes(bytes) + ", but its disk has " + gigabytes(room.available) +
                  " left; make room, or write less");
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  struct stat of_a {
  }, of_b{};
  return stat(a.c_str(), &of_a) == 0 && stat(b.c_str(), &of_b) == 0 && of_a.st_dev == of_b.st_dev &&
         of_a.st_ino == of_b.st_ino;
}

void write_whole(const fs::path& path, std::string_view bytes) {
  WholeFile file(path);
  for (std::size_t done = 0; done < bytes.size(); done += bytes_per_look) {
    check_interrupt();
    file.write(bytes.substr(done, bytes_per_look));
  }
  file.commit();
}

WholeFile::WholeFile(const fs::path& target) : named_(target) {
  const std::string name = target.string();
  if (!target.has_filename()) throw SystemFileError(target, "is a folder, not a file; name a file in it", EISDIR);
  target_ = through_links(target);
  struct stat old {};
  const bool exists = stat(target_.c_str(), &old) == 0;
  if (exists && S_ISDIR(old.st_mode))
    throw SystemFileError(target, "is a folder, not a file; name a file in it", EISDIR);
  if (exists && !S_ISREG(old.st_mode)) throw FileError(name + ": is a device or a pipe, not a file; name a file");

  const std::unique_lock lock = lock_unfinished();
  for (int attempt = 0; attempt < most_attempts && file_ < 0; ++attempt) {
    temporary_ = folder_of(target_) / hidden_name();
    // The contents of a private file stay private while it is written.
    file_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, exists ? 0600 : 0666);
    if (file_ < 0 && errno != EEXIST) break;
  }
  if (file_ < 0)
    throw SystemFileError(target,
                          "cannot make a file in this folder (" + reason(errno) +
                              "); make the folder first, or choose one that you may write to",
                          errno);
  try {
    note_unfinished(temporary_);
  } catch (...) {
    close(file_);
    unlink(temporary_.c_str());
    throw;
  }
  if (exists) take_over(file_, old);
}

WholeFile::WholeFile(WholeFile&& other) noexcept
    : named_(std::move(other.named_)),
      target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      file_(std::exchange(other.file_, -1)) {}

WholeFile::~WholeFile() {
  if (temporary_.empty()) return;
  const std::unique_lock lock = lock_unfinished();
  if (file_ >= 0) close(file_);
  unlink(temporary_.c_str());
  forget_unfinished(temporary_);
}

void WholeFile::fail(int error) const {
  throw SystemFileError(named_, "cannot be written (" + reason(error) + "); nothing was changed", error);
}

void WholeFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void WholeFile::overwrite(std::uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
}

void WholeFile::commit() {
  // A folder that is itself unfinished is synced to the disk as a whole.
  const fs::path folder = folder_of(target_);
  const bool alone = [&] {
    const std::unique_lock lock = lock_unfinished();
    return !is_unfinished(folder);
  }();
  if (alone && sync_failed(file_)) fail(errno);
  if (close(std::exchange(file_, -1)) != 0) fail(errno);
  {
    const std::unique_lock lock = lock_unfinished();
    if (rename(temporary_.c_str(), target_.c_str()) != 0)
      throw SystemFileError(named_, "cannot be replaced (" + reason(errno) + "); nothing was changed", errno);
    forget_unfinished(temporary_);
    temporary_.clear();
  }
  if (alone) sync_folder(folder);
}

WholeFolder::WholeFolder(const fs::path& target, Mode mode) : named_(target) {
  const std::string name = target.string();
  target_ = through_links(without_slash(target));
  struct stat old {};
  exists_ = stat(target_.c_str(), &old) == 0;
  if (exists_ && !S_ISDIR(old.st_mode)) throw SystemFileError(target, "is a file; name a folder", ENOTDIR);
  const fs::path parent = folder_of(target_);
  std::error_code error;
  if (!exists_ && !fs::is_directory(parent, error))
    throw SystemFileError(target, "there is no folder " + parent.string() + "; make it first", ENOENT);

  merges_ = exists_ && (mode == Mode::merge || stays_where_it_is(target_));
  const std::unique_lock lock = lock_unfinished();
  const auto make = [&](const fs::path& place) {
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
      stage_ = place / hidden_name();
      if (mkdir(stage_.c_str(), exists_ ? 0700 : 0777) == 0) return true;
      if (errno != EEXIST) return false;
    }
    return false;
  };
  bool made = make(merges_ ? target_ : parent);
  if (!made && exists_ && !merges_) made = merges_ = make(target_);
  if (!made) {
    const int why = errno;
    stage_.clear();
    throw SystemFileError(target,
                          "cannot make a folder in " + (merges_ ? target_ : parent).string() + " (" + reason(why) +
                              "); choose one that you may write to",
                          why);
  }
  try {
    note_unfinished(stage_);
  } catch (...) {
    rmdir(stage_.c_str());
    throw;
  }
}

WholeFolder::WholeFolder(WholeFolder&& other) noexcept
    : named_(std::move(other.named_)),
      target_(std::move(other.target_)),
      stage_(std::exchange(other.stage_, {})),
      exists_(other.exists_),
      merges_(other.merges_) {}

WholeFolder::~WholeFolder() {
  if (stage_.empty()) return;
  const std::unique_lock lock = lock_unfinished();
  std::error_code ignored;
  fs::remove_all(stage_, ignored);
  forget_unfinished(stage_);
}

void WholeFolder::commit() {
  std::error_code error;
  for (fs::recursive_directory_iterator entry(stage_, error); !error && entry != fs::recursive_directory_iterator();
       entry.increment(error)) {
    if (!entry->is_regular_file(error)) continue;
    const int file = open(entry->path().c_str(), O_RDONLY | O_CLOEXEC);
    const bool failed = file >= 0 && sync_failed(file);
    const int why = errno;
    if (file >= 0) close(file);
    if (failed) throw SystemFileError(named_, "cannot be written (" + reason(why) + "); nothing was changed", why);
  }
  sync_folder(stage_);

  const fs::path stage = stage_;
  const std::unique_lock lock = lock_unfinished();
  if (!exists_) {
    commit_new();
  } else if (merges_) {
    commit_by_merging();
  } else {
    commit_by_exchange();
  }
  forget_unfinished(stage);
  stage_.clear();
  sync_folder(merges_ ? target_ : folder_of(target_));
}

void WholeFolder::commit_new() {
  if (rename(stage_.c_str(), target_.c_str()) == 0) return;
  throw FileError(named_.string() + ": the finished folder cannot take its name (" + reason(errno) +
                  "); nothing was changed");
}

void WholeFolder::commit_by_exchange() {
  const auto reject = [&](const std::string& why) {
    throw FileError(named_.string() + ": cannot be replaced (" + why + "); nothing was changed");
  };
  // Files of other programs are in both folders for a moment, so that no crash can lose one.
  std::vector<fs::path> later;
  std::error_code error;
  for (const fs::path& name : names_in(target_, error)) {
    if (is_there(stage_ / name)) continue;
    const bool linked = linkat(AT_FDCWD, (target_ / name).c_str(), AT_FDCWD, (stage_ / name).c_str(), 0) == 0;
    if (!linked) later.push_back(name);
  }
  if (error) reject(error.message());
  struct stat old {};
  const int folder = open(stage_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    if (stat(target_.c_str(), &old) == 0) take_over(folder, old);
    close(folder);
  }

  fs::path replaced = stage_;
  if (!exchange(stage_, target_)) {
    replaced = folder_of(target_) / hidden_name();
    if (rename(target_.c_str(), replaced.c_str()) != 0) reject(reason(errno));
    if (rename(stage_.c_str(), target_.c_str()) != 0) {
      const int why = errno;
      fs::rename(replaced, target_, error);
      reject(reason(why));
    }
  }
  for (const fs::path& name : later) {
    if (rename((replaced / name).c_str(), (target_ / name).c_str()) == 0) continue;
    const int why = errno;
    forget_unfinished(stage_);
    stage_.clear();
    throw FileError(named_.string() + ": " + name.string() + " could not be carried over (" + reason(why) +
                    "); it is in " + replaced.string() + ", everything else is in place");
  }
  fs::remove_all(replaced, error);
}

void WholeFolder::commit_by_merging() {
  const fs::path aside = stage_ / hidden_name();
  std::error_code error;
  const std::vector<fs::path> names = names_in(stage_, error);
  if (!error) fs::create_directory(aside, error);
  std::size_t done = 0;
  bool was_there = false;
  for (; !error && done < names.size(); ++done) {
    was_there = is_there(target_ / names[done]);
    if (was_there) fs::rename(target_ / names[done], aside / names[done], error);
    if (error) was_there = false;
    if (!error) fs::rename(stage_ / names[done], target_ / names[done], error);
    if (error) break;
  }
  if (error) {
    const std::string why = error.message();
    if (was_there) fs::rename(aside / names[done], target_ / names[done], error);
    while (done-- > 0) {
      fs::rename(target_ / names[done], stage_ / names[done], error);
      if (is_there(aside / names[done])) fs::rename(aside / names[done], target_ / names[done], error);
    }
    throw FileError(named_.string() + ": cannot be replaced (" + why + "); nothing was changed");
  }
  fs::remove_all(stage_, error);
}

}  // namespace morula
