// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Every file against the rules of its strictest reader. The judges below know the rules and nothing of the writers;
// each rule is broken once in a sample, which the judge has to refuse for that reason.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <morula/robot/output.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <support/scratch_folder.hpp>

#include "small_yaml.hpp"

namespace morula::test {
namespace {

using nlohmann::json;

/// An arm with few spheres, fitted once.
struct Fitted {
  robot::Robot robot;
  robot::RobotSpheres spheres;
  robot::SelfCollision self_collision;
  robot::OutputOptions options;

  explicit Fitted(const std::string& file) : robot(robot::read_robot(file)) {
    spheres = robot::fit_spheres(
        robot, {.spheres = 3, .skip = robot.name == "arm" ? std::set<std::string>{"upper"} : std::set<std::string>{}});
    self_collision = robot::find_ignored(robot, spheres, {.samples = 50});
    options.folder = "out";
  }
  std::vector<robot::OutputFile> files(const std::string& format) const {
    return robot::output_format(format)->write({robot, spheres, self_collision, options});
  }
  std::string text(const std::string& format) const { return files(format).at(0).bytes; }
};

const Fitted& fitted_arm() {
  static const Fitted fitted(MORULA_ROBOTS "/arm_description/urdf/arm.urdf");
  return fitted;
}
const Fitted& fitted_gripper() {
  static const Fitted fitted(MORULA_ROBOTS "/gripper_description/urdf/gripper.urdf");
  return fitted;
}

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

/// Spheres as (link, x, y, z, radius), from any file.
using Row = std::tuple<std::string, double, double, double, double>;
std::multiset<Row> expected_rows(const Fitted& fitted) {
  std::multiset<Row> rows;
  for (const robot::LinkSpheres& link : fitted.spheres.links) {
    for (const Sphere& s : link.spheres) {
      rows.insert({fitted.robot.links[link.link].name, s.center.x, s.center.y, s.center.z, s.radius});
    }
  }
  return rows;
}

Row row(const std::string& link, const json& center, const json& radius) {
  return {link, center.at(0).get<double>(), center.at(1).get<double>(), center.at(2).get<double>(),
          radius.get<double>()};
}

std::multiset<Row> rows_of_map(const json& map) {
  std::multiset<Row> rows;
  for (const auto& [link, list] : map.items()) {
    for (const json& sphere : list) rows.insert(row(link, sphere["center"], sphere["radius"]));
  }
  return rows;
}

/// What stands between a pattern's groups in XML that tinyxml2 or anybody wrote: names and numbers.
std::multiset<Row> rows_of_xml(const std::string& text, const std::string& link_pattern,
                               const std::string& sphere_pattern, bool radius_first) {
  std::multiset<Row> rows;
  const std::regex links(link_pattern), spheres(sphere_pattern);
  std::vector<std::pair<std::size_t, std::string>> begins;
  for (std::sregex_iterator it(text.begin(), text.end(), links), end; it != end; ++it) {
    begins.push_back({static_cast<std::size_t>(it->position()), (*it)[1]});
  }
  for (std::sregex_iterator it(text.begin(), text.end(), spheres), end; it != end; ++it) {
    const auto at = static_cast<std::size_t>(it->position());
    std::string link;
    for (const auto& [begin, name] : begins) {
      if (begin < at) link = name;
    }
    std::istringstream center((*it)[radius_first ? 2 : 1]);
    double x = 0, y = 0, z = 0;
    center >> x >> y >> z;
    rows.insert({link, x, y, z, std::stod((*it)[radius_first ? 1 : 2])});
  }
  return rows;
}

TEST(RobotOutput, every_file_holds_the_same_spheres_to_the_last_digit) {
  for (const Fitted* fitted : {&fitted_arm(), &fitted_gripper()}) {
    const std::multiset<Row> rows = expected_rows(*fitted);
    ASSERT_FALSE(rows.empty());
    EXPECT_EQ(rows_of_map(parse_yaml(fitted->text("curobo"))["robot_cfg"]["kinematics"]["collision_spheres"]), rows);
    for (const char* format : {"xrdf-1", "xrdf-2"}) {
      const json file = parse_yaml(fitted->text(format));
      EXPECT_EQ(rows_of_map(file["geometry"].begin().value()["spheres"]), rows) << format;
    }
    const std::string urdf = "<origin xyz=\"([^\"]*)\" rpy=\"0 0 0\"/>\\s*<geometry>\\s*<sphere radius=\"([^\"]*)\"/>";
    EXPECT_EQ(rows_of_xml(fitted->text("urdf"), "<link name=\"([^\"]*)\"", urdf, false), rows);
    EXPECT_EQ(rows_of_xml(fitted->files("vamp").at(0).bytes, "<link name=\"([^\"]*)\"", urdf, false), rows);
    EXPECT_EQ(rows_of_xml(fitted->text("mjcf"), "<body name=\"([^\"]*)\"",
                          "<geom type=\"sphere\" size=\"([^\"]*)\" pos=\"([^\"]*)\" mass=\"0\"", true),
              rows);
    EXPECT_EQ(rows_of_xml(fitted->text("sdf"), "<link name=\"([^\"]*)\"",
                          "<pose>([^<]*)</pose>\\s*<geometry>\\s*<sphere>\\s*<radius>([^<]*)<", false),
              rows);
    std::multiset<Row> srdf = rows_of_xml(fitted->text("srdf"), "<link_sphere_approximation link=\"([^\"]*)\"",
                                          "<sphere center=\"([^\"]*)\" radius=\"([^\"]*)\"", false);
    for (const robot::Link& link : fitted->robot.links) srdf.erase({link.name, 0, 0, 0, 0});
    EXPECT_EQ(srdf, rows);
    std::multiset<Row> foam, ballpark, bubblify, own;
    const json foam_file = json::parse(fitted->text("foam"));
    for (const auto& [key, levels] : foam_file.items()) {
      for (const json& sphere : levels.at(0)["spheres"])
        foam.insert(row(key.substr(0, key.find("::")), sphere["origin"], sphere["radius"]));
    }
    EXPECT_EQ(foam, rows);
    const json ballpark_file = json::parse(fitted->text("ballpark"));
    for (const auto& [link, lists] : ballpark_file.items()) {
      for (std::size_t i = 0; i < lists["radii"].size(); ++i)
        ballpark.insert(row(link, lists["centers"][i], lists["radii"][i]));
    }
    EXPECT_EQ(ballpark, rows);
    for (const json& sphere : parse_yaml(fitted->text("bubblify")))
      bubblify.insert(row(sphere["link"], sphere["position"], sphere["radius"]));
    EXPECT_EQ(bubblify, rows);
    const json own_file = json::parse(fitted->text("json"));
    for (const json& link : own_file["links"]) {
      for (const json& sphere : link["spheres"]) own.insert(row(link["link"], sphere["center"], sphere["radius"]));
    }
    EXPECT_EQ(own, rows);
  }
}

TEST(RobotOutput, every_collision_of_the_spherized_urdf_is_a_sphere_and_it_reads_back) {
  const ScratchFolder scratch;
  for (const robot::OutputFile& file : fitted_arm().files("vamp")) scratch.file(file.name, file.bytes);
  const robot::Robot read = robot::read_robot(scratch.path() / "vamp/arm_spherized.urdf");
  EXPECT_EQ(read.joints.size(), fitted_arm().robot.joints.size());
  for (const robot::Link& link : read.links) {
    for (const robot::Shape& shape : link.collision) EXPECT_EQ(shape.kind, robot::Shape::Kind::sphere);
    const robot::LinkSpheres* spheres = fitted_arm().spheres.of(fitted_arm().robot.find_link(link.name));
    EXPECT_EQ(link.collision.size(), spheres == nullptr ? 0 : spheres->spheres.size()) << link.name;
  }
  const json config = json::parse(fitted_arm().files("vamp").at(2).bytes);
  for (const char* key : {"name", "urdf", "srdf", "end_effector", "resolution", "template", "subtemplates", "output"}) {
    EXPECT_TRUE(config.contains(key)) << key;
  }
  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "vamp" / config["urdf"].get<std::string>()));
  EXPECT_TRUE(std::filesystem::exists(scratch.path() / "vamp" / config["srdf"].get<std::string>()));
  EXPECT_TRUE(std::regex_match(config["name"].get<std::string>(), std::regex("[A-Za-z_][A-Za-z0-9_]*")));
}

