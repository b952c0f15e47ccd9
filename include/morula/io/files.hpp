// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files of any kind: their errors, the table of formats that the library reads and writes, and folders of one file per
// frame.
#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace morula {

/// A file that cannot be read or written: what() names the file, the line or byte where known, and a remedy.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A FileError whose reason is the system's, not the file's contents.
class SystemFileError : public FileError {
 public:
  /// what() is the file, a colon and the problem. error: an errno; ENOENT for what is not there.
  SystemFileError(const std::filesystem::path& file, const std::string& problem, int error)
      : FileError(file.string() + ": " + problem),
        file_(std::make_shared<const std::filesystem::path>(file)),
        error_(error) {}

  const std::filesystem::path& file() const noexcept { return *file_; }
  /// The errno.
  int error() const noexcept { return error_; }

 private:
  std::shared_ptr<const std::filesystem::path> file_;  // shared, since copying an exception must not throw
  int error_;
};

struct FileFormat {
  std::string extension;  ///< lower case, with the dot
  std::string program;    ///< whose format it is
  bool is_read, is_written;
  std::string purpose;  ///< what is in such a file: "meshes"
};
/// One row for every extension and purpose; those of meshes are the ones that read_mesh and write_mesh take. Formats of
/// robots and clumps have tables of their own (robot::output_formats, clump_formats).
std::vector<FileFormat> file_formats();

/// Files with one of these extensions (lower case, with the dot) whose name matches `pattern`, in name order with runs
/// of digits compared as numbers. In a pattern * stands for any characters, ? for one. Hidden files are left out.
///
/// Throws FileError when the folder cannot be read, and when a frame is missing: where all names are the same but for
/// one number, the numbers have to go up in equal steps.
std::vector<std::filesystem::path> frame_files(const std::filesystem::path& folder, std::string_view pattern,
                                               const std::set<std::string>& extensions);

}  // namespace morula
