// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/geometry/mesh.hpp>
#include <morula/io/tree_file.hpp>

#include "workbench.hpp"

namespace morula::test {
namespace {

TEST(InfoCommand, says_what_a_mesh_is_good_for) {
  const Workbench bench;
  bench.require("sample two -o two.obj --resolution 8");
  const auto closed = bench.require("info two.obj --check --json").json();
  EXPECT_EQ(closed["kind"], "mesh");
  EXPECT_EQ(closed["components"], 2);
  EXPECT_TRUE(closed["closed"].get<bool>());
  EXPECT_GT(closed["volume"].get<double>(), 0);
  EXPECT_NE(bench.require("info two.obj").out.find("every figure can be measured"), std::string::npos);

  bench.write("open.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nf 1 2 3 4\n");
  const CommandResult open = bench.require("info open.obj");
  EXPECT_NE(
      open.out.find(
          "open: 4 boundary edges; looseness is measured by the winding number, n/a where the surface encloses no "
          "space; protrusion cannot be answered"),
      std::string::npos)
      << open.out;
  EXPECT_NE(open.out.find("1 vertex of no facet"), std::string::npos) << open.out;
  EXPECT_EQ(bench.run("info open.obj --check").exit_code, 1);
  EXPECT_TRUE(bench.require("info open.obj --json").json()["volume"].is_null());
}

// `info` says beforehand whether `measure` will have a looseness.
TEST(InfoCommand, promises_the_looseness_that_measure_then_has) {
  const Workbench bench;
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0.2 0.2 -1\n";
  const std::string base = "f 1 3 2\n", front = "f 1 2 4\n", side = "f 1 4 3\n", slope = "f 2 3 4\n";
  const struct {
    std::string name, facets, said;
    bool measured;
  } cases[] = {
      {"closed", base + front + side + slope, "every figure can be measured", true},
      {"turned", base + front + side + "f 2 4 3\n", "looseness counts crossings", true},
      {"open", base + front + side, "looseness is measured by the winding number", true},
      {"three-sided", base + front + side + slope + "f 1 2 5\nf 2 3 5\nf 3 1 5\n",
       "open: no boundary edge, but edges of an odd number of facets;", true},
      {"flat", base, "n/a where the surface encloses no space", false},
      {"open-turned", base + front + "f 1 3 4\n", "neither looseness nor protrusion", false},
  };
  for (const auto& [name, facets, said, measured] : cases) {
    bench.write(name + ".obj", corners + facets);
    const std::string notes = bench.require("info " + name + ".obj").out;
    EXPECT_NE(notes.find(said), std::string::npos) << name << ": " << notes;
    bench.require("build " + name + ".obj -o " + name + ".morula --method octree --depth 1");
    const std::string text = bench.require("measure " + name + ".obj " + name + ".morula").out;
    EXPECT_EQ(text.find("inside and outside are not defined") == std::string::npos, measured) << name << ": " << text;
  }
}

TEST(InfoCommand, describes_and_checks_trees) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 6");
  bench.require("build bar.obj -o bar.morula --method octree --depth 2 --seed 5");
  const auto native = bench.require("info bar.morula --check --mesh bar.obj --json").json();
  EXPECT_EQ(native["method"], "octree");
  EXPECT_EQ(native["seed"], 5);
  EXPECT_EQ(native["levels"].size(), 3u);
  EXPECT_TRUE(native["faults"].empty());
  EXPECT_GT(native["cover"]["patches"].get<int>(), 0);

