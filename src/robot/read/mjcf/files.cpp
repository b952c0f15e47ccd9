// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "robot/read/mjcf/files.hpp"

#include <fmt/format.h>

#include <iterator>
#include <string_view>

namespace morula::robot {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

MjcfFiles::MjcfFiles(const Xml& main, std::vector<fs::path>& names) : main_(main), names_(names) {
  files_[main.root().GetDocument()] = &main;
}

std::vector<const XMLElement*> MjcfFiles::children(const XMLElement& of) {
  std::vector<const XMLElement*> result;
  for (const XMLElement* at = of.FirstChildElement(); at != nullptr; at = at->NextSiblingElement()) {
    if (std::string_view(at->Name()) != "include") {
      result.push_back(at);
      continue;
    }
    const std::vector<const XMLElement*> more = children(included(*at).root());
    result.insert(result.end(), more.begin(), more.end());
  }
  return result;
}

const Xml& MjcfFiles::included(const XMLElement& at) {
  if (const auto found = includes_.find(&at); found != includes_.end()) return *found->second;
  const std::string name = file_of(at).text(at, "file");
  const fs::path written(name);
  // Descriptions that share parts lie side by side.
  const auto leaves = [&](const fs::path& from) {
    const fs::path way = (from / written).lexically_normal().lexically_relative(main_.file().parent_path());
    return way.empty() || (*way.begin() == ".." && way.has_parent_path() && *std::next(way.begin()) == "..");
  };
  if (written.is_absolute() || leaves(main_.file().parent_path()) || leaves(file_of(at).file().parent_path())) {
    fail(at, fmt::format(
                 "file \"{}\" leaves the folder around that of the robot's file, which is not followed: copy it there",
                 name));
  }
  // Relative to the robot's file, or to the one that includes it.
  fs::path path = (main_.file().parent_path() / written).lexically_normal();
  const fs::path beside = (file_of(at).file().parent_path() / written).lexically_normal();
  std::error_code error;
  if (!fs::is_regular_file(path, error) && !fs::is_regular_file(beside, error)) {
    fail(at, fmt::format("file \"{}\" is missing; searched: {}{}", name, path.string(),
                         beside == path ? "" : " " + beside.string()));
  }
  if (!fs::is_regular_file(path, error)) path = beside;
  const fs::path plain = fs::weakly_canonical(path);
  if (plain == fs::weakly_canonical(main_.file()) || !included_.insert(plain).second) {
    fail(at, fmt::format("file \"{}\" is included a second time, or includes itself", name));
  }
  owned_.push_back(std::make_unique<Xml>(path));
  const Xml& xml = *owned_.back();
  files_[xml.root().GetDocument()] = &xml;
  includes_[&at] = &xml;
  names_.push_back(path);
  const std::string_view root = xml.root().Name();
  if (root != "mujoco" && root != "mujocoinclude") {
    xml.fail(xml.root(), fmt::format("begins with <{}>, not with <mujocoinclude> or <mujoco>", root));
  }
  return xml;
}

}  // namespace morula::robot
