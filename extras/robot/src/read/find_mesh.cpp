// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <morula/robot/robot.hpp>

#include "platform/path_text.hpp"
#include "read/folders.hpp"
#include "read/xml.hpp"

namespace morula::robot {

namespace {

namespace fs = std::filesystem;

bool climbs(const fs::path& path) {
  return std::find(path.begin(), path.end(), "..") != path.end();
}

/// "NAME/PATH" of package://NAME/PATH, without slashes that would make either absolute.
struct PackageFile {
  std::string package;
  fs::path path;
};
PackageFile split(std::string_view text) {
  const auto drop_slashes = [&] { text.remove_prefix(std::min(text.find_first_not_of('/'), text.size())); };
  drop_slashes();
  const std::size_t slash = std::min(text.find('/'), text.size());
  PackageFile file{.package = std::string(text.substr(0, slash)), .path = {}};
  text.remove_prefix(slash);
  drop_slashes();
  file.path = platform::path_of(text).lexically_normal();
  return file;
}

class Search {
 public:
  Search(const fs::path& robot_file, int line, const std::string& name)
      : robot_file_(robot_file), line_(line), name_(name) {}

  /// Whether a file exists and may be opened. A file outside the roots is remembered: a later place may be right.
  bool finds(const fs::path& candidate, const FileRoots& roots) {
    const fs::path plain = fs::absolute(candidate).lexically_normal();
    std::error_code error;
    if (!fs::is_regular_file(plain, error)) {
      if (std::find(searched_.begin(), searched_.end(), plain) == searched_.end()) searched_.push_back(plain);
      return false;
    }
    // mutant robot-file-outside: `(plain, root_option)` -> `(plain, root_option); false`
    if (const std::optional<std::string> outside = roots.refusal(plain, root_option)) {
      if (outside_.empty()) outside_ = fmt::format("is {}, which {}", platform::text_of(plain), *outside);
      return false;
    }
    found_ = plain;
    return true;
  }
  const fs::path& found() const { return found_; }

  [[noreturn]] void reject(const std::string& why) const {
    fail_at(robot_file_, line_, fmt::format("mesh \"{}\" {}", name_, why));
  }
  [[noreturn]] void give_up() const {
    if (!outside_.empty()) reject(outside_);
    std::string text = "is missing; searched:";
    for (const fs::path& path : searched_) text += fmt::format(" {}", platform::text_of(path));
    reject(fmt::format("{}; give the folder that holds its package as a package path", text));
  }

 private:
  const fs::path& robot_file_;
  int line_;
  const std::string& name_;
  std::vector<fs::path> searched_{};
  std::string outside_{};
  fs::path found_{};
};

bool find_in_package(Search& search, const PackageFile& file, const RobotFolders& folders) {
  // mutant robot-package-climbs: `file.package == ".." || climbs(file.path)` -> `false`
  if (file.package == ".." || climbs(file.path)) {
    search.reject("leaves its package by \"..\", which is not followed");
  }
  const FileRoots roots = folders.roots_for_package(file.package);
  for (const fs::path& path : folders.package_paths()) {
    if (search.finds(path / platform::path_of(file.package) / file.path, roots)) return true;
    if (path.filename() == platform::path_of(file.package) && search.finds(path / file.path, roots)) return true;
  }
  // The robot's file lies in a package, and packages lie side by side.
  for (const fs::path& up : folders.levels()) {
    if (search.finds(up / platform::path_of(file.package) / file.path, roots)) return true;
    if (search.finds(up / file.path, roots)) return true;
  }
  return false;
}

/// A path on the machine where it was written: the end of it, from one of its folders on, may exist here.
bool find_end_of(Search& search, const fs::path& written, const RobotFolders& folders) {
  if (climbs(written)) return false;
  const std::vector<fs::path> open = folders.open_levels();
  for (fs::path tail = written; !tail.empty() && tail != ".";) {
    for (const fs::path& up : open) {
      if (search.finds(up / tail, folders.roots())) return true;
    }
    tail = tail.lexically_relative(*tail.begin());
  }
  return false;
}

bool find_by_path(Search& search, const std::string& path, const RobotFolders& folders) {
  const fs::path written = platform::path_of(path).lexically_normal();
  if (written.has_root_directory()) {
    return search.finds(written, folders.roots()) || find_end_of(search, written.relative_path(), folders);
  }
  // A drive, where paths have none.
  if (begins_with_drive(path))
    return find_end_of(search, platform::path_of(path.substr(3)).lexically_normal(), folders);
  if (search.finds(folders.own() / written, folders.roots())) return true;
  const auto& given = folders.package_paths();
  return std::any_of(given.begin(), given.end(),
                     [&](const fs::path& folder) { return search.finds(folder / written, folders.roots()); });
}

}  // namespace

fs::path find_mesh(const std::string& name, const fs::path& robot_file, std::span<const fs::path> package_paths,
                   int line) {
  Search search(robot_file, line, name);
  const RobotFolders folders(robot_file, package_paths);
  const FileReference reference = parse_file_reference(name);
  const bool in_package = reference.scheme == "package" || reference.scheme == "model";
  if (!in_package && !reference.scheme.empty()) search.reject("is not on this disk: save it next to the robot's file");
  for (const std::string& path : reference.paths) {
    if (in_package ? find_in_package(search, split(path), folders) : find_by_path(search, path, folders)) {
      return search.found();
    }
  }
  search.give_up();
}

}  // namespace morula::robot
