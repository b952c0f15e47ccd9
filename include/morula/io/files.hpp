// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files: their exceptions, the table of formats that the library reads and writes, and folders with a file per frame.
#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace morula {

/// The exception for a file that cannot be read or written. what() has the file, the line or byte if known, and a
/// remedy.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The exception for an error of the operating system, such as a missing file; the contents of the file are not its
/// cause.
class SystemFileError : public FileError {
 public:
  /// what() is the file's path, a colon and the problem. error: a value of errno, such as ENOENT for a missing file.
  SystemFileError(const std::filesystem::path& file, const std::string& problem, int error);

  const std::filesystem::path& file() const noexcept { return *file_; }
  /// The value of errno.
  int error() const noexcept { return error_; }

 private:
  std::shared_ptr<const std::filesystem::path> file_;  // shared, because copying an exception must not throw
  int error_;
};

/// A file format for one kind of content.
struct FileFormat {
  std::string extension;     ///< lower case, with the dot: ".obj"
  std::string program;       ///< program or standard that defines the format
  bool is_read, is_written;  ///< the library reads such files; it writes them
  std::string purpose;       ///< content of such a file: "meshes"
};
/// The formats of the library, with an entry for every extension and purpose. read_mesh() and write_mesh() take those
/// for meshes. The extras have tables of their own: robot::output_formats(), clump_formats().
std::vector<FileFormat> file_formats();

/// The paths of the files of a folder whose names match `pattern` and have one of these extensions, in the order of
/// frames: by name, with runs of digits compared as numbers, so frame9 comes before frame10. Hidden files and folders
/// are skipped. The result may be empty.
///
/// pattern: * matches any characters, ? one character. extensions: lower case, with the dot; upper case in a name also
/// matches. Throws FileError if the folder cannot be read, or if a frame is missing: three or more names that differ in
/// their last number alone must increase by equal steps, except for names that the pattern excludes.
std::vector<std::filesystem::path> frame_files(const std::filesystem::path& folder, std::string_view pattern,
                                               const std::set<std::string>& extensions);

}  // namespace morula
