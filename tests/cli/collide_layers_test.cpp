// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// `morula collide --patches --thickness`: two unit squares, one above the other, whose layers are worked out by hand.
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "workbench.hpp"

namespace morula::test {
namespace {

/// Unit squares at these heights, two facets each.
std::string squares_obj(const std::vector<double>& heights) {
  std::ostringstream text;
  for (const double z : heights)
    for (const char* const corner : {"0 0 ", "1 0 ", "1 1 ", "0 1 "}) text << "v " << corner << z << '\n';
  for (std::size_t i = 0; i < heights.size(); ++i)
    text << "f " << 4 * i + 1 << ' ' << 4 * i + 2 << ' ' << 4 * i + 3 << "\nf " << 4 * i + 1 << ' ' << 4 * i + 3 << ' '
         << 4 * i + 4 << '\n';
  return text.str();
}

constexpr double layer_thickness = 0.1;

struct LayerBench : Workbench {
  LayerBench() {
    write("low.obj", squares_obj({0}));
    write("high.obj", squares_obj({0.04}));
    write("both.obj", squares_obj({0, 1}));
    std::filesystem::create_directory(*this / "motion");
    write("motion/0.obj", squares_obj({0, 1}));
    write("motion/1.obj", squares_obj({0, 0.04}));
  }
};

/// Each point of a square is `gap` away from the other square: it counts with (h - gap)² / 2h. a_is_above: 1 or -1.
void expect_squares(const nlohmann::json& frame, double gap, double a_is_above) {
  const double volume = (layer_thickness - gap) * (layer_thickness - gap) / (2 * layer_thickness);
  const double pressure = (layer_thickness - gap) / layer_thickness;
  EXPECT_NEAR(frame["volume"].get<double>(), volume, 1e-10);
  ASSERT_EQ(frame["patches"].size(), 1u);
  const auto& patch = frame["patches"][0];
  EXPECT_NEAR(patch["volume"].get<double>(), volume, 1e-10);
  EXPECT_NEAR(patch["depth"].get<double>(), layer_thickness - gap, 1e-10);
  EXPECT_NEAR(patch["mean_depth"].get<double>(), layer_thickness - gap, 1e-9);
  EXPECT_NEAR(patch["normal"][2].get<double>(), a_is_above, 1e-10);
  EXPECT_NEAR(patch["a"]["area"].get<double>(), 1, 1e-9);
  EXPECT_NEAR(patch["a"]["area_vector"][2].get<double>(), -a_is_above * pressure, 1e-9);
  EXPECT_NEAR(patch["b"]["area_vector"][2].get<double>(), a_is_above * pressure, 1e-9);
  double force = 0;
  for (const auto& point : patch["points"]) force += point["force"][2].get<double>();
  EXPECT_NEAR(force, a_is_above * pressure, 1e-9);
}

TEST(CollideLayers, of_open_squares_are_those_by_hand) {
  const LayerBench bench;
  const std::string command = "collide low.obj high.obj --patches --thickness 0.1 ";
  expect_squares(bench.require(command + "--json").json()["frames"][0], 0.04, -1);
  expect_squares(bench.require(command + "--json --translate-b 0,0,-0.1").json()["frames"][0], 0.06, 1);
  const auto far = bench.require(command + "--json --translate-b 0,0,0.1").json();
  EXPECT_EQ(far["thickness"], 0.1);
  EXPECT_EQ(far["frames"][0]["patches"].size(), 0u);
  const std::string text = bench.require(command).out;
  EXPECT_NE(in_one_line(text).find(" 0 0.0180 0.0600 0.0600 "), std::string::npos) << text;
  EXPECT_NE(text.find("1 of 1 frame have patches"), std::string::npos) << text;
  EXPECT_EQ(text.find("no tree given"), std::string::npos) << text;
}

TEST(CollideLayers, of_one_surface_are_those_of_parts_that_are_apart_at_rest) {
  const LayerBench bench;
  const auto json = bench.require("collide both.obj --motion-a motion --self --patches --thickness 0.1 --json").json();
  ASSERT_EQ(json["frames"].size(), 2u);
  EXPECT_EQ(json["a"], json["b"]);
  EXPECT_EQ(json["frames"][0]["patches"].size(), 0u);
  expect_squares(json["frames"][1], 0.04, -1);
  // Near at rest: facets up to twice the thickness apart do not count.
  const auto near = bench.require("collide motion/1.obj --self --patches --thickness 0.1 --json").json();
  EXPECT_EQ(near["frames"][0]["patches"].size(), 0u);
  EXPECT_NEAR(near["rest_distance"].get<double>(), 0.2, 1e-15);
}

TEST(CollideLayers, are_rows_of_a_table) {
  const LayerBench bench;
  bench.require("collide both.obj low.obj --motion-a motion --translate-b 0,0,1.05 --patches --thickness 0.1 -o p.csv");
  std::istringstream lines(bench.read("p.csv"));
  std::vector<std::string> rows;
  for (std::string line; std::getline(lines, line);) rows.push_back(line);
  ASSERT_EQ(rows.size(), 2u) << "the second frame has no patch";
  EXPECT_EQ(rows[0].substr(0, 30), "frame_a,frame_b,patch,volume,d");
  std::istringstream cells(rows[1]);
  std::string a, b, id, volume;
  std::getline(cells, a, ','), std::getline(cells, b, ','), std::getline(cells, id, ',');
  std::getline(cells, volume, ',');
  EXPECT_EQ(a + b + id, "0.objlow.obj0");
  EXPECT_NEAR(std::stod(volume), 0.05 * 0.05 / 0.2, 1e-10);
}

TEST(CollideLayers, refuse_what_shows_none_and_are_what_closed_patches_name) {
  const LayerBench bench;
  bench.expect_refused("collide low.obj high.obj --patches", "--thickness takes open surfaces");
  bench.expect_refused("collide low.obj high.obj --thickness 0.1", "add --patches");
  bench.expect_refused("collide low.obj --self --thickness 0.1", "add --patches");
  bench.expect_refused("collide low.obj --patches --thickness 0.1", "low.obj is one body");
  bench.expect_refused("collide --scene room.json --thickness 0.1", "--thickness is for one or two surfaces");
  for (const std::string thickness : {"0", "-1", "nan", "inf", "1e308"})
    bench.expect_refused("collide low.obj high.obj --patches --thickness " + thickness, "--thickness");
  const std::string command = "collide low.obj high.obj --patches --thickness 0.1 -o p.csv ";
  for (const std::string option : {"--tree-a t.morula", "--tree-b t.morula", "--rule swept"})
    bench.expect_refused(command + option, option.substr(0, option.find(' ')) + " is for spheres");
  for (const std::string option : {"--budget 10", "--margin 1", "--crossings", "--within 1"})
    bench.expect_refused(command + option, option.substr(0, option.find(' ')) + " shows no patches");
  bench.expect_refused("collide low.obj high.obj --patches --thickness 0.1 -o p.txt", "patches are written as .csv");
  bench.expect_refused("collide low.obj high.obj --patches --thickness 0.1 -o low.obj", "low.obj");
}

}  // namespace
}  // namespace morula::test
