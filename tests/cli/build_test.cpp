// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/build/build.hpp>
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
    const Built built = build(mesh, {.method = method, .branching = 6, .depth = 2, .seed = 7, .progress = {}});
    const Built read = read_built(bench / "t.morula", mesh);
    EXPECT_EQ(tree_hash(read.tree), tree_hash(built.tree)) << method_name;
    EXPECT_TRUE(json["covered"].get<bool>());
    EXPECT_LE(json["worst_excess"].get<double>(), 0);
    EXPECT_EQ(json["method"], method_name);
    EXPECT_EQ(json["seed"], 7);
    ASSERT_EQ(json["levels"].size(), built.tree.level_count());
    EXPECT_EQ(json["levels"][0]["nodes"], 1);
    EXPECT_EQ(json["levels"][0]["largest_radius"].get<double>(), built.tree.spheres[0].radius);
  }
}

TEST(BuildCommand, gives_the_same_file_for_any_number_of_threads) {
  const Workbench bench;
  bench.require("sample blob -o blob.obj --resolution 12");
  bench.require("build blob.obj -o one.morula --threads 1");
  bench.require("build blob.obj -o three.morula --threads 3");
  EXPECT_EQ(bench.read("one.morula"), bench.read("three.morula"));
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

}  // namespace
}  // namespace morula::test