TEST(RobotOutput, relative_meshes_of_the_spherized_urdf_lead_to_the_same_files) {
  const std::string text = fitted_arm().text("urdf");
  const std::size_t at = text.find("meshes/wedge.obj");
  ASSERT_NE(at, std::string::npos);
  const std::size_t begin = text.rfind('"', at) + 1;
  const std::filesystem::path name = text.substr(begin, text.find('"', at) - begin);
  EXPECT_TRUE(name.is_relative());
  EXPECT_EQ((std::filesystem::absolute("out") / name).lexically_normal(),
            std::filesystem::path(MORULA_ROBOTS "/arm_description/meshes/wedge.obj").lexically_normal());
}

TEST(RobotOutput, an_srdf_keeps_what_was_given_and_says_what_its_pairs_rest_on) {
  const ScratchFolder scratch;
  scratch.file(
      "given.srdf",
      "<robot name='arm'><group name='all'/><link_sphere_approximation link='base'><sphere center='9 9 9' radius='9'/>"
      "</link_sphere_approximation><disable_collisions link1='tool' link2='base' reason='User'/>"
      "<disable_collisions link1='wrist' link2='base' reason='User'/></robot>");
  Fitted fitted(MORULA_ROBOTS "/arm_description/urdf/arm.urdf");
  fitted.options.srdf = scratch.path() / "given.srdf";
  fitted.self_collision = robot::find_ignored(
      fitted.robot, fitted.spheres, {.samples = 50, .given = robot::read_ignored_pairs(scratch.path() / "given.srdf")});
  const std::string text = fitted.text("srdf");
  EXPECT_NE(text.find("<group name=\"all\"/>"), std::string::npos);
  EXPECT_EQ(text.find("9 9 9"), std::string::npos);
  const std::string sampled = std::to_string(fitted.self_collision.samples);
  EXPECT_NE(text.find("apart in each of " + sampled + " sampled configurations (seed 1)"), std::string::npos);
  std::multiset<std::set<std::string>> pairs;
  const std::regex pattern("<disable_collisions link1=\"([^\"]*)\" link2=\"([^\"]*)\"");
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it)
    pairs.insert({(*it)[1], (*it)[2]});
  EXPECT_EQ(pairs.count({"wrist", "base"}), 1u) << "never twice";
  EXPECT_EQ(pairs.count({"tool", "base"}), 1u);
  std::set<std::set<std::string>> expected{{"tool", "base"}};
  for (const robot::IgnoredPair& pair : fitted.self_collision.ignored) {
    expected.insert({fitted.robot.links[pair.a].name, fitted.robot.links[pair.b].name});
  }
  EXPECT_EQ(std::set<std::set<std::string>>(pairs.begin(), pairs.end()), expected);
}

