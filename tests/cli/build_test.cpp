// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <morula/generators/build.hpp>
#include <morula/io/tree_file.hpp>

#include "workbench.hpp"

namespace morula::test {
namespace {

TEST(BuildCommand, writes_the_tree_that_the_library_builds) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 12");
  const Mesh mesh = read_mesh(bench / "limb.obj");
  for (const Method method : all_methods()) {
    const std::string method_name(name(method));
    const auto json =
        bench.require("build limb.obj -o t.morula --method " + method_name + " --branching 6 --depth 2 --seed 7 --json")
            .json();
    const CoveredTree model = build(mesh, {.method = method, .branching = 6, .depth = 2, .seed = 7, .progress = {}});
    const CoveredTree read = read_covered_tree(bench / "t.morula", mesh);
    EXPECT_EQ(tree_hash(read.tree), tree_hash(model.tree)) << method_name;
    EXPECT_TRUE(json["covered"].get<bool>());
    EXPECT_LE(json["worst_excess"].get<double>(), 0);
    EXPECT_EQ(json["method"], method_name);
    EXPECT_EQ(json["seed"], 7);
    ASSERT_EQ(json["levels"].size(), model.tree.level_count());
    EXPECT_EQ(json["levels"][0]["nodes"], 1);
    EXPECT_EQ(json["levels"][0]["largest_radius"].get<double>(), model.tree.spheres[0].radius);
  }
}

// The largest distance of the corners and the middles of facets from the spheres of a file.
double sampled_gap(const Mesh& mesh, const SphereTree& tree, std::size_t level) {
  double largest = 0;
  const auto look_at = [&](const Vec3& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const Sphere& s : level_set_spheres(tree, level)) least = std::min(least, distance(s.center, p) - s.radius);
    largest = std::max(largest, least);
  };
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const auto [a, b, c] = mesh.corners(f);
    for (const Vec3& p : {a, b, c, (a + b + c) / 3.0}) look_at(p);
  }
  return largest;
}

TEST(BuildCommand, covers_within_a_tolerance_and_reports_the_spheres_of_the_file) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 12");
  const Mesh mesh = read_mesh(bench / "limb.obj");
  double last = std::numeric_limits<double>::infinity();
  for (const std::string tolerance : {"0", "0.02", "0.08"}) {
    const nlohmann::json report =
        bench.require("build limb.obj -o t.json --quality draft --spheres 8 --report --json --tolerance " + tolerance)
            .json();
    const SphereTree tree = read_tree(bench / "t.json").tree;
    EXPECT_EQ(report["covered"], tolerance == "0");
    EXPECT_EQ(report.contains("within"), tolerance != "0");
    EXPECT_LE(report.value("within", 0.0), std::stod(tolerance));
    EXPECT_LE(report["worst_excess"].get<double>(), std::stod(tolerance));
    EXPECT_EQ(report["tree_hash"], bench.require("info t.json --json").json()["tree_hash"]);
    for (std::size_t level = 0; level < tree.level_count(); ++level) {
      EXPECT_LE(sampled_gap(mesh, tree, level), std::stod(tolerance) + 1e-12) << level;
      EXPECT_EQ(sampled_gap(mesh, tree, level) > 1e-12, tolerance != "0") << level;
    }
    EXPECT_EQ(report["levels"][0]["largest_radius"].get<double>(), tree.spheres[0].radius);
    const double now = report["levels"].back()["looseness"];
    EXPECT_LT(now, last);
    last = now;
  }
  // One flat list, trees, and a tolerance beyond the body.
  for (const char* output : {"t.ply", "t.npz", "t.sph", "t.json"}) {
    const std::string build = std::string("build limb.obj --quality draft --spheres 4 -o ") + output;
    const std::string text = bench.require(build + " --tolerance 0.02").out;
    EXPECT_NE(text.find("covers        within 0.0200: "), std::string::npos) << text;
    EXPECT_EQ(bench.require(build).out.find(" within "), std::string::npos);
  }
  EXPECT_EQ(bench.require("build limb.obj -o t.json --spheres 4 --tolerance 50 --json").json()["within"], 50);
}

TEST(BuildCommand, refuses_tolerances_that_it_cannot_keep) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  for (const char* length : {"-1", "nan", "inf", "x", "1e31"})
    bench.expect_refused(std::string("build bar.obj -o t.json --tolerance ") + length, "--tolerance");
  bench.expect_refused("build bar.obj -o t.json --tolerance 0.1 --method grid", "belongs to the method optimized");
  bench.expect_refused("build bar.obj -o t.json --tolerance 0.1 --nested", "without --nested");
  bench.expect_refused("build bar.obj -o t.morula --tolerance 0.1", ".morula holds trees that cover");
}

