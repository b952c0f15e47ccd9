// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Atomic writes of files and folders. All outputs of the library use them.
//
// Output is written under a hidden name of its own (.morula-*.tmp) next to its target. When it is complete and on the
// disk, it is renamed to the target's name in one step. So a reader never sees half a file, and a failure leaves the
// old file unchanged. A program that is killed may leave hidden files, which have no effect and can be deleted. If the
// target is a symbolic link, the link stays, and the file to which it leads is replaced. The new file takes over owner
// and permissions of the replaced one, as far as the system allows it; without one, it has the permissions of the
// umask.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace morula {

/// Writes a file with exactly these bytes, atomically. Throws FileError if the folder is missing or not writable, the
/// target is not a file, or the disk is full.
void write_whole(const std::filesystem::path& path, std::string_view bytes);

/// A file that is written in parts and appears as a whole. Only one thread may use it at a time.
class WholeFile {
 public:
  /// Creates the hidden file. Throws FileError if the target's folder is missing or not writable, or if the target
  /// exists and is not a file.
  explicit WholeFile(const std::filesystem::path& target);
  /// Removes the hidden file unless commit() was called.
  ~WholeFile();
  WholeFile(WholeFile&& other) noexcept;
  WholeFile& operator=(WholeFile&&) = delete;

  /// Appends bytes. Throws FileError if that fails; the target then stays unchanged.
  void write(std::string_view bytes);
  /// Replaces bytes that write() has written. offset: of the first one, from the beginning of the file. Throws like
  /// write().
  void overwrite(std::uint64_t offset, std::string_view bytes);
  /// Completes the file and renames it to the target. Call it once, last. Throws FileError if that fails; the target
  /// then stays unchanged.
  void commit();

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path named_, target_, temporary_;  // path as given; path with links resolved; empty: none
  int file_ = -1;
};

/// A folder that is filled under a hidden name and appears as a whole. Only one thread may use it at a time.
class WholeFolder {
 public:
  /// The way in which commit() replaces a folder that exists.
  enum class Mode {
    /// The new folder replaces the old one, in one step if the system can exchange two names, otherwise in two steps.
    /// Files that the new one lacks are kept; with them, works like `merge` on Windows. It does so everywhere if
    /// the folder cannot be renamed: if it is a mount point or a current folder, or if its parent is not writable.
    exchange,
    /// New files move into the existing folder one by one; if one fails, all move back. For folders that other programs
    /// use.
    merge,
  };
  /// Creates the hidden folder. Throws FileError if the target exists and is not a folder, or if the hidden folder
  /// cannot be created.
  explicit WholeFolder(const std::filesystem::path& target, Mode mode = Mode::exchange);
  /// Removes the hidden folder unless commit() was called.
  ~WholeFolder();
  WholeFolder(WholeFolder&& other) noexcept;
  WholeFolder& operator=(WholeFolder&&) = delete;

  /// The hidden folder: write files there until commit().
  const std::filesystem::path& path() const { return stage_; }
  /// Completes the folder: its files appear in the target. Call it once, last. Throws FileError if that fails; the
  /// target then stays unchanged, with one exception: if a file of the old folder cannot be kept, the new folder is in
  /// place, and the message says where the file is.
  void commit();

 private:
  void commit_new();
  void commit_by_exchange();
  void commit_by_merging();

  std::filesystem::path named_, target_, stage_;
  bool exists_ = false;
  bool merges_ = false;
};

/// Prepares the end of a program that other threads still write for: removes all hidden files and folders, and makes
/// later calls that begin or commit output block forever. Call it on a thread, not in a signal handler, and call _exit
/// afterwards.
void abandon_unfinished() noexcept;

/// Throws FileError if the disk on which `path` lies has less free space than this number of bytes. The path does not
/// need to exist. Does nothing if the free space is unknown.
void require_room(const std::filesystem::path& path, std::uint64_t bytes);

/// True if both paths exist and lead to the same file or folder, also through links.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace morula
