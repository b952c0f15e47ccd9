// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The planners' files against the rules of their strictest readers. The judges below know the rules and nothing of the
// writers; each rule is broken once in a sample, which the judge has to refuse for that reason.
#include <gtest/gtest.h>

#include <set>
#include <span>
#include <string>

#include "fitted.hpp"
#include "small_yaml.hpp"

namespace morula::test {
namespace {

using nlohmann::json;

bool is_number(const json& value) {
  return value.is_number() && std::isfinite(value.get<double>());
}
/// "" or what is wrong with a list of spheres.
std::string judge_spheres(const json& list, bool positive) {
  if (!list.is_array()) return "spheres are no list";
  for (const json& sphere : list) {
    if (!sphere.is_object() || sphere.size() != 2 || !sphere.contains("center") || !sphere.contains("radius"))
      return "a sphere is not {center, radius}";
    const json& center = sphere["center"];
    if (!center.is_array() || center.size() != 3) return "a center is not three numbers";
    for (const json& c : center) {
      if (!is_number(c)) return "a center is not three numbers";
    }
    if (!is_number(sphere["radius"])) return "a radius is no number";
    if (positive && !(sphere["radius"].get<double>() > 0)) return "a radius is not above 0";
  }
  return "";
}
bool is_names(const json& list) {
  return list.is_array() && std::all_of(list.begin(), list.end(), [](const json& name) { return name.is_string(); });
}

std::string judge_curobo(const std::string& text, bool old_keys) {
  json file;
  try {
    file = parse_yaml(text);
  } catch (const std::exception& error) {
    return error.what();
  }
  if (!file.contains("robot_cfg") || !file["robot_cfg"].contains("kinematics")) return "no robot_cfg.kinematics";
  const json& k = file["robot_cfg"]["kinematics"];
  if (old_keys) {
    if (k.contains("format_version")) return "format_version is new";
    if (!k.contains("ee_link") || !k["ee_link"].is_string()) return "no ee_link";
  } else {
    if (!k.contains("format_version") || k["format_version"] != 2.0) return "no format_version";
    if (!k.contains("tool_frames") || !is_names(k["tool_frames"]) || k["tool_frames"].empty()) return "no tool_frames";
    if (k.contains("ee_link") || k.contains("link_names")) return "keys of old";
    for (const auto& [key, value] : k.items()) {
      if (key.rfind("usd", 0) == 0) return "USD keys are gone";
    }
  }
  for (const char* key : {"urdf_path", "base_link"}) {
    if (!k.contains(key) || !k[key].is_string()) return std::string("no ") + key;
  }
  if (!k.contains("collision_spheres") || !k["collision_spheres"].is_object()) return "spheres have to be inline";
  if (!k.contains("collision_link_names") || !is_names(k["collision_link_names"])) return "no collision_link_names";
  for (const json& link : k["collision_link_names"]) {
    const std::string name = link;
    if (!k["collision_spheres"].contains(name) || k["collision_spheres"][name].empty())
      return "a collision link without spheres";
  }
  for (const auto& [link, list] : k["collision_spheres"].items()) {
    if (const std::string fault = judge_spheres(list, true); !fault.empty()) return fault;
  }
  if (!k.contains("collision_sphere_buffer")) return "no collision_sphere_buffer";
  const json& buffer = k["collision_sphere_buffer"];
  if (!buffer.is_number_float() && !buffer.is_object()) return "collision_sphere_buffer is neither float nor map";
  if (!k.contains("self_collision_ignore") || !k["self_collision_ignore"].is_object())
    return "no self_collision_ignore";
  for (const auto& [link, others] : k["self_collision_ignore"].items()) {
    if (!is_names(others)) return "self_collision_ignore is no map of lists";
  }
  if (!k.contains("cspace")) return "no cspace";
  const json& c = k["cspace"];
  if (!c.contains("joint_names") || !is_names(c["joint_names"])) return "no joint_names";
  const char* rest = old_keys ? "retract_config" : "default_joint_position";
  for (const char* key : {rest, "null_space_weight", "cspace_distance_weight"}) {
    if (!c.contains(key) || c[key].size() != c["joint_names"].size())
      return std::string(key) + " does not fit the joints";
  }
  return "";
}

std::string judge_xrdf(const std::string& text, bool second) {
  json file;
  try {
    file = parse_yaml(text);
  } catch (const std::exception& error) {
    return error.what();
  }
  if (file.value("format", "") != "xrdf") return "no format";
  if (!file.contains("format_version") || file["format_version"] != (second ? 2.0 : 1.0)) return "another version";
  const char* world = second ? "world_collision" : "collision";
  if (file.contains(second ? "collision" : "world_collision")) return "the section of the other version";
  if (!file.contains("geometry") || !file["geometry"].is_object()) return "no geometry";
  const auto judge_section = [&](const char* name) -> std::string {
    if (!file.contains(name)) return std::string("no ") + name;
    const json& section = file[name];
    if (!section.contains("geometry") || !section["geometry"].is_string()) return "a section without geometry";
    const std::string group = section["geometry"];
    if (!file["geometry"].contains(group)) return "a group that is not there";
    if (!section.contains("buffer_distance")) return "";
    if (!section["buffer_distance"].is_object()) return "buffers are no map";
    for (const auto& [link, buffer] : section["buffer_distance"].items()) {
      if (!is_number(buffer)) return "a buffer is no number";
      if (!file["geometry"][group]["spheres"].contains(link)) continue;
      for (const json& sphere : file["geometry"][group]["spheres"][link]) {
        if (second && !(sphere["radius"].get<double>() + buffer.get<double>() > 0))
          return "radius and buffer are not above 0";
      }
    }
    return "";
  };
  for (const auto& [name, group] : file["geometry"].items()) {
    if (!group.is_object() || !group.contains("spheres") || !group["spheres"].is_object())
      return "a group without spheres";
    for (const auto& [link, list] : group["spheres"].items()) {
      if (const std::string fault = judge_spheres(list, second); !fault.empty()) return fault;
    }
  }
  for (const char* name : {world, "self_collision"}) {
    if (const std::string fault = judge_section(name); !fault.empty()) return fault;
  }
  const json& self = file["self_collision"];
  if (!second && file[world]["geometry"] != self["geometry"]) return "two geometries";
  if (!self.contains("ignore") || !self["ignore"].is_object()) return "no ignore";
  for (const auto& [link, others] : self["ignore"].items()) {
    if (!is_names(others)) return "ignore is no map of lists";
  }
  if (!file.contains("tool_frames") || !is_names(file["tool_frames"])) return "no tool_frames";
  if (!file.contains("cspace") || !file["cspace"].contains("joint_names") || !is_names(file["cspace"]["joint_names"]))
    return "no joint_names";
  const json& joints = file["cspace"]["joint_names"];
  for (const char* key : {"acceleration_limits", "jerk_limits"}) {
    if (!file["cspace"].contains(key) || file["cspace"][key].size() != joints.size())
      return std::string(key) + " do not fit the joints";
    for (const json& limit : file["cspace"][key]) {
      if (!is_number(limit) || !(limit.get<double>() > 0)) return "a limit is not above 0";
    }
  }
  if (file.contains("default_joint_positions")) {
    for (const json& joint : joints) {
      if (!file["default_joint_positions"].contains(joint.get<std::string>())) return "a joint without a position";
    }
  }
  return "";
}

/// The valid text with one place changed: what stands there must be there.
struct Fault {
  const char* old;
  const char* fresh;
  const char* words;
};
void expect_refused(const std::string& valid, std::span<const Fault> faults, const auto& judge) {
  EXPECT_EQ(judge(valid), "");
  for (const Fault& fault : faults) {
    std::string text = valid;
    const std::size_t at = text.find(fault.old);
    ASSERT_NE(at, std::string::npos) << fault.old;
    text.replace(at, std::string(fault.old).size(), fault.fresh);
    EXPECT_NE(judge(text).find(fault.words), std::string::npos)
        << fault.old << " -> " << fault.fresh << ": " << judge(text);
  }
}

const std::string curobo_sample = R"(robot_cfg:
  kinematics:
    format_version: 2.0
    urdf_path: "r.urdf"
    base_link: "a"
    tool_frames: ["b"]
    collision_link_names: ["a"]
    collision_spheres:
      "a":
        - center: [0.0, 0.0, 0.1]
          radius: 0.2
    collision_sphere_buffer: 0.0
    self_collision_ignore:
      "a": ["b"]
    cspace:
      joint_names: ["j"]
      default_joint_position: [0.0]
      null_space_weight: [1.0]
      cspace_distance_weight: [1.0]
)";

const std::string xrdf_sample = R"(format: xrdf
format_version: 2.0
default_joint_positions:
  "j": 0.0
cspace:
  joint_names: ["j"]
  acceleration_limits: [10.0]
  jerk_limits: [100.0]
tool_frames: ["b"]
world_collision:
  geometry: "g"
  buffer_distance:
    "a": 0.01
self_collision:
  geometry: "g"
  buffer_distance: {}
  ignore:
    "a": ["b"]
geometry:
  "g":
    spheres:
      "a":
        - center: [0.0, 0.0, 0.1]
          radius: 0.2
)";

