// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
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
#include "platform/files.hpp"
#include "platform/path_text.hpp"

namespace morula {
using namespace detail;
namespace {

namespace fs = std::filesystem;
using platform::NodeKind;

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
    bits = platform::process_number() << 32 | (++count & 0xffffffffu);
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
  throw FileError(platform::text_of(path) + ": links lead in a circle; name a file");
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Without a trailing separator, which would make the file name empty.
fs::path without_slash(fs::path path) {
  path = path.lexically_normal();
  return path.has_filename() || !path.has_parent_path() ? path : path.parent_path();
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
  if (platform::is_mount_point(folder)) return true;
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
    for (const fs::path& path : registry().paths) platform::remove_unfinished(path);
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
  throw FileError(platform::text_of(path) + ": takes " + gigabytes(bytes) + ", but its disk has " +
                  gigabytes(room.available) + " left; make room, or write less");
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  return platform::is_same_file(a, b);
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
  if (!target.has_filename()) throw SystemFileError(target, "is a folder, not a file; name a file in it", EISDIR);
  target_ = through_links(target);
  const NodeKind kind = platform::kind_of(target_);
  const bool exists = kind != NodeKind::missing;
  if (kind == NodeKind::folder) throw SystemFileError(target, "is a folder, not a file; name a file in it", EISDIR);
  if (exists && kind != NodeKind::file)
    throw FileError(platform::text_of(target) + ": is a device or a pipe, not a file; name a file");

  const std::unique_lock lock = lock_unfinished();
  int error = 0;
  for (int attempt = 0; attempt < most_attempts && file_ < 0; ++attempt) {
    temporary_ = folder_of(target_) / hidden_name();
    // The contents of a private file stay private while it is written.
    file_ = platform::create_file(temporary_, exists, error);
    if (file_ < 0 && error != EEXIST) break;
  }
  if (file_ < 0)
    throw SystemFileError(target,
                          "cannot make a file in this folder (" + reason(error) +
                              "); make the folder first, or choose one that you may write to",
                          error);
  try {
    note_unfinished(temporary_);
  } catch (...) {
    platform::close_file(file_);
    platform::remove_file(temporary_);
    throw;
  }
  if (exists) platform::copy_permissions(target_, file_);
}

WholeFile::WholeFile(WholeFile&& other) noexcept
    : named_(std::move(other.named_)),
      target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      file_(std::exchange(other.file_, -1)) {}

WholeFile::~WholeFile() {
  if (temporary_.empty()) return;
  const std::unique_lock lock = lock_unfinished();
  if (file_ >= 0) platform::close_file(file_);
  platform::remove_file(temporary_);
  forget_unfinished(temporary_);
}

void WholeFile::fail(int error) const {
  throw SystemFileError(named_, "cannot be written (" + reason(error) + "); nothing was changed", error);
}

void WholeFile::write(std::string_view bytes) {
  if (const int error = platform::append(file_, bytes); error != 0) fail(error);
}

void WholeFile::overwrite(std::uint64_t offset, std::string_view bytes) {
  if (const int error = platform::overwrite(file_, offset, bytes); error != 0) fail(error);
}

void WholeFile::commit() {
  // A folder that is itself unfinished is synced to the disk as a whole.
  const fs::path folder = folder_of(target_);
  const bool alone = [&] {
    const std::unique_lock lock = lock_unfinished();
    return !is_unfinished(folder);
  }();
  if (const int error = alone ? platform::sync_file(file_) : 0; error != 0) fail(error);
  if (const int error = platform::close_file(std::exchange(file_, -1)); error != 0) fail(error);
  {
    const std::unique_lock lock = lock_unfinished();
    if (const int error = platform::rename_over(temporary_, target_); error != 0)
      throw SystemFileError(named_, "cannot be replaced (" + reason(error) + "); nothing was changed", error);
    forget_unfinished(temporary_);
    temporary_.clear();
  }
  if (alone) platform::sync_folder(folder);
}

WholeFolder::WholeFolder(const fs::path& target, Mode mode) : named_(target) {
  // Names in it make paths longer.
  target_ = platform::openable(through_links(without_slash(target)), 100);
  const NodeKind kind = platform::kind_of(target_);
  exists_ = kind != NodeKind::missing;
  if (exists_ && kind != NodeKind::folder) throw SystemFileError(target, "is a file; name a folder", ENOTDIR);
  const fs::path parent = folder_of(target_);
  // A folder that cannot be reached may be there: making the hidden folder in it fails, with the reason.
  int why_missing = 0;
  const NodeKind kind_of_parent = platform::kind_of(parent, why_missing);
  if (!exists_ && kind_of_parent == NodeKind::missing && why_missing == ENOENT)
    throw SystemFileError(target, "there is no folder " + platform::text_of(parent) + "; make it first", ENOENT);
  if (!exists_ && kind_of_parent != NodeKind::missing && kind_of_parent != NodeKind::folder)
    throw SystemFileError(target, platform::text_of(parent) + " is a file, not a folder", ENOTDIR);

  merges_ = exists_ && (mode == Mode::merge || stays_where_it_is(target_));
  const std::unique_lock lock = lock_unfinished();
  int why = 0;
  const auto make = [&](const fs::path& place) {
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
      stage_ = place / hidden_name();
      why = platform::create_folder(stage_, exists_);
      if (why != EEXIST) return why == 0;
    }
    return false;
  };
  bool made = make(merges_ ? target_ : parent);
  if (!made && exists_ && !merges_) made = merges_ = make(target_);
  if (!made) {
    stage_.clear();
    throw SystemFileError(target,
                          "cannot make a folder in " + platform::text_of(merges_ ? target_ : parent) + " (" +
                              reason(why) + "); choose one that you may write to",
                          why);
  }
  try {
    note_unfinished(stage_);
  } catch (...) {
    platform::remove_folder(stage_);
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
    if (const int why = platform::sync_file(entry->path()); why != 0)
      throw SystemFileError(named_, "cannot be written (" + reason(why) + "); nothing was changed", why);
  }
  platform::sync_folder(stage_);

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
  platform::sync_folder(merges_ ? target_ : folder_of(target_));
}

void WholeFolder::commit_new() {
  const int error = platform::rename_over(stage_, target_);
  if (error == 0) return;
  throw FileError(platform::text_of(named_) + ": the finished folder cannot take its name (" + reason(error) +
                  "); nothing was changed");
}

void WholeFolder::commit_by_exchange() {
  const auto reject = [&](const std::string& why) {
    throw FileError(platform::text_of(named_) + ": cannot be replaced (" + why + "); nothing was changed");
  };
  std::error_code error;
  std::vector<fs::path> others, linked, later;
  for (const fs::path& name : names_in(target_, error))
    if (!is_there(stage_ / name)) others.push_back(name);
  if (!error && !others.empty() && !platform::has_exchange()) {
    // Other programs may have files open, which can then be neither linked nor moved.
    merges_ = true;
    return commit_by_merging();
  }
  // Files of other programs are in both folders for a moment, so that no crash can lose one.
  for (const fs::path& name : others) {
    (platform::link_file(target_ / name, stage_ / name) == 0 ? linked : later).push_back(name);
  }
  if (error) reject(error.message());
  platform::copy_folder_permissions(target_, stage_);

  fs::path replaced = stage_;
  if (!platform::exchange(stage_, target_)) {
    replaced = folder_of(target_) / hidden_name();
    if (platform::rename_over(target_, replaced) != 0) {
      // On Windows, a folder cannot be renamed while another program has files of it open or works in it.
      for (const fs::path& name : linked) platform::remove_file(stage_ / name);
      merges_ = true;
      return commit_by_merging();
    }
    if (const int why = platform::rename_over(stage_, target_); why != 0) {
      fs::rename(replaced, target_, error);
      reject(reason(why));
    }
  }
  for (const fs::path& name : later) {
    const int why = platform::rename_over(replaced / name, target_ / name);
    if (why == 0) continue;
    forget_unfinished(stage_);
    stage_.clear();
    throw FileError(platform::text_of(named_) + ": " + platform::text_of(name) + " could not be carried over (" +
                    reason(why) + "); it is in " + platform::text_of(replaced) + ", everything else is in place");
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
    throw FileError(platform::text_of(named_) + ": cannot be replaced (" + why + "); nothing was changed");
  }
  fs::remove_all(stage_, error);
}

}  // namespace morula
