// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// `morula collide --patches`: boxes whose overlap is a box, worked out by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "workbench.hpp"

namespace morula::test {
namespace {

struct PatchBox {
  double x0, x1, y0, y1, z0, z1;
};

/// The twelve facets of a box, outward if its upper corner exceeds the lower one along an even number of axes.
std::string box_obj(const PatchBox& box, std::size_t facet_count = 12) {
  std::ostringstream text;
  for (int corner = 0; corner < 8; ++corner)
    text << "v " << (corner & 1 ? box.x1 : box.x0) << ' ' << (corner & 2 ? box.y1 : box.y0) << ' '
         << (corner & 4 ? box.z1 : box.z0) << '\n';
  const char* const facets[]{"1 3 4", "1 4 2", "5 6 8", "5 8 7", "1 2 6", "1 6 5",
                             "3 7 8", "3 8 4", "1 5 7", "1 7 3", "2 4 8", "2 8 6"};
  for (std::size_t f = 0; f < facet_count; ++f) text << "f " << facets[f] << '\n';
  return text.str();
}

/// A unit cube, and a plate above whose lower side is at the height 0.7.
struct PatchBench : Workbench {
  PatchBench() {
    write("cube.obj", box_obj({0, 1, 0, 1, 0, 1}));
    write("plate.obj", box_obj({-1, 2, -1, 2, 0.7, 3}));
  }
  void write_motion(const std::string& folder, const std::vector<PatchBox>& boxes) const {
    std::filesystem::create_directory(*this / folder);
    for (std::size_t f = 0; f < boxes.size(); ++f)
      write(folder + "/000" + std::to_string(f) + ".obj", box_obj(boxes[f]));
  }
};

void expect_vector(const nlohmann::json& found, double x, double y, double z) {
  EXPECT_NEAR(found[0].get<double>(), x, 1e-12);
  EXPECT_NEAR(found[1].get<double>(), y, 1e-12);
  EXPECT_NEAR(found[2].get<double>(), z, 1e-12);
}

/// The overlap is the top of the cube, `depth` high: its volume is the depth, since its base is 1.
void expect_top_of_cube(const nlohmann::json& frame, double depth, double top) {
  EXPECT_TRUE(frame["certified"]);
  EXPECT_NEAR(frame["volume"].get<double>(), depth, 1e-12);
  ASSERT_EQ(frame["patches"].size(), 1u);
  const auto& patch = frame["patches"][0];
  EXPECT_NEAR(patch["volume"].get<double>(), depth, 1e-12);
  EXPECT_NEAR(patch["depth"].get<double>(), depth, 1e-12);
  EXPECT_NEAR(patch["mean_depth"].get<double>(), depth, 1e-12);
  expect_vector(patch["normal"], 0, 0, -1);
  expect_vector(patch["centroid"], 0.5, 0.5, top - depth / 2);
  EXPECT_NEAR(patch["a"]["area"].get<double>(), 1 + 4 * depth, 1e-12);
  EXPECT_NEAR(patch["b"]["area"].get<double>(), 1, 1e-12);
  expect_vector(patch["a"]["area_vector"], 0, 0, 1);
  expect_vector(patch["b"]["area_vector"], 0, 0, -1);
  ASSERT_EQ(patch["points"].size(), 4u);
  double force = 0, volume = 0;
  for (const auto& point : patch["points"]) {
    force += point["force"][2].get<double>();
    volume += point["volume"].get<double>();
    EXPECT_NEAR(point["on_a"]["point"][2].get<double>(), top, 1e-12);
    EXPECT_NEAR(point["on_b"]["point"][2].get<double>(), top - depth, 1e-12);
  }
  EXPECT_NEAR(force, -1, 1e-12);
  EXPECT_NEAR(volume, depth, 1e-12);
}

TEST(CollidePatches, of_boxes_are_those_by_hand) {
  const PatchBench bench;
  const auto json = bench.require("collide cube.obj plate.obj --patches --json").json();
  ASSERT_EQ(json["frames"].size(), 1u);
  expect_top_of_cube(json["frames"][0], 0.3, 1);
  const CommandResult text = bench.require("collide cube.obj plate.obj --patches");
  EXPECT_NE(in_one_line(text.out).find(" 0 0.300 0.300 0.300 "), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("1 of 1 frame have patches"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("no tree given for A and B"), std::string::npos) << text.out;
}

TEST(CollidePatches, of_one_mesh_are_those_of_its_parts) {
  const PatchBench bench;
  std::string both = box_obj({0, 1, 0, 1, 0, 1}), plate = box_obj({-1, 2, -1, 2, 0.7, 3});
  std::istringstream lines(plate);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "f") {
      both += "f";
      for (int corner; words >> corner;) both += " " + std::to_string(corner + 8);
      both += "\n";
    } else {
      both += line + "\n";
    }
  }
  bench.write("both.obj", both);
  const auto json = bench.require("collide both.obj --self --patches --json").json();
  ASSERT_EQ(json["frames"].size(), 1u);
  expect_top_of_cube(json["frames"][0], 0.3, 1);
  EXPECT_NE(bench.require("collide both.obj --self --patches").out.find("no tree given for A:"), std::string::npos);
  bench.expect_refused("collide both.obj --patches", "add --self");
  bench.expect_refused("collide both.obj cube.obj --self --patches", "--self with --patches is for one body");
  bench.expect_refused("collide both.obj --self --patches --translate-b 1,0,0", "there is no body B");
}

// A quarter turn about the z axis maps the plate to x from -2 to 1: one to the right, it is where it was.
TEST(CollidePatches, follow_poses_and_motions) {
  const PatchBench bench;
  bench.write_motion("motion", {{0, 1, 0, 1, 0, 1}, {0, 1, 0, 1, 0.125, 1.125}, {0, 1, 0, 1, -1, 0}});
  const std::string command =
      "collide cube.obj plate.obj --patches --motion-a motion --rotate-b 0,0,1,90 --translate-b 1,0,0.1 ";
  const auto frames = bench.require(command + "--json -o patches.csv").json()["frames"];
  ASSERT_EQ(frames.size(), 3u);
  expect_top_of_cube(frames[0], 0.2, 1);
  expect_top_of_cube(frames[1], 0.325, 1.125);
  EXPECT_EQ(frames[0]["patches"][0]["id"], frames[1]["patches"][0]["id"]);
  EXPECT_EQ(frames[2]["patches"].size(), 0u);
  EXPECT_EQ(frames[2]["volume"], 0);
  EXPECT_NE(bench.require(command).out.find("2 of 3 frames have patches"), std::string::npos);

  std::istringstream csv(bench.read("patches.csv"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(csv, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 3u) << "a header and a row for each patch";
  const auto cells = [](const std::string& line) {
    std::vector<std::string> result;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) result.push_back(cell);
    return result;
  };
  const std::vector<std::string> header = cells(lines[0]);
  for (std::size_t f = 0; f < 2; ++f) {
    const std::vector<std::string> row = cells(lines[f + 1]);
    ASSERT_EQ(row.size(), header.size());
    const auto at = [&](const std::string& name) {
      const auto found = std::find(header.begin(), header.end(), name);
      EXPECT_NE(found, header.end()) << name;
      return row[static_cast<std::size_t>(found - header.begin())];
    };
    const double depth = f == 0 ? 0.2 : 0.325;
    EXPECT_NEAR(std::stod(at("volume")), depth, 1e-12);
    EXPECT_NEAR(std::stod(at("depth")), depth, 1e-12);
    EXPECT_NEAR(std::stod(at("normal_z")), -1, 1e-12);
    EXPECT_NEAR(std::stod(at("centroid_z")), 0.8 + depth / 2, 1e-12);
    EXPECT_NEAR(std::stod(at("force_z")), -1, 1e-12);
    EXPECT_EQ(at("points"), "4");
  }
}

TEST(CollidePatches, refuse_surfaces_by_name_with_a_remedy_that_works) {
  const PatchBench bench;
  bench.write("open.obj", box_obj({0, 1, 0, 1, 0, 1}, 11));
  bench.write("inverted.obj", box_obj({1, 0, 0, 1, 0, 1}));
  bench.write("mixed.obj", box_obj({0, 1, 0, 1, 0, 1}, 11) + "f 2 6 8\n");
  bench.expect_refused("collide open.obj plate.obj --patches", "open.obj is open (3 boundary edges): morula repair");
  bench.expect_refused("collide plate.obj open.obj --patches", "open.obj is open");
  bench.expect_refused("collide inverted.obj plate.obj --patches -o p.csv",
                       "inverted.obj is inside out (volume -1.00): morula repair");
  bench.expect_refused("collide plate.obj mixed.obj --patches -o p.csv", "mixed.obj is not oriented");
  for (const std::string name : {"open", "inverted", "mixed"}) {
    bench.require("repair " + name + ".obj -o mended.obj --cap 3");
    const auto frame = bench.require("collide mended.obj plate.obj --patches --json").json()["frames"][0];
    expect_top_of_cube(frame, 0.3, 1);
  }
  bench.write_motion("mirrored", {{0, 1, 0, 1, 0, 1}, {1, 0, 0, 1, 0, 1}});
  bench.expect_refused("collide cube.obj plate.obj --patches --motion-a mirrored -o p.csv",
                       "cube.obj is inside out where it meets");
}

TEST(CollidePatches, refuse_options_that_show_no_patches) {
  const PatchBench bench;
  const std::string command = "collide cube.obj plate.obj --patches -o p.csv ";
  for (const std::string option : {"--budget 10", "--level 0", "--margin 1", "--crossings", "--within 1", "--carry",
                                   "--plot p.svg", "--priority level"})
    bench.expect_refused(command + option, option.substr(0, option.find(' ')) + " shows no patches");
  bench.expect_refused("collide cube.obj --patches", "cube.obj is one body");
  bench.expect_refused("collide --scene room.json --patches", "--patches is for two bodies");
  bench.expect_refused("collide cube.obj plate.obj --patches -o p.txt", "patches are written as .csv");
}

}  // namespace
}  // namespace morula::test