TEST(RobotOutput, the_judge_of_curobo_refuses_each_broken_rule) {
  const std::vector<Fault> faults{
      {"    format_version: 2.0\n", "", "no format_version"},
      {"    tool_frames: [\"b\"]\n", "", "no tool_frames"},
      {"    tool_frames: [\"b\"]\n", "    tool_frames: []\n", "no tool_frames"},
      {"    tool_frames", "    ee_link: \"b\"\n    tool_frames", "keys of old"},
      {"    base_link", "    usd_path: \"x\"\n    base_link", "USD keys"},
      {"collision_sphere_buffer: 0.0", "collision_sphere_buffer: 0", "neither float nor map"},
      {"collision_link_names: [\"a\"]", "collision_link_names: [\"a\", \"b\"]", "without spheres"},
      {"      \"a\":\n        - center: [0.0, 0.0, 0.1]\n          radius: 0.2\n", "", "inline"},
      {"[0.0, 0.0, 0.1]", "[0.0, 0.1]", "three numbers"},
      {"radius: 0.2", "radius: 1e-05", "no number"},
      {"default_joint_position: [0.0]", "retract_config: [0.0]", "default_joint_position"},
      {"null_space_weight: [1.0]", "null_space_weight: [1.0, 1.0]", "null_space_weight"},
      {"self_collision_ignore:\n      \"a\": [\"b\"]", "self_collision_ignore: []", "no self_collision_ignore"},
      {"    base_link: \"a\"\n", "    base_link: \"a\"\n    base_link: \"a\"\n", "twice"},
  };
  expect_refused(curobo_sample, faults, [](const std::string& text) { return judge_curobo(text, false); });
}

