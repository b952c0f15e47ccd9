// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "read/folders.hpp"

#include <algorithm>

#include "platform/files.hpp"
#include "platform/path_text.hpp"

namespace morula::robot {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_levels = 6, most_named_levels = 2;

bool is_package(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / "package.xml", error) || fs::is_regular_file(folder / "model.config", error);
}

/// Without a name at the end, "a/b/" would be a folder "" in a/b.
fs::path plain_path(const fs::path& folder) {
  std::error_code error;
  const fs::path path = fs::absolute(folder.empty() ? fs::path(".") : folder, error).lexically_normal();
  return path.has_filename() || !path.has_relative_path() ? path : path.parent_path();
}

bool holds_home(const fs::path& folder) {
  const fs::path home = platform::home_folder();
  return !home.empty() && FileRoots({folder}).hold(home);
}

/// Whether a folder is too wide: a file in it is no sign that the files next to it belong together.
bool is_too_wide(const fs::path& folder) {
  // mutant robot-around-home: `holds_home(folder)` -> `false`
  return !folder.has_relative_path() || !folder.parent_path().has_relative_path() || holds_home(folder);
}

/// The folder and those above it, without the disk's root.
std::vector<fs::path> levels_from(const fs::path& folder) {
  std::vector<fs::path> levels;
  for (fs::path up = folder; levels.size() <= most_levels && up.has_relative_path(); up = up.parent_path()) {
    levels.push_back(up);
  }
  return levels;
}

fs::path package_around(const fs::path& folder) {
  for (const fs::path& up : levels_from(folder)) {
    if (is_package(up) && !holds_home(up)) return up;
  }
  const fs::path around = folder.parent_path();
  return is_too_wide(around) ? folder : around;
}

}  // namespace

RobotFolders::RobotFolders(const fs::path& robot_file, std::span<const fs::path> package_paths)
    : own_(plain_path(plain_path(robot_file).parent_path())), levels_(levels_from(own_)) {
  if (levels_.empty()) levels_.push_back(own_);
  std::error_code error;
  const fs::path opened = fs::canonical(robot_file, error);
  roots_.add(package_around(own_));
  if (!error) roots_.add(package_around(opened.parent_path()));
  for (const fs::path& path : package_paths) {
    package_paths_.push_back(plain_path(path));
    roots_.add(package_paths_.back());
  }
}

std::vector<fs::path> RobotFolders::open_levels() const {
  std::vector<fs::path> open;
  for (const fs::path& up : levels_) {
    if (roots_.hold(up)) open.push_back(up);
  }
  return open;
}

FileRoots RobotFolders::roots_for_package(const std::string& name) const {
  FileRoots roots = roots_;
  const fs::path folder = platform::path_of(name);
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    const fs::path& up = levels_[i];
    if (i <= most_named_levels && up.filename() == folder && !is_too_wide(up)) roots.add(up);
    if (is_package(up / folder)) roots.add(up / folder);
  }
  return roots;
}

}  // namespace morula::robot
