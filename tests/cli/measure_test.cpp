// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/io/tree_file.hpp>
#include <sstream>

#include "workbench.hpp"

namespace morula::test {
namespace {

TEST(MeasureCommand, built_trees_leave_nothing_bare_at_any_level) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 16");
  for (const char* method : {"octree", "grid"}) {
    bench.require(std::string("build limb.obj -o limb.morula --depth 3 --method ") + method);
    const auto levels =
        bench.require("measure limb.obj limb.morula --json --resolution 64").json()["frames"][0]["levels"];
    ASSERT_EQ(levels.size(), 4u) << method;
    for (const auto& level : levels) {
      EXPECT_TRUE(level["covered"].get<bool>()) << method << level;
      EXPECT_EQ(level["uncovered_area"].get<double>(), 0) << method << level;
      EXPECT_EQ(level["uncovered_distance"].get<double>(), 0) << method << level;
      EXPECT_GT(level["looseness"].get<double>(), 0) << method << level;
      EXPECT_GE(level["protrusion_worst"].get<double>(), level["protrusion_mean"].get<double>());
    }
    EXPECT_LT(levels[3]["looseness"].get<double>(), levels[0]["looseness"].get<double>()) << method;
  }
}

TEST(MeasureCommand, a_bare_tree_is_measured_as_it_is_and_said_not_to_cover) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 8");
  bench.write("small.sph", "1 8\n0 0 0 1 0\n");
  const CommandResult text = bench.require("measure bar.obj small.sph");
  EXPECT_NE(text.out.find("Does not cover: level 0 leaves "), std::string::npos) << text.out;
  const auto level = bench.require("measure bar.obj small.sph --json").json()["frames"][0]["levels"][0];
  EXPECT_FALSE(level["covered"].get<bool>());
  // The bar is 4 x 1 x 1 about the origin: its far corners are |(2, ½, ½)| − 1 from the unit ball, and what is bare is
  // everything of the surface but the four strips inside the ball.
  EXPECT_NEAR(level["uncovered_distance"].get<double>(), std::sqrt(4.5) - 1, 1e-6);
  EXPECT_GT(level["uncovered_area"].get<double>(), 0.4);
  EXPECT_LT(level["uncovered_area"].get<double>(), 1.0);
}

