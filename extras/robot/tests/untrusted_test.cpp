// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files that are cut short, or small and mean much.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <morula/robot/robot.hpp>
#include <support/allocations.hpp>

#include "formats.hpp"

namespace morula::test {
namespace {

TEST_F(Formats, text_cut_short_is_refused_not_followed) {
  for (const std::string& file : {arm + "mjcf/arm.xml", arm + "sdf/arm.sdf"}) {
    std::ifstream stream(file);
    const std::string whole{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    for (std::size_t end = 0; end < whole.size() - 12; end += 97) {
      const fs::path path = write("cut", whole.substr(0, end));
      EXPECT_NE(words_of([&] { robot::read_robot(path); }), "") << end;
    }
  }
}

/// A kilobyte that means much is refused before much is allocated, all allocations together.
TEST_F(Formats, small_files_that_mean_much_are_refused_with_little_memory) {
  const auto refused = [&](const std::string& name, const std::string& text, const auto& read,
                           const std::string& words) {
    const fs::path path = write(name, text);
    ASSERT_LE(text.size(), 8192u);
    const std::size_t before = allocated_bytes;
    const std::string said = words_of([&] { read(path); });
    EXPECT_LE(allocated_bytes - before, std::size_t{64} << 20) << name;
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  const auto read = [](const fs::path& path) { robot::read_robot(path); };
  std::string laughs = "<!DOCTYPE l [<!ENTITY a0 'lol'>";
  for (int i = 1; i < 12; ++i) {
    laughs += "<!ENTITY a" + std::to_string(i) + " '";
    for (int k = 0; k < 10; ++k) laughs += "&a" + std::to_string(i - 1) + ";";
    laughs += "'>";
  }
  for (const std::string root : {"mujoco", "sdf", "robot"}) {
    refused("r", laughs + "]><" + root + ">&a11;</" + root + ">", read, "entities are declared");
    std::string deep;
    for (int i = 0; i < 1000; ++i) deep += "<b>";
    refused("r", "<" + root + ">" + deep, read, "not well-formed XML");
  }
  std::string classes;
  for (int i = 0; i < 70; ++i) classes += "<default class='" + std::to_string(i) + "'><geom size='1'/>";
  for (int i = 0; i < 70; ++i) classes += "</default>";
  refused("r", "<mujoco><default>" + classes + "</default></mujoco>", read, "nested more than 64 deep");
  refused(
      "r",
      "<mujoco><worldbody><replicate count='9999'><body name='b'><joint name='j'/><geom size='1'/></body></replicate>"
      "</worldbody></mujoco>",
      read, "makes more than 10000 elements");
  // Ten levels of nodes, each of which shows the one below ten times.
  std::string nodes;
  for (int i = 0; i < 10; ++i) {
    nodes += "<node id='n" + std::to_string(i) + "'>";
    for (int k = 0; k < 10; ++k) {
      nodes += i == 0 ? "<instance_geometry url='#g'/>" : "<instance_node url='#n" + std::to_string(i - 1) + "'/>";
    }
    nodes += "</node>";
  }
  const std::string scene =
      "<COLLADA><library_geometries><geometry id='g'><mesh><source id='p'><float_array>0 0 0 1 0 0 0 1 0</float_array>"
      "</source><vertices id='v'><input semantic='POSITION' source='#p'/></vertices><triangles><input "
      "semantic='VERTEX' "
      "source='#v' offset='0'/><p>0 1 2</p></triangles></mesh></geometry></library_geometries><library_nodes>" +
      nodes +
      "</library_nodes><library_visual_scenes><visual_scene id='s'><node><instance_node url='#n9'/></node>"
      "</visual_scene></library_visual_scenes></COLLADA>";
  refused(
      "bomb.dae", scene, [](const fs::path& path) { robot::read_collada(path); }, "are shown more than 101");
}

}  // namespace
}  // namespace morula::test
