// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <morula/geometry/triangle_intersection.hpp>
#include <morula/io/mesh_file.hpp>
#include <sstream>

#include "workbench.hpp"

namespace morula::test {
namespace {

using Json = nlohmann::json;

const Json& cell_of(const Json& demo, const std::string& method, const std::string& motion, const std::string& rule) {
  for (const Json& tree : demo["trees"]) {
    for (const Json& cell : tree["cells"]) {
      if (tree["method"] == method && cell["motion"] == motion && cell["rule"] == rule) return cell;
    }
  }
  throw std::out_of_range(method + ' ' + motion + ' ' + rule);
}

Triangle corners(const Mesh& mesh, const Facet& f) {
  return {mesh.positions[f[0]], mesh.positions[f[1]], mesh.positions[f[2]]};
}

/// No budget misses a crossing of the two limbs, and the limbs that were written have as many as it says.
void expect_contacts_hold(const Workbench& bench, const Json& contacts, const std::string& text) {
  const std::vector<std::size_t> crossings = contacts["crossings"];
  ASSERT_EQ(crossings.size(), contacts["frames"].get<std::size_t>());

  const Mesh a = read_mesh(bench / "demo/limb-touching-a.obj"), b = read_mesh(bench / "demo/limb-touching-b.obj");
  std::size_t pairs = 0;
  for (const Facet& f : a.facets)
    for (const Facet& g : b.facets) pairs += intersect(corners(a, f), corners(b, g)) ? 1 : 0;
  EXPECT_GT(pairs, 0u);
  EXPECT_EQ(pairs, crossings[crossings.size() / 2]);

  ASSERT_EQ(contacts["budgets"].size(), 5u);
  double last_tests = 0;
  for (const Json& row : contacts["budgets"]) {
    EXPECT_EQ(row["missed"], 0) << row;
    EXPECT_GT(row["pair_tests"], last_tests) << row;
    last_tests = row["pair_tests"];
    if (row["budget"].is_null()) {
      EXPECT_EQ(row["finished_share"], 1) << row;
    } else {
      EXPECT_LE(row["pair_tests"], row["budget"]) << row;
    }
  }
  EXPECT_TRUE(contacts["budgets"].back()["budget"].is_null());
  EXPECT_LT(contacts["budgets"].front()["finished_share"], 1);
  EXPECT_NE(in_one_line(text).find(contacts["finding"].get<std::string>()), std::string::npos) << text;
  const std::string csv = bench.read("demo/contacts.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 6);
}

TEST(LongDemoCommand, its_figures_come_again_from_files) {
  const Workbench bench;
  const CommandResult text = bench.require("demo --quick -o demo");
  const Json demo = Json::parse(bench.read("demo/demo.json"));
  ASSERT_EQ(demo["trees"].size(), 2u);
  ASSERT_EQ(demo["trees"][0]["cells"].size(), 15u);
  const std::string frames = std::to_string(demo["frame_count"].get<int>());
  const std::string resolution = std::to_string(demo["grid"]["resolution"].get<int>());
  const std::vector<std::size_t> measured = demo["measured_frames"];

  // What the table shows, made again one command at a time, for one cell of every motion and every rule.
  const std::vector<std::array<std::string, 3>> cells{{"optimized", "stretch 2", "approach2"},
                                                      {"optimized", "twist 180", "exact"},
                                                      {"octree", "bend 90", "approach1"},
                                                      {"octree", "twist 180", "traditional"},
                                                      {"optimized", "bend 90", "weighted"}};
  for (const std::string method : {"octree", "optimized"}) {
    bench.require("build demo/limb.obj -o limb-" + method + ".morula --depth 3 --method " + method);
    EXPECT_TRUE(bench.read("limb-" + method + ".morula") == bench.read("demo/limb-" + method + ".morula"));
  }
  for (const auto& [method, motion, rule] : cells) {
    bench.require("deform demo/limb.obj -o motion --" + motion + " --frames " + frames);
    bench.require("update demo/limb.obj limb-" + method + ".morula motion -o spheres --rule " + rule);
    const Json again = bench
                           .require(
                               "measure demo/limb.obj spheres --motion motion --grid fixed --no-protrusion --json "
                               "--resolution " +
                               resolution)
                           .json();
    const Json& cell = cell_of(demo, method, motion, rule);
    ASSERT_EQ(cell["frames"].size(), measured.size());
    double worst = 0;
    for (std::size_t i = 0; i < measured.size(); ++i) {
      const Json& leaves = again["frames"][measured[i]]["levels"].back();
      for (const char* figure :
           {"looseness", "missed_volume", "union_volume", "uncovered_area", "uncovered_distance", "covered"}) {
        EXPECT_EQ(cell["frames"][i][figure], leaves[figure]) << method << ' ' << motion << ' ' << rule << ' ' << figure;
      }
      worst = std::max(worst, leaves["looseness"].get<double>());
    }
    EXPECT_EQ(cell["worst_looseness"].get<double>(), worst);
  }
}

TEST(DemoCommand, what_it_says_is_what_it_measured) {
  const Workbench bench;
  const CommandResult text = bench.require("demo --quick -o demo");
  const Json demo = Json::parse(bench.read("demo/demo.json"));
  std::size_t uncovered_motions = 0;
  double most_uncovered = 0;
  for (const Json& tree : demo["trees"]) {
    for (const Json& cell : tree["cells"]) {
      EXPECT_TRUE(cell["returns_to_rest"].get<bool>()) << tree["method"] << cell["motion"] << cell["rule"];
      if (cell["rule"] == "exact") {
        EXPECT_EQ(cell["worst_uncovered_area"].get<double>(), 0);
        EXPECT_EQ(cell["worst_uncovered_distance"].get<double>(), 0);
        EXPECT_TRUE(cell["certificate"]["covered"].get<bool>());
      }
      if (cell["rule"] == "approach2") {
        uncovered_motions += cell["worst_uncovered_area"].get<double>() > 0 ? 1 : 0;
        most_uncovered = std::max(most_uncovered, cell["worst_uncovered_area"].get<double>());
      }
    }
  }
  EXPECT_NE(in_one_line(text.out).find("exact leaves no surface uncovered"), std::string::npos) << text.out;
  EXPECT_EQ(in_one_line(text.out).find("though nothing guarantees it") != std::string::npos, uncovered_motions == 0)
      << text.out;
  if (uncovered_motions > 0) {
    std::ostringstream percentage;
    percentage.precision(1);
    percentage << std::fixed << 100 * most_uncovered << '%';
    EXPECT_NE(in_one_line(text.out).find("up to " + percentage.str()), std::string::npos) << percentage.str() << '\n'
                                                                                          << text.out;
  }
  for (const Json& finding : demo["findings"]) {
    EXPECT_NE(in_one_line(text.out).find(finding.get<std::string>()), std::string::npos) << finding;
  }

  expect_contacts_hold(bench, demo["contacts"], text.out);

  std::size_t measurements = 0;
  for (const Json& tree : demo["trees"]) {
    for (const Json& cell : tree["cells"]) measurements += cell["frames"].size();
  }
  const std::string csv = bench.read("demo/demo.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), measurements + 1);
  for (const char* name : {"limb.obj", "limb-optimized.morula", "limb-octree.morula", "limb-stretch-2.obj",
                           "limb-stretch-2-exact.sph", "limb-bend-90-approach2.sph"}) {
    EXPECT_TRUE(std::filesystem::is_regular_file(bench / (std::string("demo/") + name))) << name;
  }
}

}  // namespace
}  // namespace morula::test