TEST(RobotOutput, the_judge_of_xrdf_refuses_each_broken_rule) {
  const std::vector<Fault> faults{
      {"format: xrdf", "format: urdf", "no format"},
      {"format_version: 2.0", "format_version: 1.0", "another version"},
      {"world_collision", "collision", "the section of the other version"},
      {"world_collision:\n  geometry: \"g\"", "world_collision:\n  geometry: \"h\"", "a group that is not there"},
      {"radius: 0.2", "radius: -0.2", "not above 0"},
      {"radius: 0.2", "radius: 0.0", "not above 0"},
      {"\"a\": 0.01", "\"a\": -0.3", "radius and buffer"},
      {"\"a\": 0.01", "\"a\": x", "a buffer is no number"},
      {"[0.0, 0.0, 0.1]", "[0.0, 0.0, 0.1, 0.0]", "three numbers"},
      {"acceleration_limits: [10.0]", "acceleration_limits: [10.0, 1.0]", "do not fit"},
      {"jerk_limits: [100.0]", "jerk_limits: [0.0]", "not above 0"},
      {"ignore:\n    \"a\": [\"b\"]", "ignore: [\"a\"]", "no ignore"},
      {"    \"a\": [\"b\"]", "    \"a\": \"b\"", "no map of lists"},
      {"  buffer_distance: {}", "  buffer_distance: []", "no map"},
      {"  \"j\": 0.0", "  \"k\": 0.0", "a joint without a position"},
      {"tool_frames: [\"b\"]\n", "", "no tool_frames"},
      {"geometry:\n  \"g\"", "geometry:\n  \"g\": 1\n  \"h\"", "without spheres"},
      {"      \"a\":\n", "      \"a\": []\n      \"a\":\n", "twice"},
  };
  expect_refused(xrdf_sample, faults, [](const std::string& text) { return judge_xrdf(text, true); });
}

TEST(RobotOutput, planners_files_keep_every_rule) {
  for (const Fitted* fitted : {&fitted_arm(), &fitted_gripper()}) {
    EXPECT_EQ(judge_curobo(fitted->text("curobo"), false), "");
    EXPECT_EQ(judge_curobo(fitted->text("curobo-0.7"), true), "");
    EXPECT_EQ(judge_xrdf(fitted->text("xrdf-1"), false), "");
    EXPECT_EQ(judge_xrdf(fitted->text("xrdf-2"), true), "");
    EXPECT_NE(judge_xrdf(fitted->text("xrdf-1"), true), "");
    EXPECT_NE(judge_curobo(fitted->text("curobo-0.7"), false), "");
  }
  EXPECT_EQ(parse_yaml(fitted_gripper().text("curobo"))["robot_cfg"]["kinematics"]["cspace"]["joint_names"],
            json({"left_slide"}))
      << "joints that follow are none of the planner's";
}
}  // namespace
}  // namespace morula::test
