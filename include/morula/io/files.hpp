// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files of any kind: their errors, the table of formats that the library reads and writes, and folders with one file
// per frame.
#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace morula {

/// A file that cannot be read or written. what() names the file, the line or byte if known, and a remedy.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A FileError that the system reports, independent of the file's contents.
class SystemFileError : public FileError {
 public:
  /// what() is the file, a colon and the problem. error: an errno; ENOENT for a missing file.
  SystemFileError(const std::filesystem::path& file, const std::string& problem, int error)
      : FileError(file.string() + ": " + problem),
        file_(std::make_shared<const std::filesystem::path>(file)),
        error_(error) {}

  const std::filesystem::path& file() const noexcept { return *file_; }
  /// The errno of the error.
  int error() const noexcept { return error_; }

 private:
  std::shared_ptr<const std::filesystem::path> file_;  // shared, because copying an exception must not throw
  int error_;
};

struct FileFormat {
  std::string extension;  ///< lower case, with the dot
  std::string program;    ///< program that defines the format
  bool is_read, is_written;
  std::string purpose;  ///< content of such a file: "meshes"
};
/// One row for every extension and purpose; read_mesh and write_mesh accept the rows for meshes. Formats of robots and
/// clumps have tables of their own (robot::output_formats, clump_formats).
std::vector<FileFormat> file_formats();

/// Files with one of these extensions (lower case, with the dot) and a name that matches `pattern`, in name order with
/// runs of digits compared as numbers. In a pattern * matches any characters, ? one character. Hidden files are
/// skipped.
///
/// Throws FileError if the folder cannot be read, or if a frame is missing: if names differ in one number only, the
/// numbers must increase in equal steps.
std::vector<std::filesystem::path> frame_files(const std::filesystem::path& folder, std::string_view pattern,
                                               const std::set<std::string>& extensions);

}  // namespace morula
