// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <morula/geometry/inspect.hpp>
#include <morula/robot/robot.hpp>
#include <support/scratch_folder.hpp>

namespace morula::test {
namespace {

TEST(Collada, scenes_are_placed_in_meters_and_axes_stay_as_written) {
  const Mesh mesh = robot::read_collada(MORULA_ROBOTS "/arm_description/meshes/wrist.dae");
  ASSERT_EQ(mesh.positions.size(), 8u);
  // First turned about z, then shifted, in centimeters; the second is mirrored.
  const std::vector<Vec3> expected{{0.01, 0.02, 0.03}, {0.01, 0.06, 0.03}, {-0.02, 0.02, 0.03}, {0.01, 0.02, 0.08},
                                   {0, 0, 0.1},        {-0.04, 0, 0.1},    {0, 0.03, 0.1},      {0, 0, 0.15}};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_LT(distance(mesh.positions[i], expected[i]), 1e-15) << i;
  const MeshReport report = inspect(mesh);
  ASSERT_TRUE(report.has_volume());
  EXPECT_NEAR(report.volume, 2 * 0.04 * 0.03 * 0.05 / 6, 1e-15) << "both look outward";
}

// A prism over an L of area 5 and outline 12, of height 1, as COLLADA has polygons: from each first corner, in a node
// that mirrors or not. Its area and volume are those on paper.
TEST(Collada, polygons_are_cut_as_those_of_other_files) {
  const ScratchFolder scratch;
  const std::string positions = "0 0 0 3 0 0 3 1 0 1 1 0 1 3 0 0 3 0 0 0 1 3 0 1 3 1 1 1 1 1 1 3 1 0 3 1";
  std::vector<std::vector<int>> faces{{5, 4, 3, 2, 1, 0}, {6, 7, 8, 9, 10, 11}};
  for (int k = 0; k < 6; ++k) faces.push_back({k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k});
  const auto corners = [](const std::vector<int>& face, std::size_t first) {
    std::string text;
    for (std::size_t k = 0; k < face.size(); ++k) text += std::to_string(face[(first + k) % face.size()]) + " ";
    return text;
  };
  const auto file = [&](const std::string& primitives, const std::string& scale) {
    scratch.file("l.dae",
                 "<COLLADA><library_geometries><geometry id='g'><mesh><source id='s'><float_array>" + positions +
                     "</float_array></source><vertices id='v'><input semantic='POSITION' source='#s'/></vertices>" +
                     primitives +
                     "</mesh></geometry></library_geometries><library_visual_scenes><visual_scene id='w'><node>" +
                     scale + "<instance_geometry url='#g'/></node></visual_scene></library_visual_scenes></COLLADA>");
    return scratch.path() / "l.dae";
  };
  const std::string input = "<input semantic='VERTEX' source='#v' offset='0'/>";
  for (std::size_t first = 0; first < 6; ++first) {
    std::string counts, list, polygons;
    for (const std::vector<int>& face : faces) {
      counts += std::to_string(face.size()) + " ";
      list += corners(face, first);
      polygons += "<p>" + corners(face, first) + "</p>";
    }
    for (const std::string& primitives :
         {"<polylist>" + input + "<vcount>" + counts + "</vcount><p>" + list + "</p></polylist>",
          "<polygons>" + input + polygons + "</polygons>"}) {
      for (const std::string scale : {"<scale>1 1 1</scale>", "<scale>-1 1 1</scale>"}) {
        MeshInfo info;
        const MeshReport report = inspect(robot::read_collada(file(primitives, scale), "", info));
        EXPECT_NEAR(report.area, 22, 1e-12) << primitives << scale;
        ASSERT_TRUE(report.has_volume()) << primitives << scale;
        EXPECT_NEAR(report.volume, 5, 1e-12) << primitives << scale;
        EXPECT_EQ(info.polygons, 8u);
        EXPECT_EQ(info.crossing_polygons + info.bent_polygons, 0u);
        EXPECT_TRUE(info.notes.empty());
      }
    }
  }
  // A square with a hole is the square, and says so; a polygon that crosses itself is named with its line.
  MeshInfo info;
  const std::string hole = "<polygons>" + input + "<ph><p>0 1 8 5</p><h>3 2 4</h></ph></polygons>";
  EXPECT_EQ(robot::read_collada(file(hole, ""), "", info).facets.size(), 2u);
  ASSERT_FALSE(info.notes.empty());
  EXPECT_EQ(info.notes.back(), "1 polygon has holes, which are filled; export triangles to keep them");
  const std::string bow = "<polygons>" + input + "<p>0 1 3 2 5 4</p></polygons>";
  robot::read_collada(file(bow, ""), "", info);
  EXPECT_EQ(info.crossing_polygons, 1u);
  ASSERT_FALSE(info.notes.empty());
  EXPECT_NE(info.notes.back().find("the first is polygon 0, counted from 0, on line 1"), std::string::npos)
      << info.notes.back();
  // The robot that shows it says the same of its link.
  robot::Shape shape;
  shape.kind = robot::Shape::Kind::mesh;
  shape.file = file(hole, "");
  shape.file_name = "l.dae";
  shape.line = 7;
  const robot::LinkSurface surface =
      robot::surface_of(MORULA_ROBOTS "/arm_description/urdf/arm.urdf", std::span(&shape, 1));
  ASSERT_FALSE(surface.notes.empty());
  EXPECT_EQ(surface.notes.back(),
            "mesh l.dae (line 7): 1 polygon has holes, which are filled; export triangles to keep them");
}

TEST(Collada, refuses_what_leads_nowhere) {
  const ScratchFolder scratch;
  std::ifstream stream(MORULA_ROBOTS "/arm_description/meshes/wrist.dae");
  const std::string whole{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  const std::vector<std::array<std::string, 3>> changes{
      {"url=\"#tetra\"", "url=\"#nothing\"", "there is nothing called"},
      {"url=\"#tetra\"", "url=\"http://x\"", "is in another file"},
      {"0 2 0 1 0 0", "0 2 0 9 0 0", "there is no vertex 9"},
      {"<vcount>3", "<vcount>333", "more corners than there are"},
      {"<vcount>3", "<vcount>-3", "which is no index"},
      {"0 0 0 4", "0 0 x 4", "does not hold"},
      {"<rotate>0 0 1 90", "<rotate>0 0 1", "does not hold 4 numbers"},
      {"meter=\"0.01\"", "meter=\"0\"", "is not above 0"},
      {"<instance_geometry url=\"#tetra\"/></node>\n      <node>", "</node><node id=\"n\"><instance_node url=\"#n\"/>",
       "in a circle"},
  };
  for (const auto& [old, fresh, words] : changes) {
    std::string text = whole;
    const std::size_t at = text.find(old);
    ASSERT_NE(at, std::string::npos) << old;
    text.replace(at, old.size(), fresh);
    scratch.file("x.dae", text);
    try {
      robot::read_collada(scratch.path() / "x.dae");
      ADD_FAILURE() << old << " -> " << fresh;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace morula::test