/// The text between the last `open` before `at` and the `close` after that.
std::string text_before(const std::string& text, std::size_t at, const std::string& open, const std::string& close) {
  const std::size_t begin = text.rfind(open, at) + open.size();
  return text.substr(begin, text.find(close, begin) - begin);
}

TEST(RobotOutput, every_ignored_pair_carries_its_reason_and_its_bound) {
  Fitted fitted(MORULA_ROBOTS "/gripper_description/urdf/gripper.urdf");
  ASSERT_EQ(fitted.spheres.links.size(), 4u);
  const auto link = [&](std::size_t i) { return fitted.spheres.links[i].link; };
  const auto name = [&](std::size_t i) { return fitted.robot.links[link(i)].name; };
  using robot::IgnoreReason;
  struct Expected {
    std::size_t a, b;
    IgnoreReason reason;
    const char *word, *detail;
  };
  const std::vector<Expected> all{
      {0, 1, IgnoreReason::apart, "Never", "apart in every configuration, proven"},
      {0, 2, IgnoreReason::never, "Never", "apart in 150000 sampled configurations, meets in less than 2e-05 of all"},
      {0, 3, IgnoreReason::adjacent, "Adjacent", "neighbors"},
      {1, 2, IgnoreReason::rest, "Default", "surfaces touch at rest"},
      {1, 3, IgnoreReason::given, "User", "given"}};
  fitted.self_collision = {};
  fitted.self_collision.samples = 150'000;
  for (const Expected& e : all) fitted.self_collision.ignored.push_back({link(e.a), link(e.b), e.reason});
  fitted.self_collision.overlapping = {{link(2), link(3), 0.25, 0.5}};

  const json self_collision = json::parse(fitted.text("json"))["self_collision"];
  ASSERT_EQ(self_collision["ignored"].size(), all.size());
  const std::string srdf = fitted.text("srdf"), mjcf = fitted.text("mjcf");
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Expected& e = all[i];
    SCOPED_TRACE(e.detail);
    const json& pair = self_collision["ignored"][i];
    EXPECT_EQ(pair["links"], json({name(e.a), name(e.b)}));
    EXPECT_EQ(pair["reason"], e.word);
    EXPECT_EQ(pair.contains("meets_below"), e.word == std::string("Never"));
    if (pair.contains("meets_below")) {
      EXPECT_EQ(pair["proven"], e.reason == IgnoreReason::apart);
      EXPECT_DOUBLE_EQ(pair["meets_below"], e.reason == IgnoreReason::apart ? 0 : 3.0 / 150'000);
    }
    const std::string both =
        "link1=\"" + name(e.a) + "\" link2=\"" + name(e.b) + "\" reason=\"" + e.word + "\" detail=\"" + e.detail;
    EXPECT_NE(srdf.find(both), std::string::npos) << srdf;
    const std::size_t at = mjcf.find("<exclude body1=\"" + name(e.a) + "\" body2=\"" + name(e.b) + "\"/>");
    ASSERT_NE(at, std::string::npos);
    EXPECT_EQ(text_before(mjcf, at, "<!--", "-->").find(e.detail), 1u);
  }
  EXPECT_EQ(self_collision["overlapping"], json::parse("[{\"links\": [\"" + name(2) + "\", \"" + name(3) +
                                                       "\"], \"rest_distance\": 0.25, \"share\": 0.5}]"));
  for (const char* format : {"curobo", "curobo-0.7", "xrdf-1", "xrdf-2"}) {
    const std::string text = fitted.text(format);
    for (const Expected& e : all) {
      const std::string line = std::string("# ") + e.detail;
      const std::size_t at = text.find("\"" + name(e.a) + "\": [\"", text.find("ignore"));
      ASSERT_NE(at, std::string::npos) << format;
      const std::size_t comment = text.rfind(line, at);
      ASSERT_NE(comment, std::string::npos) << format << " " << line;
      EXPECT_NE(text.substr(comment, text.find('\n', comment) - comment).find("\"" + name(e.b) + "\""),
                std::string::npos)
          << text;
    }
  }
  // Every file that lists pairs begins with what the list proves.
  for (const char* format : {"curobo", "curobo-0.7", "xrdf-1", "xrdf-2", "srdf", "vamp", "mjcf", "json"}) {
    bool is_said = false;
    for (const robot::OutputFile& file : fitted.files(format)) {
      is_said = is_said ||
                file.bytes.find("150000 sampled configurations (seed 1): each of these meets in less than 2e-05") !=
                    std::string::npos;
    }
    EXPECT_TRUE(is_said) << format;
  }
}

