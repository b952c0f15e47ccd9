// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <morula/robot/robot.hpp>

#include "robot/read/xml.hpp"

namespace morula::robot {

namespace {

namespace fs = std::filesystem;

bool climbs(const fs::path& path) {
  return std::find(path.begin(), path.end(), "..") != path.end();
}

bool lies_in(const fs::path& file, const fs::path& folder) {
  const auto [end, ignored] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return end == folder.end() || (std::next(end) == folder.end() && end->empty());
}

/// What begins with one of these says which package, or that it is a path.
std::string_view without(std::string_view text, std::string_view scheme) {
  text.remove_prefix(scheme.size());
  return text;
}

struct Search {
  const fs::path& robot_file;
  int line;
  const std::string& name;
  std::vector<fs::path> searched{};

  bool finds(const fs::path& candidate) {
    const fs::path plain = candidate.lexically_normal();
    std::error_code error;
    if (fs::is_regular_file(plain, error)) return true;
    if (std::find(searched.begin(), searched.end(), plain) == searched.end()) searched.push_back(plain);
    return false;
  }

  [[noreturn]] void refuse(const std::string& why) const {
    fail_at(robot_file, line, fmt::format("mesh \"{}\" {}", name, why));
  }

  [[noreturn]] void give_up() const {
    std::string text = "is missing; searched:";
    for (const fs::path& path : searched) text += fmt::format(" {}", path.string());
    refuse(text + "; name the folder that holds its package with --package-path");
  }
};

}  // namespace

fs::path find_mesh(const std::string& name, const fs::path& robot_file, std::span<const fs::path> package_paths,
                   int line) {
  Search search{robot_file, line, name};
  const fs::path folder = fs::absolute(robot_file).parent_path().lexically_normal();
  std::string_view rest = name;
  std::string package;
  const bool in_package = rest.starts_with("package://") || rest.starts_with("model://");
  if (in_package) {
    rest = without(rest, rest.starts_with("package") ? "package://" : "model://");
    rest.remove_prefix(std::min(rest.find_first_not_of('/'), rest.size()));
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    package = rest.substr(0, slash);
    rest.remove_prefix(std::min(slash + 1, rest.size()));
    if (climbs(fs::path(package) / rest)) search.refuse("leaves its package by \"..\", which is not followed");
    for (const fs::path& path : package_paths) {
      if (search.finds(path / package / rest)) return (path / package / rest).lexically_normal();
      if (path.filename() == package && search.finds(path / rest)) return (path / rest).lexically_normal();
    }
    // The robot's file lies in a package, and packages lie side by side.
    for (fs::path up = folder;; up = up.parent_path()) {
      if (search.finds(up / package / rest)) return (up / package / rest).lexically_normal();
      if (search.finds(up / rest)) return (up / rest).lexically_normal();
      if (up == up.parent_path()) break;
    }
    search.give_up();
  }
  if (rest.starts_with("file://")) rest = without(rest, "file://");
  if (rest.find("://") != std::string_view::npos) search.refuse("is not on this disk: save it beside the robot's file");
  const fs::path written(rest);
  std::vector<fs::path> candidates;
  if (written.is_absolute()) {
    candidates.push_back(written);
    // A place on the machine that it was written on: what follows some folder of it may be here.
    for (fs::path tail = written.relative_path(); !climbs(written) && !tail.empty();) {
      candidates.push_back(folder / tail);
      candidates.push_back(folder.parent_path() / tail);
      candidates.push_back(folder.parent_path().parent_path() / tail);
      const fs::path first = *tail.begin();
      tail = tail.lexically_relative(first);
      if (tail == ".") break;
    }
  } else {
    candidates.push_back(folder / written);
    for (const fs::path& path : package_paths) candidates.push_back(path / written);
  }
  // Beside the robot's file, in the folders above it as packages have them, or where the user says.
  std::vector<fs::path> allowed{folder.parent_path().parent_path()};
  for (const fs::path& path : package_paths) allowed.push_back(fs::absolute(path).lexically_normal());
  for (const fs::path& candidate : candidates) {
    fs::path plain = fs::absolute(candidate).lexically_normal();
    if (!search.finds(plain)) continue;
    if (std::any_of(allowed.begin(), allowed.end(), [&](const fs::path& root) { return lies_in(plain, root); }))
      return plain;
    search.refuse(
        fmt::format("lies outside the robot's folders; allow it with --package-path {}", plain.parent_path().string()));
  }
  search.give_up();
}

}  // namespace morula::robot
