// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Atomic writes of files and folders: all outputs of the library use them.
//
// Output is written under a hidden name of its own (.morula-*.tmp, exclusively created) next to its target. When it is
// complete and on the disk, it is renamed to the target's name in one step. So no reader sees half a file, a failure
// leaves the old file unchanged, and remains of a killed program do no harm. If the target is a link, the link stays
// and the file that it leads to is replaced. An existing target keeps its permissions; a new one has those of the
// umask.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace morula {

/// Writes a file with exactly these bytes, atomically. Throws FileError.
void write_whole(const std::filesystem::path& path, std::string_view bytes);

/// A file that is written in parts.
class WholeFile {
 public:
  /// Throws FileError if the folder is missing or not writable, or if the target exists and is not a file.
  explicit WholeFile(const std::filesystem::path& target);
  /// Removes uncommitted output.
  ~WholeFile();
  WholeFile(WholeFile&& other) noexcept;
  WholeFile& operator=(WholeFile&&) = delete;

  /// Appends bytes. Throws FileError, and then changes nothing.
  void write(std::string_view bytes);
  /// Overwrites bytes that were written earlier.
  void overwrite(std::uint64_t offset, std::string_view bytes);
  /// Completes the file, which then appears; called once. Throws FileError, and then changes nothing.
  void commit();

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path named_, target_, temporary_;  // path as given; path with links resolved; empty: none
  int file_ = -1;
};

/// A folder that is filled under a hidden name.
class WholeFolder {
 public:
  enum class Mode {
    /// The folder is replaced in one step if the system can exchange two names, otherwise in two. Other files of the
    /// old folder are carried over. If this is not possible (a mount point, the current folder, a parent that is not
    /// writable), works like `merge`.
    exchange,
    /// Files move into an existing folder one by one; a failure moves them back. For folders that are in use.
    merge,
  };
  /// Throws FileError if the target is not a folder, or cannot be created.
  explicit WholeFolder(const std::filesystem::path& target, Mode mode = Mode::exchange);
  /// Removes uncommitted output.
  ~WholeFolder();
  WholeFolder(WholeFolder&& other) noexcept;
  WholeFolder& operator=(WholeFolder&&) = delete;

  /// The folder to write to until commit().
  const std::filesystem::path& path() const { return stage_; }
  /// Completes the folder; called once. Throws FileError, and then changes nothing.
  void commit();

 private:
  void commit_new();
  void commit_by_exchange();
  void commit_by_merging();

  std::filesystem::path named_, target_, stage_;
  bool exists_ = false;
  bool merges_ = false;
};

/// Prepares a program for its end: removes all uncommitted output, and lets later calls that begin or commit output
/// block forever. To be called from a thread, not from a signal handler, and followed by _exit.
void abandon_unfinished() noexcept;

/// Throws FileError if the disk of `path`, which need not exist yet, clearly has no room for so many more bytes.
void require_room(const std::filesystem::path& path, std::uint64_t bytes);

/// True if both exist and are the same file or folder, through any links.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace morula