TEST(RobotOutput, masses_of_simulators_are_the_robots_own) {
  const std::string mjcf = fitted_arm().text("mjcf");
  EXPECT_NE(mjcf.find("mass=\"4\""), std::string::npos);
  // The forearm's inertia is given along turned axes: x and z change places.
  EXPECT_NE(mjcf.find("mass=\"1.5\" fullinertia=\"0.011"), std::string::npos) << mjcf;
  EXPECT_NE(fitted_arm().text("sdf").find("<mass>1.5</mass>"), std::string::npos);
  EXPECT_NE(fitted_gripper().text("mjcf").find("joint1=\"right_slide\" joint2=\"left_slide\" polycoef=\"0 1 0 0 0\""),
            std::string::npos);
}

/// What MuJoCo reads of a body, judged by its rules.
struct Weighed {
  double mass = 0;
  std::array<double, 3> moments{};  // ascending
};

/// Eigenvalues of a symmetric matrix, by the roots of its characteristic polynomial.
std::array<double, 3> eigenvalues(const std::array<double, 6>& m) {
  const auto [xx, yy, zz, xy, xz, yz] = m;  // in MuJoCo's order
  const double mean = (xx + yy + zz) / 3;
  const double p2 = (xx - mean) * (xx - mean) + (yy - mean) * (yy - mean) + (zz - mean) * (zz - mean) +
                    2 * (xy * xy + xz * xz + yz * yz);
  if (p2 == 0) return {mean, mean, mean};
  const double p = std::sqrt(p2 / 6);
  const double a = (xx - mean) / p, b = (yy - mean) / p, c = (zz - mean) / p, d = xy / p, e = xz / p, f = yz / p;
  const double r = (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e)) / 2;
  const double angle = std::acos(std::max(-1.0, std::min(1.0, r))) / 3;
  std::array<double, 3> all{};
  for (int k = 0; k < 3; ++k)
    all[static_cast<std::size_t>(k)] = mean + 2 * p * std::cos(angle + 2 * std::acos(-1.0) * k / 3);
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<double> numbers_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> all;
  for (double value = 0; in >> value;) all.push_back(value);
  return all;
}