TEST(MeasureCommand, open_meshes_get_cover_and_no_guess_about_volume) {
  const Workbench bench;
  bench.write("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  bench.require("build square.obj -o square.morula --method octree --depth 1");
  const CommandResult text = bench.require("measure square.obj square.morula");
  EXPECT_NE(text.out.find("n/a: the mesh is open (4 boundary edges)"), std::string::npos) << text.out;
  const auto level = bench.require("measure square.obj square.morula --json").json()["frames"][0]["levels"][0];
  EXPECT_TRUE(level["looseness"].is_null());
  EXPECT_TRUE(level["missed_volume"].is_null());
  EXPECT_TRUE(level["protrusion_worst"].is_null());
  EXPECT_TRUE(level["covered"].get<bool>());
}

TEST(MeasureCommand, csv_holds_the_digits_of_the_json) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 8");
  bench.require("build bar.obj -o bar.morula --method octree --depth 1");
  const auto json = bench.require("measure bar.obj bar.morula --json --csv bar.csv --resolution 32").json();
  std::istringstream lines(bench.read("bar.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line.rfind("frame,tree,level,spheres,looseness,missed_volume,uncovered_area,uncovered_distance,", 0), 0u)
      << line;
  for (const auto& level : json["frames"][0]["levels"]) {
    ASSERT_TRUE(std::getline(lines, line));
    std::istringstream cells(line);
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    ASSERT_EQ(row.size(), 13u);
    EXPECT_EQ(row[0], "bar.obj");
    EXPECT_EQ(std::stod(row[4]), level["looseness"].get<double>());
    EXPECT_EQ(std::stod(row[10]), level["protrusion_worst"].get<double>());
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST(MeasureCommand, has_curobos_figures_when_asked_for) {
  const Workbench bench;
  bench.write("cube.off",
              "OFF\n8 6 0\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n"
              "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
  bench.write("about.sph", "1 8\n0 0 0 2 0\n");
  const auto plain = bench.require("measure cube.off about.sph --json").json();
  EXPECT_FALSE(plain["frames"][0]["levels"][0].contains("curobo"));
  const auto level = bench.require("measure cube.off about.sph --json --curobo --csv cube.csv")
                         .json()["frames"][0]["levels"][0]["curobo"];
  EXPECT_EQ(level["coverage"], 1.0);
  EXPECT_EQ(level["protrusion"], 1.0);
  EXPECT_NEAR(level["protrusion_dist_max"].get<double>(), 1.0, 0.02);
  EXPECT_GT(level["protrusion_dist_p95"].get<double>(), level["protrusion_dist_mean"].get<double>());
  EXPECT_EQ(level["surface_gap_mean"], 0.0);
  EXPECT_EQ(level["max_uncovered_gap"], 0.0);
  EXPECT_NEAR(level["volume_ratio"].get<double>(), 4.18879, 1e-4);
  std::istringstream lines(bench.read("cube.csv"));
  std::string header, row;
  std::getline(lines, header);
  std::getline(lines, row);
  EXPECT_NE(header.find(",voxel_edge,curobo_coverage,curobo_protrusion,"), std::string::npos) << header;
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(row.begin(), row.end(), ','));
  const std::string text = bench.require("measure cube.off about.sph --curobo").out;
  EXPECT_NE(text.find("cuRobo's figures, from samples"), std::string::npos) << text;
  EXPECT_NE(text.find("4.19"), std::string::npos) << text;
}

TEST(MeasureCommand, frames_and_trees_are_paired_by_number) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 6");
  bench.require("build bar.obj -o bar.morula --method octree --depth 1");
  // Eleven frames: by letters frame 10 would come before frame 2.
  bench.require("deform bar.obj -o motion --stretch 3 --frames 11 --one-way");
  bench.require("update bar.obj bar.morula motion -o spheres");
  for (int i = 0; i < 11; ++i) {
    const std::string digits = (i < 10 ? "000" : "00") + std::to_string(i);
    std::filesystem::rename(bench / ("spheres/" + digits + ".sph"),
                            bench / ("spheres/frame" + std::to_string(i) + ".sph"));
  }
  const auto frames =
      bench.require("measure bar.obj spheres --motion motion --json --no-protrusion --resolution 16").json()["frames"];
  ASSERT_EQ(frames.size(), 11u);
  for (std::size_t i = 0; i < 11; ++i) {
    EXPECT_EQ(frames[i]["tree"], "spheres/frame" + std::to_string(i) + ".sph");
    for (const auto& level : frames[i]["levels"]) EXPECT_TRUE(level["covered"].get<bool>()) << i << level;
  }
  // Paired with rest positions the spheres of the longest pose would not fit the others.
  std::filesystem::remove(bench / "spheres/frame10.sph");
  const CommandResult fewer = bench.run("measure bar.obj spheres --motion motion");
  EXPECT_EQ(fewer.exit_code, 2);
  EXPECT_NE(fewer.err.find("11 frames in motion but 10 trees in spheres"), std::string::npos) << fewer.err;
  EXPECT_EQ(bench.run("measure bar.obj spheres").exit_code, 2);
}

TEST(MeasureCommand, reads_spheres_about_the_center_of_the_box) {
  const Workbench bench;
  bench.write("far.obj", "v 9 9 9\nv 11 9 9\nv 9 11 9\nv 9 9 11\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  bench.write("far.sph", "1 8\n0 0 0 1.8 0\n");
  const auto covered = [&](const std::string& options) {
    return bench.require("measure far.obj far.sph --json --resolution 16 " + options)
        .json()["frames"][0]["levels"][0]["covered"]
        .get<bool>();
  };
  EXPECT_FALSE(covered(""));
  EXPECT_TRUE(covered("--sph-origin bbox-center"));
  EXPECT_TRUE(covered("--sph-origin 10,10,10"));
  EXPECT_EQ(bench.run("measure far.obj far.sph --sph-origin middle").exit_code, 2);
}

}  // namespace
}  // namespace morula::test
