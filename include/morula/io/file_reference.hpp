// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// References from one file to another, such as a mesh that a robot's file names: their parts, the file that they mean,
// and the folders in which such a file may be opened.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace morula {

/// A reference to a file, divided into its parts: a URI ("package://arm/base.stl", "file:///a.stl") or a path.
struct FileReference {
  std::string scheme;  ///< lower case, without "://"; empty for a path and for "file"
  /// Spellings of the path, one or two, in the order in which to try them. For a URI: with each %XX decoded, then as
  /// written. For a path: as written, then decoded.
  std::vector<std::string> paths;
};

/// Parses a reference. "file:///a%20b", "file:/a%20b" and "file://localhost/a%20b" are the path "/a b". A path comes
/// first as it is written, because a file's name may contain a percent sign. %00 is not decoded. If the path begins
/// with a drive, its backslashes become slashes.
FileReference parse_file_reference(std::string_view text);
/// True for paths that begin with a letter, a colon and a slash or backslash, such as "C:/robots/arm.stl": they are
/// absolute on the Windows machine that wrote them.
bool begins_with_drive(std::string_view path);

/// The path of the file that a reference means: its first spelling that exists, otherwise its first spelling. Relative
/// paths start from `folder`. A reference with another scheme than "file" counts as a path.
std::filesystem::path referenced_file(std::string_view text, const std::filesystem::path& folder);

/// Folders in which files that another file names may be opened, with all folders below them. Symbolic links are
/// resolved in the folders' paths and in the file's path before they are compared, so a link cannot lead out of the
/// folders.
class FileRoots {
 public:
  FileRoots() = default;
  /// Adds each of the folders.
  explicit FileRoots(const std::vector<std::filesystem::path>& folders);
  /// Adds a folder and all folders below it. An empty path is the working folder.
  void add(const std::filesystem::path& folder);

  /// True if the file is in one of the folders, or would be if it existed.
  bool hold(const std::filesystem::path& file) const;
  /// The reason why a file must not be opened, and the remedy; no value if it is in one of the folders or does not
  /// exist. The text continues a sentence that begins with the file's name: "lies outside A and B; allow its folder
  /// with --root DIR". option: name of the option in this text, here "--root". DIR is the folder of the file; for a
  /// folder, such as one with a file per frame, it is the folder itself.
  std::optional<std::string> refusal(const std::filesystem::path& file, std::string_view option) const;

 private:
  std::vector<std::filesystem::path> folders_;
};

}  // namespace morula