/// By the names of bodies; those without <inertial> are not among them.
std::map<std::string, Weighed> weighed(const std::string& mjcf) {
  std::map<std::string, Weighed> all;
  const std::regex pattern("<body name=\"([^\"]*)\"|<inertial ([^>]*)/>");
  std::string body;
  for (std::sregex_iterator it(mjcf.begin(), mjcf.end(), pattern), end; it != end; ++it) {
    if ((*it)[1].matched) {
      body = (*it)[1];
      continue;
    }
    const std::string attributes = (*it)[2];
    const auto value = [&](const std::string& name) {
      std::smatch found;
      return std::regex_search(attributes, found, std::regex(name + "=\"([^\"]*)\"")) ? found[1].str() : "";
    };
    Weighed& own = all[body];
    own.mass = std::stod(value("mass"));
    if (const std::vector<double> full = numbers_of(value("fullinertia")); full.size() == 6) {
      own.moments = eigenvalues({full[0], full[1], full[2], full[3], full[4], full[5]});
    } else {
      const std::vector<double> diagonal = numbers_of(value("diaginertia"));
      EXPECT_EQ(diagonal.size(), 3u) << attributes;
      std::copy(diagonal.begin(), diagonal.end(), own.moments.begin());
      std::sort(own.moments.begin(), own.moments.end());
    }
  }
  return all;
}

