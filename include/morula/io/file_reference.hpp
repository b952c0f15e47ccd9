// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files that a file names: interpretation of the reference, and permission to open the file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace morula {

/// A reference to a file, like those of URIs and paths.
struct FileReference {
  std::string scheme;              ///< lower case, without "://"; empty for a path and for "file"
  std::vector<std::string> paths;  ///< spellings of the path, to be tried in this order: %XX decoded, and as written
};

/// Parses a reference. "file:///a%20b" is the path "/a b", also with the host "localhost". A plain path is first tried
/// as it is written, because a file's name may contain a percent sign. Backslashes after a drive letter become slashes.
FileReference parse_file_reference(std::string_view text);
/// True for paths like "C:/robots/arm.stl", which are absolute on the machine that wrote them.
bool begins_with_drive(std::string_view path);

/// The file that a reference means: the first of its spellings that exists, otherwise the first spelling. Relative
/// paths start from `folder`.
std::filesystem::path referenced_file(std::string_view text, const std::filesystem::path& folder);

/// The folders that may contain files that another file names. All links are resolved ahead of the comparison, in the
/// folders' names and in the file's name.
class FileRoots {
 public:
  FileRoots() = default;
  /// An empty path is the working folder. A folder that does not exist contains nothing.
  explicit FileRoots(const std::vector<std::filesystem::path>& folders);
  void add(const std::filesystem::path& folder);

  bool hold(const std::filesystem::path& file) const;
  /// No value if the file may be opened or does not exist. Otherwise the reason and the remedy, to follow the file's
  /// name: "lies outside A and B; allow its folder with --root DIR". For a folder of frames, DIR is that folder.
  std::optional<std::string> refusal(const std::filesystem::path& file, std::string_view option) const;

 private:
  std::vector<std::filesystem::path> folders_;
};

}  // namespace morula