void expect_same_file_for_any_number_of_threads(const std::string& options) {
  const Workbench bench;
  bench.require("sample blob -o blob.obj --resolution 12");
  bench.require("build blob.obj -o one.morula --threads 1" + options);
  bench.require("build blob.obj -o three.morula --threads 3" + options);
  EXPECT_EQ(bench.read("one.morula"), bench.read("three.morula"));
}

TEST(BuildCommand, adds_trees_for_known_poses) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 8");
  bench.require("deform bar.obj -o bent.npy --stretch 2 --frames 4");
  const auto poses = [&](const std::string& of) {
    return bench.require("build bar.obj -o t.morula --quality fast --depth 2 --json --poses " + of).json()["poses"];
  };
  const auto strains = poses("strains");
  EXPECT_GT(strains["trees"].size(), 0u);
  EXPECT_EQ(strains["source"], "strains");
  EXPECT_EQ(read_covered_tree(bench / "t.morula", read_mesh(bench / "bar.obj")).poses.size(), strains["trees"].size());
  const auto bent = poses("bent.npy");
  EXPECT_EQ(bent["source"], "bent.npy");
  EXPECT_GT(bent["trees"].size(), 0u);
}

TEST(BuildCommand, refuses_poses_before_it_builds) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 96");
  bench.require("sample bar -o bar.obj --resolution 8");
  bench.require("deform bar.obj -o bent.npy --bend 90 --frames 3");
  for (const auto& [poses, words] : std::vector<std::pair<std::string, std::string>>{
           {"strain", "did you mean strains?"}, {"nowhere", "no such folder"}, {"bent.npy", "vertices"}}) {
    // A build of best quality would take far longer than this.
    const std::string line = "build limb.obj -o t.morula --quality best --poses " + poses;
    const CommandResult result =
        Workbench::has_shell() ? bench.shell("timeout 10 \"$MORULA\" " + line) : bench.run(line);
    EXPECT_EQ(result.exit_code, 2) << poses;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(bench / "t.morula")) << poses;
  }
}

TEST(BuildCommand, gives_the_same_file_for_any_number_of_threads) {
  expect_same_file_for_any_number_of_threads(" --quality fast");
}

TEST(LongBuildCommand, of_default_quality_gives_the_same_file_for_any_number_of_threads) {
  expect_same_file_for_any_number_of_threads("");
}

TEST(BuildCommand, options_out_of_range_are_refused_with_nothing_written) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  const auto before = bench.listing();
  for (const char* options :
       {"--branching 1", "--branching 65", "--depth -1", "--depth 9", "--threads 0", "--seed x"}) {
    const CommandResult result = bench.run(std::string("build bar.obj -o bar.morula ") + options);
    EXPECT_EQ(result.exit_code, 2) << options;
    EXPECT_EQ(result.err.rfind("morula: error: ", 0), 0u) << result.err;
  }
  EXPECT_EQ(bench.listing(), before);
}

TEST(BuildCommand, prints_no_progress_into_files) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  EXPECT_EQ(bench.require("build bar.obj -o bar.morula --method octree").err, "");
}

TEST(BuildCommand, goes_no_deeper_than_the_facets_justify_unless_told_to) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 3");
  ASSERT_LT(read_mesh(bench / "bar.obj").facet_count(), 256U);
  const auto shallow = bench.require("build bar.obj -o plain.morula --json").json();
  EXPECT_EQ(shallow["depth"], 1);
  EXPECT_LE(shallow["spheres"], 8);
  bench.require("build bar.obj -o auto.morula --depth auto");
  EXPECT_EQ(bench.read("plain.morula"), bench.read("auto.morula"));
  const auto deep = bench.require("build bar.obj -o deep.morula --depth 2 --json").json();
  EXPECT_EQ(deep["depth"], 2);
  EXPECT_GT(deep["spheres"], 8);
  for (const char* depth : {"9", "-1", "1.5", "automatic", "99999999999", "999999999999999999999"}) {
    const CommandResult result = bench.run(std::string("build bar.obj -o x.morula --depth ") + depth);
    EXPECT_EQ(result.exit_code, 2) << depth;
    EXPECT_EQ(result.err.rfind("morula: error: ", 0), 0u) << result.err;
  }
}

TEST(BuildCommand, makes_flat_sets_and_writes_them_as_balls) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 12");
  const Mesh mesh = read_mesh(bench / "limb.obj");
  const auto json = bench.require("build limb.obj -o t.morula --method octree --spheres 30 --json").json();
  EXPECT_EQ(json["spheres"], 30);
  EXPECT_EQ(json["spheres_asked"], 30);
  EXPECT_TRUE(json["complete"].get<bool>());
  const CoveredTree read = read_covered_tree(bench / "t.morula", mesh);
  EXPECT_EQ(tree_hash(read.tree), tree_hash(build(mesh, {.method = Method::octree, .spheres = 30}).tree));
  bench.require("build limb.obj -o balls.ply --method octree --spheres 30");
  EXPECT_NE(bench.read("balls.ply").find("element vertex 30\n"), std::string::npos);
  const auto within = bench.require("build limb.obj -o t.sph --method octree --max-protrusion 0.3 --json").json();
  EXPECT_LE(within["protrusion_bound"].get<double>(), 0.3);
  EXPECT_EQ(within["max_protrusion_asked"], 0.3);
}