/// A base, and a body that a joint of this type carries, of this inertia.
std::map<std::string, Weighed> weighed_body(const std::string& inertial, const std::string& joint = "revolute",
                                            bool fill_masses = false) {
  const ScratchFolder scratch;
  const std::string box = "<collision><geometry><box size='1 1 1'/></geometry></collision>";
  scratch.file("r.urdf", "<robot name='r'><link name='a'>" + box + "</link><link name='b'>" + inertial + box +
                             "</link><joint name='j' type='" + joint +
                             "'><parent link='a'/><child link='b'/><origin xyz='0 0 2'/><limit lower='-1' upper='1'/>"
                             "</joint></robot>");
  Fitted fitted((scratch.path() / "r.urdf").string());
  fitted.options.fill_masses = fill_masses;
  return weighed(fitted.text("mjcf"));
}

std::string inertial_of(const std::string& mass, const std::string& entries) {
  return "<inertial><origin xyz='0.1 0 0' rpy='0.3 0.2 0.1'/><mass value='" + mass + "'/><inertia " + entries +
         "/></inertial>";
}

TEST(RobotOutput, inertias_of_mjcf_are_those_that_mujoco_takes) {
  struct Case {
    const char* mass;
    const char* entries;
    double kept;  // the largest moment, which stays; 0: none is known
  };
  for (const Case& c : std::vector<Case>{
           {"1e-7", "ixx='3e-22' iyy='3e-22' izz='5e-22'", 0},
           {"1e-16", "ixx='1' iyy='1' izz='1'", 1},
           {"1e-300", "ixx='1e-300' iyy='1e-300' izz='1e-300'", 0},
           {"2", "ixx='1' iyy='1' izz='3'", 3},
           {"2", "ixx='1' iyy='1' izz='2'", 2},
           {"2", "ixx='1' iyy='1' izz='0'", 1},
           {"2", "ixx='1e6' iyy='1e-9' izz='1e-9'", 1e6},
           {"2", "ixx='1' iyy='1' izz='1' ixy='1'", 2},
           {"2", "ixx='0' iyy='0' izz='0'", 0},
           {"2", "ixx='-1' iyy='1' izz='1'", 0},
           {"2", "ixx='1' iyy='1' izz='1' ixy='5'", 0},
           {"2", "ixx='1e18' iyy='1e18' izz='2e18'", 2e18},
           {"2", "ixx='0.3' iyy='0.3' izz='0.4'", 0.4},
       }) {
    for (const char* joint : {"revolute", "fixed"}) {
      const auto all = weighed_body(inertial_of(c.mass, c.entries), joint);
      ASSERT_EQ(all.count("b"), 1u) << c.entries;
      const Weighed& b = all.at("b");
      EXPECT_GE(b.mass, 1e-15) << c.mass;
      EXPECT_NEAR(b.mass, std::stod(c.mass), 1e-12) << "no mass is added";
      EXPECT_GE(b.moments[0], 1e-15) << c.entries;
      EXPECT_GE(b.moments[0] + b.moments[1], b.moments[2]) << c.entries;
      if (c.fixed_spheres > 0) {
        EXPECT_NEAR(b.moments[2], c.fixed_spheres, 1e-9 * c.fixed_spheres) << c.entries;
      }
      EXPECT_EQ(all.count("a"), 0u) << "what does not move needs no mass";
    }
  }
  // A + B < C: both are raised alike.
  const Weighed flat = weighed_body(inertial_of("2", "ixx='1' iyy='1.5' izz='3'")).at("b");
  EXPECT_NEAR(flat.moments[0], 1.25, 1e-9);
  EXPECT_NEAR(flat.moments[1], 1.75, 1e-9);
  // Of a box of edge 1: about a sixth of its mass.
  const Weighed box = weighed_body(inertial_of("6", "")).at("b");
  EXPECT_GT(box.moments[0], 1);
  EXPECT_LT(box.moments[2], 3);
}

