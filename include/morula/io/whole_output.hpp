// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files and folders that appear whole or not at all: everything that the library writes goes through here.
//
// What is written stands under a hidden name of its own (.morula-*.tmp, exclusively created) beside its target until it
// is complete and on the disk; then it takes the target's name in one step. Nobody ever reads half a file, a failure
// leaves the old one alone, and what a killed program leaves behind is in nobody's way. A target that is a link stays
// one: what it leads to is replaced. An existing target keeps its permissions; a new one has those of the umask.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace morula {

/// Makes the file hold exactly these bytes. Throws FileError.
void write_whole(const std::filesystem::path& path, std::string_view bytes);

/// A file written piece by piece.
class WholeFile {
 public:
  /// Throws FileError when the folder is missing or may not be written to, or the target is anything but a file.
  explicit WholeFile(const std::filesystem::path& target);
  /// Removes what was not committed.
  ~WholeFile();
  WholeFile(WholeFile&& other) noexcept;
  WholeFile& operator=(WholeFile&&) = delete;

  /// Appends. Throws FileError, and nothing was changed.
  void write(std::string_view bytes);
  /// Puts bytes over some that were written before.
  void overwrite(std::uint64_t offset, std::string_view bytes);
  /// Once, at the end: the file appears. Throws FileError, and nothing was changed.
  void commit();

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path named_, target_, temporary_;  // as the caller says; where its links lead; empty: none
  int file_ = -1;
};

/// A folder filled aside.
class WholeFolder {
 public:
  enum class Mode {
    /// The folder changes in one step, where the system can exchange two names, and else in two. What else is in the
    /// old one is carried over. Where that cannot be (a mount point, the current folder, a parent that may not be
    /// written to) as `merge`.
    exchange,
    /// Files move into a folder that exists one by one; a failure moves them back. For folders that are in use.
    merge,
  };
  /// Throws FileError when the target is not a folder, or cannot be made.
  explicit WholeFolder(const std::filesystem::path& target, Mode mode = Mode::exchange);
  /// Removes what was not committed.
  ~WholeFolder();
  WholeFolder(WholeFolder&& other) noexcept;
  WholeFolder& operator=(WholeFolder&&) = delete;

  /// Where to write until then.
  const std::filesystem::path& path() const { return stage_; }
  /// Once, at the end. Throws FileError, and nothing was changed.
  void commit();

 private:
  void commit_new();
  void commit_by_exchange();
  void commit_by_merging();

  std::filesystem::path named_, target_, stage_;
  bool exists_ = false;
  bool merges_ = false;
};

/// For a program that ends in the middle of its work: removes what is written and not committed, and lets nobody commit
/// or begin anything from then on; whoever tries waits for ever. Call it from a thread, not from a signal handler, and
/// leave with _exit.
void abandon_unfinished() noexcept;

/// Throws FileError when the disk of `path`, which need not exist yet, plainly has no room for so many more bytes.
void require_room(const std::filesystem::path& path, std::uint64_t bytes);

/// Are both there, and one and the same file or folder, whatever links lead to it?
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace morula
