// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "workbench.hpp"

namespace morula::test {
namespace {

TEST(ClumpCommand, writes_a_proven_cover_and_reports_mass_and_moments) {
  const Workbench bench;
  bench.require("sample blob -o stone.obj --resolution 12");
  const nlohmann::json report =
      bench.require("clump stone.obj -o stone.json --spheres 6 --quality draft --density 2 --json").json();
  EXPECT_EQ(report["proven"], true);
  EXPECT_EQ(report["uncovered_distance"], 0);
  EXPECT_LE(report["spheres"], 6);
  EXPECT_EQ(report["format"], "json");
  EXPECT_NEAR(report["mass"], 2 * report["union_volume"].get<double>(), 1e-12);
  const nlohmann::json file = nlohmann::json::parse(bench.read("stone.json"));
  EXPECT_EQ(file["spheres"].size(), report["spheres"]);
  EXPECT_EQ(file["mass"], report["mass"]);
  EXPECT_EQ(file["inertia"], report["inertia"]);
  EXPECT_EQ(file["principal_moments"], report["principal_moments"]);
  EXPECT_EQ(file["center_of_mass"], report["center_of_mass"]);
  const std::string text = bench.require("clump stone.obj -o stone.clu --spheres 6 --quality draft").out;
  for (const char* words : {"covers   yes", "moments  ", "principal ones", "written  stone.clu for Kratos"}) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  }
}

TEST(ClumpCommand, writes_every_format_the_same_for_any_number_of_threads) {
  const Workbench bench;
  bench.require("sample blob -o stone.obj --resolution 12");
  for (const std::string format : {"liggghts", "yade", "chrono", "kratos", "json"}) {
    bench.require("clump stone.obj -o one --spheres 4 --quality draft --threads 1 --format " + format);
    bench.require("clump stone.obj -o three --spheres 4 --quality draft --threads 3 --format " + format);
    EXPECT_EQ(bench.read("one"), bench.read("three"));
    EXPECT_FALSE(bench.read("one").empty());
  }
  const nlohmann::json inner = bench.require("clump stone.obj -o inner.csv --kind inner --spheres 5 --json").json();
  EXPECT_EQ(inner["proven"], true);
  EXPECT_EQ(inner["protrusion"], 0);
  EXPECT_LT(inner["union_volume"], inner["object_volume"]);
}

TEST(ClumpCommand, covers_within_a_tolerance_and_says_so) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 12");
  const std::string clump = "clump limb.obj --spheres 6 --quality draft ";
  double last = std::numeric_limits<double>::infinity();
  for (const std::string tolerance : {"0", "0.02", "0.08"}) {
    const nlohmann::json report = bench.require(clump + "--json -o limb.json --tolerance " + tolerance).json();
    EXPECT_EQ(report["proven"], true);
    EXPECT_LE(report["within"].get<double>(), std::stod(tolerance));
    EXPECT_EQ(report["within"] == 0, tolerance == "0");
    EXPECT_LE(report["uncovered_distance"], report["within"]);
    EXPECT_LT(report["outside_volume"].get<double>(), last);
    last = report["outside_volume"];
    EXPECT_EQ(nlohmann::json::parse(bench.read("limb.json"))["within"], report["within"]);
  }
  EXPECT_NE(bench.require(clump + "-o limb.clu --tolerance 0.02").out.find("covers   within 0.0"), std::string::npos);
  EXPECT_NE(bench.read("limb.clu").find("// every point of the surface lies within 0.0"), std::string::npos);
  const nlohmann::json points = bench.require(clump + "-o limb.clu --tolerance 50 --json").json();
  EXPECT_EQ(points["proven"], true) << "a tolerance may exceed the body";
  EXPECT_EQ(points["notes"].size(), 1u);
  EXPECT_TRUE(bench.require("clump limb.obj -o in.csv --kind inner --spheres 3 --json").json()["within"].is_null());
}

TEST(ClumpCommand, bad_use_is_one_line_with_a_remedy_and_nothing_is_written) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  bench.expect_refused("clump bar.obj -o bar.txt", "add --format, one of liggghts, yade, chrono, kratos, json");
  bench.expect_refused("clump bar.obj -o bar.txt --format ligghts", "did you mean liggghts?");
  bench.expect_refused("clump bar.obj -o bar.clu --kind iner", "did you mean inner?");
  bench.expect_refused("clump bar.obj -o bar.clu --kind inner --max-protrusion 1", "belongs to covers");
  bench.expect_refused("clump bar.obj -o bar.clu --min-radius 2 --max-radius 1", "--max-radius is below --min-radius");
  bench.expect_refused("clump bar.obj -o bar.clu --kind inner --min-radius 2", "lower the smallest radius");
  bench.expect_refused("clump flat.obj -o bar.clu --kind inner", "need a closed surface");
  bench.expect_refused("clump bar.obj -o bar.clu --density 0", "--density");
  bench.expect_refused("clump bar.obj -o bar.clu --spheres 0", "--spheres");
  bench.expect_refused("clump bar.obj -o nowhere/bar.clu", "there is no folder nowhere");
  for (const char* length : {"-1", "nan", "inf", "1e31", "x"})
    bench.expect_refused(std::string("clump bar.obj -o bar.clu --tolerance ") + length, "--tolerance");
  bench.expect_refused("clump bar.obj -o bar.clu --kind inner --tolerance 1", "belongs to covers");
  bench.expect_refused("clump bar.obj -o bar.clu --method grid --tolerance 1", "method optimized");
  bench.expect_refused("clump none.obj -o bar.clu", "none.obj");
  bench.expect_refused("clump bar.obj -o bar.obj --format yade", "is also what is read");
}

}  // namespace
}  // namespace morula::test
