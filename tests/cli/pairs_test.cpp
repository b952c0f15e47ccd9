// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <sstream>

#include "workbench.hpp"

namespace morula::test {
namespace {

/// A floor of two facets and, apart from it, one facet above; then below.
struct PairsBench : Workbench {
  PairsBench() {
    const std::string floor = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n", facets = "f 1 2 3\nf 1 3 4\nf 5 6 7\n";
    write("above.obj", floor + "v 0.6 0.2 0.5\nv 0.7 0.2 1.5\nv 0.6 0.3 1.5\n" + facets);
    write("below.obj", floor + "v 0.6 0.2 -0.5\nv 0.7 0.2 0.5\nv 0.6 0.3 0.5\n" + facets);
  }
};

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> all;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) all.push_back(line);
  return all;
}

TEST(PairsCommand, says_what_meets_within_a_step_and_when) {
  const PairsBench bench;
  const auto json = bench.require("pairs above.obj below.obj --swept --json -o pairs.csv").json();
  EXPECT_EQ(json["vertex_facet"], 1);
  EXPECT_EQ(json["edge_edge"], 0);
  EXPECT_NEAR(json["collision_free_step"].get<double>(), 0.5, 1e-6);
  EXPECT_LE(json["collision_free_step"].get<double>(), 0.5);
  const auto rows = lines(bench.read("pairs.csv"));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0], "kind,a0,a1,a2,b0,b1,b2,distance_or_time");
  EXPECT_EQ(rows[1].rfind("vf,4,,,0,1,2,0.4999", 0), 0u) << rows[1];
  const auto candidates = bench.require("pairs above.obj below.obj --swept --candidates --json -o all.csv").json();
  EXPECT_FALSE(candidates.contains("collision_free_step"));
  EXPECT_GT(candidates["vertex_facet"], 1);
  EXPECT_EQ(lines(bench.read("all.csv")).size(), 1 + candidates["candidates"].get<std::size_t>());
  // Nearer than half a unit it is from the beginning.
  EXPECT_EQ(bench.require("pairs above.obj below.obj --swept --distance 0.5 --json").json()["collision_free_step"], 0);
}

TEST(PairsCommand, says_what_is_near_and_what_crosses) {
  const PairsBench bench;
  const auto near = bench.require("pairs above.obj --within 0.55 --once --json -o near.csv").json();
  EXPECT_EQ(near["vertex_facet"], 1);
  EXPECT_DOUBLE_EQ(near["least_distance"], 0.5);
  EXPECT_EQ(lines(bench.read("near.csv"))[1], "vf,4,,,0,1,2,0.5");
  EXPECT_NE(bench.require("pairs above.obj --within 0.1").out.find("nothing is within 0.1"), std::string::npos);
  EXPECT_EQ(bench.require("pairs above.obj --crossing --json").json()["facet_facet"], 0);
  bench.require("pairs below.obj --crossing -o crossing.csv");
  EXPECT_EQ(bench.read("crossing.csv"), "kind,a0,a1,a2,b0,b1,b2,distance_or_time\nff,0,1,2,4,5,6,\n");
}

TEST(PairsCommand, tests_a_piece_with_itself_when_asked) {
  const PairsBench bench;
  bench.require("sample torus -o torus.obj --resolution 12");
  const CommandResult result = bench.require("pairs torus.obj --within 0.3");
  EXPECT_NE(result.err.find("add --self"), std::string::npos);
  const auto count = [&](const std::string& more) {
    const auto json = bench.require("pairs torus.obj --within 0.3 --json " + more).json();
    return json["vertex_facet"].get<int>() + json["edge_edge"].get<int>();
  };
  const int all = count("--self"), rings = count("--self --rings 2"), rest = count("--self --rest-distance 0.2");
  EXPECT_EQ(count(""), 0);
  EXPECT_GT(all, rings);
  EXPECT_GT(all, rest);
  EXPECT_EQ(count("--self --rest-distance 0.3"), 0);
  EXPECT_EQ(count("--self --rest-distance 0.2 --rest torus.obj"), rest);
  EXPECT_EQ(count("--self --threads 1"), all);
}

TEST(PairsCommand, refuses_what_makes_no_sense) {
  const PairsBench bench;
  bench.require("sample torus -o torus.obj --resolution 5");
  bench.expect_refused("pairs above.obj", "give one of --swept, --within LENGTH and --crossing");
  bench.expect_refused("pairs above.obj --crossing --within 1", "give one of --swept, --within LENGTH and --crossing");
  bench.expect_refused("pairs above.obj --swept", "--swept needs two meshes");
  bench.expect_refused("pairs above.obj below.obj --within 1", "a second mesh is the end of a step");
  bench.expect_refused("pairs above.obj torus.obj --swept", "above.obj and torus.obj are not the same mesh");
  bench.expect_refused("pairs above.obj --within -1", "--within: -1 is below 0");
  bench.expect_refused("pairs above.obj --within 1 --candidates", "belong to --swept");
  bench.expect_refused("pairs above.obj below.obj --swept --once", "--once belongs to --within");
  bench.expect_refused("pairs above.obj --within 1 --rest above.obj", "--rest belongs to --rest-distance");
  bench.expect_refused("pairs above.obj --within 1 -o pairs.txt", "pairs are written as .csv");
  bench.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n");
  bench.expect_refused("pairs bad.obj --crossing", "bad.obj");
}

}  // namespace
}  // namespace morula::test
