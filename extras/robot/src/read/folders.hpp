// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Folders around a robot's file, and the folders among them whose files it may name.
#pragma once

#include <filesystem>
#include <morula/io/file_reference.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace morula::robot {

/// By default a robot's file may name files in its package: the nearest folder, its own or one of the six above, that
/// holds package.xml or model.config. A file outside any package may name files in the folder around its own, unless
/// that is a home folder, holds one, or is the disk's root or directly in it. A file that is opened through a link has
/// these folders of both places.
///
/// A reference package://NAME/PATH or model://NAME/PATH may also lead into a folder NAME that is a package next to one
/// of these folders, and into the own folder or one of the two above it if that is called NAME and is no home.
class RobotFolders {
 public:
  RobotFolders(const std::filesystem::path& robot_file, std::span<const std::filesystem::path> package_paths);

  /// The folder of the robot's file.
  const std::filesystem::path& own() const { return own_; }
  /// The package paths given by the user.
  const std::vector<std::filesystem::path>& package_paths() const { return package_paths_; }
  /// The own folder and the six above it.
  const std::vector<std::filesystem::path>& levels() const { return levels_; }
  /// The folders of levels() in which all files may be named.
  std::vector<std::filesystem::path> open_levels() const;

  const FileRoots& roots() const { return roots_; }
  FileRoots roots_for_package(const std::string& name) const;

 private:
  std::filesystem::path own_;
  std::vector<std::filesystem::path> package_paths_, levels_;
  FileRoots roots_;
};

/// What allows further folders: an option of the command and an argument of the library.
inline constexpr std::string_view root_option = "the package path";

}  // namespace morula::robot