TEST(RobotOutput, links_without_a_mass_weigh_nothing_unless_asked) {
  const auto moving = weighed_body("");
  ASSERT_EQ(moving.count("b"), 1u) << "MuJoCo takes no body that moves without a mass";
  EXPECT_LE(moving.at("b").mass, 1e-6);
  EXPECT_GE(moving.at("b").mass, 1e-15);
  EXPECT_GE(moving.at("b").moments[0], 1e-15);
  EXPECT_EQ(moving.size(), 1u);
  EXPECT_TRUE(weighed_body("", "fixed").empty());
  EXPECT_TRUE(weighed_body("<inertial><mass value='0'/></inertial>", "fixed").empty());
  const auto filled = weighed_body("", "fixed", true);
  ASSERT_EQ(filled.size(), 2u);
  EXPECT_GT(filled.at("b").mass, 1000) << "spheres around a box of edge 1";
  EXPECT_LT(filled.at("b").mass, 10000);
  // A body without a mass moves where one that is fixed to it has some.
  const ScratchFolder scratch;
  const std::string ball = "<collision><geometry><sphere radius='1'/></geometry></collision>";
  scratch.file("r.urdf",
               "<robot name='r'><link name='a'/><link name='b'>" + ball +
                   "</link><link name='c'><inertial><mass value='3'/><inertia ixx='1' iyy='1' izz='1'/></inertial>" +
                   ball +
                   "</link><joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint>"
                   "<joint name='k' type='fixed'><parent link='b'/><child link='c'/></joint></robot>");
  const Fitted fitted((scratch.path() / "r.urdf").string());
  const auto carried = weighed(fitted.text("mjcf"));
  ASSERT_EQ(carried.size(), 1u);
  EXPECT_EQ(carried.at("c").mass, 3);
  // In SDF a link that says nothing weighs 1.
  const std::string sdf = fitted.text("sdf");
  double sum = 0;
  const std::regex mass("<mass>([^<]*)</mass>");
  for (std::sregex_iterator it(sdf.begin(), sdf.end(), mass), end; it != end; ++it) sum += std::stod((*it)[1]);
  EXPECT_EQ(std::distance(std::sregex_iterator(sdf.begin(), sdf.end(), mass), std::sregex_iterator()), 3);
  EXPECT_NEAR(sum, 3, 1e-5);
}

TEST(RobotOutput, numbers_of_morphit_add_up) {
  for (const robot::OutputFile& file : fitted_gripper().files("morphit")) {
    const json link = json::parse(file.bytes);
    ASSERT_EQ(link["centers"].size(), link["num_spheres"].get<std::size_t>());
    ASSERT_EQ(link["radii"].size(), link["masses"].size());
    double sum = 0;
    for (const json& mass : link["masses"]) sum += mass.get<double>();
    EXPECT_NEAR(sum, link["per_sphere_mass"].get<double>() * link["num_spheres"].get<double>(), 1e-12);
  }
}

TEST(RobotOutput, own_file_reads_back_and_others_are_refused) {
  const ScratchFolder scratch;
  scratch.file("spheres.json", fitted_arm().text("json"));
  const auto read = robot::read_robot_spheres(scratch.path() / "spheres.json");
  ASSERT_EQ(read.size(), fitted_arm().spheres.links.size());
  for (const robot::LinkSpheres& link : fitted_arm().spheres.links) {
    EXPECT_EQ(read.at(fitted_arm().robot.links[link.link].name), link.spheres);
  }
  for (const std::string& text :
       {std::string("{"), std::string("[]"), fitted_arm().text("ballpark"),
        std::regex_replace(fitted_arm().text("json"), std::regex("\"radius\": "), "\"radius\": -")}) {
    scratch.file("bad.json", text);
    EXPECT_THROW(robot::read_robot_spheres(scratch.path() / "bad.json"), FileError) << text.substr(0, 40);
  }
  EXPECT_THROW(robot::read_robot_spheres(scratch.path() / "none.json"), FileError);
}

}  // namespace
}  // namespace morula::test
