// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <morula/robot/robot.hpp>

#include "read/assembly.hpp"
#include "read/xacro.hpp"

namespace morula::robot {

std::size_t Robot::find_link(std::string_view wanted) const {
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i].name == wanted) return i;
  }
  return none;
}

std::size_t Robot::find_joint(std::string_view wanted) const {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].name == wanted) return i;
  }
  return none;
}

Robot read_robot(const std::filesystem::path& path, const ReadOptions& options) {
  const Xml xml(path);
  if (const tinyxml2::XMLElement* macro = find_xacro(xml)) {
    std::string text = expand_xacro(path, macro->GetLineNum(), options);
    const Xml expanded(path, XmlText{text});
    if (std::string_view(expanded.root().Name()) != "robot") {
      expanded.fail(expanded.root(), fmt::format("xacro makes <{}> of it, not <robot>", expanded.root().Name()));
    }
    Robot robot = read_urdf(expanded, options);
    robot.expanded = std::move(text);
    robot.included = files_of_xacro(path, options);
    robot.notes.insert(robot.notes.begin(), "xacro expanded the file; numbers of lines are those of its result");
    return robot;
  }
  const std::string_view root = xml.root().Name();
  if (root == "robot") return read_urdf(xml, options);
  if (root == "mujoco") return read_mjcf(xml, options);
  if (root == "sdf") return read_sdf(xml, options);
  const bool xacro = root.find("xacro") != std::string_view::npos;
  xml.fail(xml.root(), fmt::format("begins with <{}>, not with <robot>, <mujoco> or <sdf>{}", root,
                                   xacro ? "; give the file that begins with <robot>, which includes this one" : ""));
}

}  // namespace morula::robot