  bench.require("convert bar.morula bar.sph");
  const auto bare = bench.require("info bar.sph --json").json();
  EXPECT_TRUE(bare["cover"].is_null());
  EXPECT_EQ(bare["nodes"], native["nodes"]);
  bench.write("small.sph", "1 8\n0 0 0 1 0\n");
  const auto small = bench.require("info small.sph --check --mesh bar.obj --json").json();
  EXPECT_EQ(small["growth_to_cover"]["levels"][0]["grown"], 1);
}

TEST(InfoCommand, says_whether_a_tree_is_nested) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 6");
  bench.require("build bar.obj -o bar.morula --method octree --depth 2");
  EXPECT_EQ(bench.require("info bar.morula --json").json()["nested"], false);
  EXPECT_NE(bench.require("info bar.morula").out.find("nested     no: "), std::string::npos);
  const CommandResult model = bench.require("build bar.obj -o nested.morula --method octree --depth 2 --nested");
  EXPECT_NE(model.out.find("nested        yes"), std::string::npos) << model.out;
  EXPECT_EQ(bench.require("info nested.morula --check --mesh bar.obj --json").json()["nested"], true);
  const CommandResult info = bench.require("info nested.morula");
  EXPECT_NE(info.out.find("nested     yes: every sphere contains its children's\n"), std::string::npos) << info.out;
  bench.require("convert nested.morula nested.sph");
  EXPECT_NE(bench.require("info nested.sph").out.find("though the file does not say so"), std::string::npos);
  bench.require("convert bar.morula bar.sph");
  bench.require("convert bar.sph again.morula --mesh bar.obj --nested");
  EXPECT_EQ(bench.require("info again.morula --check --mesh bar.obj --json").json()["nested"], true);
  bench.require("convert bar.sph again.json --nested");
  EXPECT_TRUE(read_tree(bench / "again.json").tree.nested);
  bench.expect_refused("convert bar.obj bar.off --nested", "--nested is for trees");
  bench.expect_refused("convert bar.morula bar.ply --nested", "balls have no parents");
}

TEST(InfoCommand, finds_patches_that_do_not_tile_the_mesh) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 6");
  bench.require("build bar.obj -o bar.morula --method octree --depth 2");
  const Mesh mesh = read_mesh(bench / "bar.obj");
  CoveredTree model = read_covered_tree(bench / "bar.morula", mesh);
  // The first patch loses its area: every sphere still wraps its region, but part of the surface belongs to nobody.
  const std::span<const std::uint32_t> patch = model.cover.patch(0);
  std::fill_n(model.cover.corners.begin(), patch.size(), patch[0]);
  write_tree(bench / "bad.morula", model);
  const CommandResult result = bench.run("info bad.morula --check --mesh bar.obj");
  EXPECT_EQ(result.exit_code, 1) << result.out << result.err;
  EXPECT_NE(result.out.find("fault "), std::string::npos) << result.out;
  const CommandResult json = bench.run("info bad.morula --check --mesh bar.obj --json");
  EXPECT_EQ(json.exit_code, 1);
  EXPECT_FALSE(json.json()["faults"].empty());
}

TEST(InfoCommand, a_mesh_that_is_not_the_trees_own_is_refused) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 6");
  bench.require("sample plate -o other.obj --resolution 6");
  bench.require("build bar.obj -o bar.morula --method octree --depth 1");
  EXPECT_EQ(bench.run("info bar.morula --check --mesh other.obj").exit_code, 2);
  EXPECT_EQ(bench.run("info bar.obj --mesh other.obj").exit_code, 2);
}

TEST(InfoCommand, says_how_polygons_were_cut_and_what_was_left_out) {
  const Workbench bench;
  // A dart that no fan about its first corner fills, a bow tie, and a word that OBJ does not know.
  bench.write("odd.obj",
              "v 1 1 0\nv 0 4 0\nv 0 0 0\nv 4 0 0\nv 0 0 1\nv 1 1 1\nv 1 0 1\nv 0 1 1\n"
              "f 2 3 4 1\nf 5 6 7 8\nface 1 2 3\n");
  const CommandResult text = bench.require("info odd.obj");
  EXPECT_NE(text.out.find("polygons  2, cut into facets; 1 concave, cut by ears; 1 crosses itself\n"),
            std::string::npos)
      << text.out;
  EXPECT_NE(text.out.find("- 1 statement that OBJ does not know is left out"), std::string::npos) << text.out;
  const auto json = bench.require("info odd.obj --json").json();
  EXPECT_EQ(json["polygons"], 2);
  EXPECT_EQ(json["concave_polygons"], 1);
  EXPECT_EQ(json["crossing_polygons"], 1);
  EXPECT_EQ(json["bent_polygons"], 0);
  // Other commands say so on stderr.
  const CommandResult convert = bench.require("convert odd.obj even.obj");
  EXPECT_NE(convert.err.find("note: odd.obj: 1 statement that OBJ does not know"), std::string::npos) << convert.err;
  EXPECT_NE(convert.err.find("note: odd.obj: 1 face crosses itself"), std::string::npos) << convert.err;
  EXPECT_EQ(bench.require("info even.obj").out.find("polygons"), std::string::npos);
}

}  // namespace
}  // namespace morula::test
