// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files that are not there, or that the system refuses.
#pragma once

#include <filesystem>
#include <memory>
#include <morula/io/mesh_file.hpp>
#include <string>

namespace morula {

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

}  // namespace morula