TEST(BuildCommand, exits_with_1_when_the_protrusion_or_the_time_is_not_enough) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 12");
  const CommandResult far =
      bench.run("build limb.obj -o far.morula --method octree --max-protrusion 0.01 --spheres 9 --json");
  EXPECT_EQ(far.exit_code, 1) << far.err;
  EXPECT_FALSE(far.json()["complete"].get<bool>());
  EXPECT_GT(far.json()["protrusion_bound"].get<double>(), 0.01);
  bench.require("info far.morula --check --mesh limb.obj");
  const CommandResult late = bench.run("build limb.obj -o late.morula --depth 8 --time-limit 0.05");
  EXPECT_EQ(late.exit_code, 1) << late.err;
  EXPECT_NE(late.out.find("the time limit of 0.05 s was over"), std::string::npos) << late.out;
  bench.require("info late.morula --check --mesh limb.obj");
}

TEST(BuildCommand, reports_every_level_as_measure_does) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 12");
  const auto json = bench.require("build limb.obj -o t.morula --depth 2 --report --json").json();
  const auto measured = bench.require("measure limb.obj t.morula --resolution 160 --json").json();
  ASSERT_EQ(json["levels"].size(), 3u);
  for (std::size_t level = 0; level < 3; ++level) {
    const auto& told = json["levels"][level];
    const auto& expected = measured["frames"][0]["levels"][level];
    EXPECT_EQ(told["spheres"], expected["spheres"]);
    EXPECT_EQ(told["looseness"], expected["looseness"]);
    EXPECT_EQ(told["protrusion_worst"], expected["protrusion_worst"]);
    EXPECT_NEAR(told["protrusion_mean"].get<double>(), expected["protrusion_mean"].get<double>(), 1e-12);
    EXPECT_GE(told["seconds"].get<double>(), 0);
  }
  const auto plain = bench.require("build limb.obj -o t.morula --depth 2 --json").json();
  EXPECT_FALSE(plain["levels"][0].contains("looseness"));
  // Below the root the longest bar is level 1's, 24 characters.
  const std::string whole = "  ████████████████████████\n";
  for (const auto& [options, drawn] :
       {std::pair{"", "mean radius below the root"}, {" --report", "looseness below the root"}}) {
    const std::string text = bench.require(std::string("build limb.obj -o t.morula --depth 2") + options).out;
    EXPECT_NE(text.find(drawn), std::string::npos) << text;
    const std::size_t first = text.find(whole);
    EXPECT_NE(text.substr(0, first).find("\n    1 "), std::string::npos) << text;
    EXPECT_EQ(text.find(whole, first + 1), std::string::npos) << text;
  }
}

TEST(BuildCommand, reports_no_looseness_of_an_open_mesh) {
  const Workbench bench;
  bench.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.2\nf 1 2 3\nf 2 4 3\n");
  const auto json = bench.require("build open.obj -o t.sph --depth 1 --report --json").json();
  EXPECT_TRUE(json["levels"][0]["looseness"].is_null());
  EXPECT_TRUE(json["levels"][0]["protrusion_worst"].is_null());
  EXPECT_NE(bench.require("build open.obj -o t.sph --depth 1 --report").out.find("n/a"), std::string::npos);
}

TEST(BuildCommand, refuses_contradictions_with_nothing_written) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  const auto before = bench.listing();
  for (const char* options :
       {"-o t.morula --spheres 9 --depth 2", "-o t.morula --max-protrusion 0.1 --depth 3", "-o t.ply",
        "-o t.morula --spheres 0", "-o t.morula --spheres -4", "-o t.morula --spheres 1e3",
        "-o t.morula --max-protrusion 0", "-o t.morula --max-protrusion nan", "-o t.morula --time-limit 0",
        "-o t.morula --time-limit -1", "-o t.morula --method grid --quality best",
        "-o t.morula --method optimized --quality good"}) {
    const CommandResult result = bench.run(std::string("build bar.obj ") + options);
    EXPECT_EQ(result.exit_code, 2) << options;
    EXPECT_EQ(result.err.rfind("morula: error: ", 0), 0u) << result.err;
  }
  EXPECT_EQ(bench.listing(), before);
}

}  // namespace
}  // namespace morula::test
