// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What the files of all formats say of a robot and its spheres: the same spheres everywhere, ignored pairs with their
// reasons, files that read back.
#include <gtest/gtest.h>

#include <map>
#include <morula/version.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <support/scratch_folder.hpp>

#include "fitted.hpp"
#include "small_yaml.hpp"

namespace morula::test {
namespace {

using nlohmann::json;

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
            std::filesystem::absolute(MORULA_ROBOTS "/arm_description/meshes/wedge.obj").lexically_normal());
}

TEST(RobotOutput, meshes_of_any_letters_keep_their_names) {
  const ScratchFolder scratch;
  const std::filesystem::path mesh(u8"größe/меш.obj");
  std::filesystem::create_directories(scratch.path() / u8"größe");
  std::filesystem::copy_file(MORULA_ROBOTS "/arm_description/meshes/wedge.obj", scratch.path() / mesh);
  const std::u8string name = mesh.generic_u8string();
  const std::string written(reinterpret_cast<const char*>(name.data()), name.size());
  const std::string geometry = "<geometry><mesh filename='" + written + "'/></geometry>";
  scratch.file("plain.urdf", "<robot name='r'><link name='l'><visual>" + geometry + "</visual><collision>" + geometry +
                                 "</collision></link></robot>");
  const std::filesystem::path file = scratch.path() / u8"rôbot.urdf";
  std::filesystem::rename(scratch.path() / "plain.urdf", file);
  const robot::Robot robot = robot::read_robot(file);
  const robot::RobotSpheres spheres = robot::fit_spheres(robot, {.spheres = 2});
  robot::OutputOptions options;
  options.folder = scratch.path() / u8"aüs";
  const robot::SelfCollision none;
  const std::string text = robot::output_format("urdf")->write({robot, spheres, none, options}).at(0).bytes;
  EXPECT_NE(text.find("filename=\"../" + written + "\""), std::string::npos) << text;
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
TEST(RobotOutput, a_tool_is_the_end_of_the_arm_or_what_carries_the_fingers) {
  EXPECT_EQ(robot::guess_tool(fitted_arm().robot), "flange");
  EXPECT_EQ(robot::guess_tool(fitted_gripper().robot), "palm");
  robot::Robot stone;
  stone.links.emplace_back().name = "only";
  stone.root = 0;
  EXPECT_EQ(robot::guess_tool(stone), "only");
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

// tests/golden/files has a file of each version: a ball of radius 1/2, and a box that two spheres cover.
TEST(RobotOutput, own_files_of_each_version_are_read_and_newer_ones_are_refused) {
  const ScratchFolder scratch;
  std::string text;
  for (int version = 1; version <= 1; ++version) {
    const auto path =
        std::filesystem::path(MORULA_GOLDEN_FILES) / ("robot_spheres_" + std::to_string(version) + ".json");
    const auto read = robot::read_robot_spheres(path);
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read.at("palm"), (std::vector<Sphere>{{{0, 0, 0}, 0.5000001}}));
    EXPECT_EQ(read.at("finger"), (std::vector<Sphere>{{{0, 0, 0.7851444}, 0.3992903}, {{0, 0, 1.2851444}, 0.3525454}}));
    text = bytes_of(path);
  }
  for (const auto& [version, fragment] : std::vector<std::pair<std::string, std::string>>{
           {"2", "format version 2 is newer than Morula " + std::string(morula::version) +
                     ", which reads versions up to 1; update Morula"},
           {"0", "has another format"},
           {"\"1\"", "has another format"}}) {
    scratch.file("other.json",
                 std::regex_replace(text, std::regex("\"format_version\": 1"), "\"format_version\": " + version));
    try {
      robot::read_robot_spheres(scratch.path() / "other.json");
      FAIL() << version;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(fragment), std::string::npos) << error.what();
    }
  }
}

TEST(RobotOutput, joints_of_unknown_range_move_without_limits_in_simulators) {
  const ScratchFolder scratch;
  const std::string ball = "<collision><geometry><sphere radius='1'/></geometry></collision></link>";
  const auto joint = [](const std::string& kind, const std::string& ends, const std::string& limit) {
    return "<joint name='" + kind + ends + "' type='" + kind + "'><parent link='" + ends[0] + "'/><child link='" +
           ends[1] + "'/><axis xyz='0 0 1'/>" + limit + "</joint>";
  };
  std::string text = "<robot name='r'>";
  for (const char* link : {"a", "b", "c", "d", "e"}) text += std::string("<link name='") + link + "'>" + ball;
  text += joint("revolute", "ab", "") + joint("prismatic", "bc", "<limit effort='1' velocity='1'/>") +
          joint("revolute", "cd", "<limit lower='0' upper='0' effort='1' velocity='1'/>") +
          joint("revolute", "de", "<limit upper='0.5' effort='1' velocity='1'/>") + "</robot>";
  scratch.file("r.urdf", text);
  const Fitted fitted((scratch.path() / "r.urdf").string());

  const robot::Robot mjcf = robot::read_robot(scratch.file("r.xml", fitted.text("mjcf")));
  ASSERT_EQ(mjcf.independent_joints.size(), 3u) << "all but that of an empty range";
  const auto at = [](const robot::Robot& read, const char* name) { return read.joints[read.find_joint(name)]; };
  EXPECT_EQ(at(mjcf, "revoluteab").kind, robot::Joint::Kind::continuous);
  EXPECT_FALSE(at(mjcf, "prismaticbc").range_known);
  EXPECT_EQ(mjcf.find_joint("revolutecd"), robot::none);
  EXPECT_EQ(at(mjcf, "revolutede").upper, 0.5);

  const robot::Robot sdf = robot::read_robot(scratch.file("r.sdf", fitted.text("sdf")));
  ASSERT_EQ(sdf.independent_joints.size(), 4u);
  EXPECT_EQ(at(sdf, "revoluteab").kind, robot::Joint::Kind::continuous);
  EXPECT_FALSE(at(sdf, "prismaticbc").range_known);
  EXPECT_TRUE(at(sdf, "revolutecd").range_known);
  EXPECT_EQ(at(sdf, "revolutecd").upper, 0);
  EXPECT_EQ(at(sdf, "revolutede").upper, 0.5);
}

}  // namespace
}  // namespace morula::test
