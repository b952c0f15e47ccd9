// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <morula/robot/robot.hpp>

#include "read/assembly.hpp"

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
  const std::string_view root = xml.root().Name();
  if (root == "robot") return read_urdf(xml, options);
  if (root == "mujoco") return read_mjcf(xml, options);
  if (root == "sdf") return read_sdf(xml, options);
  const bool xacro = root.find("xacro") != std::string_view::npos;
  xml.fail(xml.root(), fmt::format("begins with <{}>, not with <robot>, <mujoco> or <sdf>{}", root,
                                   xacro ? "; expand xacro first" : ""));
}

}  // namespace morula::robot
