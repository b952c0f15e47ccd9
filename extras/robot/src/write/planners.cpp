// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// cuRobo and XRDF: YAML, written line by line so that the strictest of their readers agrees with every number.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "read/file_names.hpp"
#include "write/text.hpp"

namespace morula::robot {

namespace {

std::string sphere_lines(const Description& d, const std::string& indent) {
  std::string text;
  for (const LinkSpheres& link : d.spheres.links) {
    text += fmt::format("{}{}:\n", indent, quoted(d.robot.links[link.link].name));
    for (const Sphere& s : link.spheres) {
      text += fmt::format("{0}  - center: {1}\n{0}    radius: {2}\n", indent, decimals(s.center), decimal(s.radius));
    }
  }
  return text;
}

/// Comments that give the reason why each partner of a link is ignored: YAML has no other place for it.
std::string reason_lines(const Description& d, const std::string& indent, const std::string& link) {
  std::string text;
  for (const IgnoreReason reason :
       {IgnoreReason::given, IgnoreReason::adjacent, IgnoreReason::rest, IgnoreReason::apart, IgnoreReason::never}) {
    std::vector<std::string> others;
    for (const IgnoredPair& pair : d.self_collision.ignored) {
      if (pair.reason != reason || d.robot.links[pair.a].name != link) continue;
      others.push_back(quoted(d.robot.links[pair.b].name));
    }
    if (others.empty()) continue;
    text += fmt::format("{}# {}: {}\n", indent, reason_text(d, reason), fmt::join(others, ", "));
  }
  return text;
}

std::string ignore_lines(const Description& d, const std::string& indent, const std::string& key) {
  const auto ignored = ignored_by_link(d);
  if (ignored.empty()) return fmt::format("{}{}: {{}}\n", indent, key);
  std::string text = fmt::format("{}{}:\n", indent, key);
  for (const auto& [link, others] : ignored) {
    text += reason_lines(d, indent + "  ", link);
    text += fmt::format("{}  {}: {}\n", indent, quoted(link), quoted_list(others));
  }
  return text;
}

std::string buffer_lines(const Description& d, const std::string& indent, const std::string& key) {
  if (d.spheres.links.empty()) return fmt::format("{}{}: {{}}\n", indent, key);
  std::string text = fmt::format("{}{}:\n", indent, key);
  for (const LinkSpheres& link : d.spheres.links) {
    text += fmt::format("{}  {}: 0.0\n", indent, quoted(d.robot.links[link.link].name));
  }
  return text;
}

std::string decimal_list(std::span<const double> values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(decimal(value));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::vector<std::string> link_names(const Description& d) {
  std::vector<std::string> names;
  for (const LinkSpheres& link : d.spheres.links) names.push_back(d.robot.links[link.link].name);
  return names;
}

/// Whether planners can read the robot's own file.
bool is_plain_urdf(const Robot& robot) {
  return robot.format == Robot::Format::urdf && robot.expanded.empty();
}

/// The file that a planner reads: the robot's own file, or the URDF written for a robot in another format.
std::filesystem::path urdf_of(const Description& d) {
  if (is_plain_urdf(d.robot)) return std::filesystem::absolute(d.robot.file).lexically_normal();
  return (std::filesystem::absolute(d.options.folder) / (identifier(d.robot.name) + "_spherized.urdf"))
      .lexically_normal();
}

/// With the URDF where the robot has none.
std::vector<OutputFile> with_urdf(const Description& d, OutputFile file) {
  std::vector<OutputFile> files{std::move(file)};
  if (!is_plain_urdf(d.robot)) files.push_back(write_urdf(d).front());
  return files;
}

/// The folder that a mesh's name is relative to once `package://` is struck off; where there is none, the robot's.
std::filesystem::path asset_root(const Description& d) {
  const Robot& robot = d.robot;
  if (!is_plain_urdf(robot)) return urdf_of(d).parent_path();
  std::filesystem::path folder = std::filesystem::absolute(robot.file).parent_path().lexically_normal();
  for (const Link& link : robot.links) {
    for (const auto* shapes : {&link.collision, &link.visual}) {
      for (const Shape& shape : *shapes) {
        if (shape.file.empty() || !shape.file_name.starts_with("package://")) continue;
        std::string rest = shape.file_name.substr(10);
        rest.erase(0, rest.find_first_not_of('/'));
        const std::string file = name_of_path(std::filesystem::absolute(shape.file));
        if (file.ends_with("/" + rest)) return file.substr(0, file.size() - rest.size() - 1);
      }
    }
  }
  return folder;
}

constexpr double max_acceleration = 15.0, max_jerk = 500.0;  // values of both readers' own robots

std::string curobo_text(const Description& d, bool old_keys) {
  const Robot& robot = d.robot;
  const std::vector<std::string> links = link_names(d), joints = own_joint_names(robot), tools = tool_frames(d);
  const std::vector<double> rest = rest_values(robot), ones(joints.size(), 1.0);
  std::string text = fmt::format("# {}\n# {}\nrobot_cfg:\n  kinematics:\n", made_note(d), ignored_note(d));
  if (!old_keys) text += "    format_version: 2.0\n";
  text +=
      fmt::format("    urdf_path: {}\n    asset_root_path: {}\n    base_link: {}\n", quoted(name_of_path(urdf_of(d))),
                  quoted(name_of_path(asset_root(d))), quoted(robot.links[robot.root].name));
  if (old_keys) {
    text += fmt::format("    ee_link: {}\n    link_names: {}\n", quoted(tools.front()), quoted_list(tools));
  } else {
    text += fmt::format("    tool_frames: {}\n", quoted_list(tools));
  }
  text += fmt::format("    collision_link_names: {}\n", quoted_list(links));
  text +=
      d.spheres.links.empty() ? "    collision_spheres: {}\n" : "    collision_spheres:\n" + sphere_lines(d, "      ");
  // An integer is neither of the two types that the reader accepts.
  text += "    collision_sphere_buffer: 0.0\n    extra_collision_spheres: {}\n";
  text += ignore_lines(d, "    ", "self_collision_ignore");
  text += buffer_lines(d, "    ", "self_collision_buffer");
  text += fmt::format("    mesh_link_names: {}\n    lock_joints: {{}}\n    extra_links: {{}}\n", quoted_list(links));
  text += fmt::format(
      "    cspace:\n      joint_names: {}\n      {}: {}\n      null_space_weight: {}\n"
      "      cspace_distance_weight: {}\n      max_acceleration: {}\n      max_jerk: {}\n",
      quoted_list(joints), old_keys ? "retract_config" : "default_joint_position", decimal_list(rest),
      decimal_list(ones), decimal_list(ones), decimal(max_acceleration), decimal(max_jerk));
  return text;
}

std::string xrdf_text(const Description& d, bool second) {
  const Robot& robot = d.robot;
  const std::vector<std::string> joints = own_joint_names(robot), tools = tool_frames(d);
  const std::vector<double> rest = rest_values(robot);
  const std::vector<double> accelerations(joints.size(), max_acceleration), jerks(joints.size(), max_jerk);
  const std::string group = quoted(identifier(robot.name) + "_spheres");
  std::string text =
      fmt::format("# {}\n# {}\nformat: xrdf\nformat_version: {}\nmodifiers:\n  - set_base_frame: {}\n", made_note(d),
                  ignored_note(d), second ? "2.0" : "1.0", quoted(robot.links[robot.root].name));
  text += joints.empty() ? "default_joint_positions: {}\n" : "default_joint_positions:\n";
  for (std::size_t i = 0; i < joints.size(); ++i)
    text += fmt::format("  {}: {}\n", quoted(joints[i]), decimal(rest[i]));
  text += fmt::format("cspace:\n  joint_names: {}\n  acceleration_limits: {}\n  jerk_limits: {}\ntool_frames: {}\n",
                      quoted_list(joints), decimal_list(accelerations), decimal_list(jerks), quoted_list(tools));
  text += fmt::format("{}:\n  geometry: {}\n", second ? "world_collision" : "collision", group);
  text += buffer_lines(d, "  ", "buffer_distance");
  text += fmt::format("self_collision:\n  geometry: {}\n", group);
  text += buffer_lines(d, "  ", "buffer_distance") + ignore_lines(d, "  ", "ignore");
  text += fmt::format("geometry:\n  {}:\n", group);
  text += d.spheres.links.empty() ? "    spheres: {}\n" : "    spheres:\n" + sphere_lines(d, "      ");
  return text;
}

}  // namespace

std::vector<OutputFile> write_curobo(const Description& d) {
  return with_urdf(d, {"curobo.yml", curobo_text(d, false)});
}
std::vector<OutputFile> write_curobo_old(const Description& d) {
  return with_urdf(d, {"curobo_0.7.yml", curobo_text(d, true)});
}
std::vector<OutputFile> write_xrdf_1(const Description& d) {
  return {{identifier(d.robot.name) + ".1.0.xrdf", xrdf_text(d, false)}};
}
std::vector<OutputFile> write_xrdf_2(const Description& d) {
  return {{identifier(d.robot.name) + ".2.0.xrdf", xrdf_text(d, true)}};
}

}  // namespace morula::robot
