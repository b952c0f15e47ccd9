// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files that a file names: what the text means, and whether such a file may be opened.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace morula {

/// A text that names a file, as URIs and paths do.
struct FileReference {
  std::string scheme;              ///< lower case, without "://"; empty for a path and for "file"
  std::vector<std::string> paths;  ///< its spellings, to be tried in this order: %XX decoded, and as written
};

/// "file:///a%20b" is the path "/a b", also with the host "localhost". A path is tried as it is written first: a file's
/// name may hold a percent sign. Backslashes behind the letter of a drive become slashes.
FileReference parse_file_reference(std::string_view text);
/// "C:/robots/arm.stl": absolute on the machine where it was written.
bool begins_with_drive(std::string_view path);

/// The file that a text means: of its spellings the first one that is there, else the first. Relative ones are looked
/// for in `folder`.
std::filesystem::path referenced_file(std::string_view text, const std::filesystem::path& folder);

/// The folders in which files have to lie that another file names. All links are resolved before anything is compared:
/// those in the folders' names, and those that a file's name leads through.
class FileRoots {
 public:
  FileRoots() = default;
  /// An empty path is the working folder. Folders that are not there hold nothing.
  explicit FileRoots(const std::vector<std::filesystem::path>& folders);
  void add(const std::filesystem::path& folder);

  bool hold(const std::filesystem::path& file) const;
  /// Nothing where the file may be opened, or is not there at all. Else the reason and the remedy, to stand behind the
  /// file's name: "lies outside A and B; allow its folder with --root DIR". For a folder of frames, DIR is that folder.
  std::optional<std::string> refusal(const std::filesystem::path& file, std::string_view option) const;

 private:
  std::vector<std::filesystem::path> folders_;
};

}  // namespace morula
