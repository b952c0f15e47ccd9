// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/io/motion_file.hpp>
#include <morula/io/tree_file.hpp>

#ifdef MORULA_HAS_GLTF
#include "../io/gltf_files.hpp"
#endif
#include "workbench.hpp"

namespace morula::test {
namespace {

TEST(ConvertCommand, meshes_keep_their_bits_through_every_format) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 6");
  bench.require("convert limb.obj limb.off");
  bench.require("convert limb.off limb.ply");
  bench.require("convert limb.ply again.obj");
  EXPECT_EQ(mesh_hash(read_mesh(bench / "again.obj")), mesh_hash(read_mesh(bench / "limb.obj")));
}

TEST(ConvertCommand, spheres_keep_their_bits_and_covers_stay_in_native_files) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 8");
  bench.require("build limb.obj -o limb.morula --depth 2");
  const CommandResult bare = bench.require("convert limb.morula limb.sph");
  EXPECT_NE(bare.err.find("the cover stays behind"), std::string::npos) << bare.err;
  bench.require("convert limb.sph limb.json");
  bench.require("convert limb.morula copy.morula");
  const std::uint64_t hash = tree_hash(read_tree(bench / "limb.morula").tree);
  EXPECT_EQ(tree_hash(read_tree(bench / "limb.json").tree), hash);
  EXPECT_EQ(bench.read("copy.morula"), bench.read("limb.morula"));
}

TEST(ConvertCommand, bare_trees_need_the_mesh_to_get_a_cover) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 6");
  bench.write("bar.sph", "1 8\n0 0 0 1 0\n");
  const auto before = bench.listing();
  const CommandResult without = bench.run("convert bar.sph bar.morula");
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_NE(without.err.find("add --mesh MESH"), std::string::npos) << without.err;
  EXPECT_EQ(bench.listing(), before);
  const CommandResult with = bench.require("convert bar.sph bar.morula --mesh bar.obj");
  EXPECT_NE(with.out.find("Grown so that every level covers the mesh:"), std::string::npos) << with.out;
  EXPECT_EQ(bench.require("info bar.morula --check --mesh bar.obj").exit_code, 0);
}

TEST(ConvertCommand, does_not_cross_between_meshes_and_trees) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 6");
  bench.require("build bar.obj -o bar.morula --method octree --depth 1");
  const auto before = bench.listing();
  const CommandResult tree = bench.run("convert bar.obj x.morula");
  EXPECT_EQ(tree.exit_code, 2);
  EXPECT_NE(tree.err.find("morula build makes trees"), std::string::npos) << tree.err;
  EXPECT_EQ(bench.run("convert bar.morula x.obj").exit_code, 2);
  EXPECT_EQ(bench.run("convert bar.obj x.msh").exit_code, 2);
  EXPECT_EQ(bench.listing(), before);
}

TEST(ConvertCommand, a_mesh_alone_is_a_motion_of_one_frame) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 6");
  const Mesh mesh = read_mesh(bench / "bar.obj");
  for (const std::string output : {"one.npy", "one.mdd", "frames"}) {
    bench.require("convert bar.obj " + output);
    const Motion motion(bench / output, mesh);
    ASSERT_EQ(motion.frame_count(), 1u) << output;
    if (output != "one.mdd") {  // which holds floats
      EXPECT_EQ(motion.frame(0), mesh.positions) << output;
    }
  }
  // Several files are a motion of another one's mesh.
  bench.require("deform bar.obj -o bent --bend 30 --frames 3");
  bench.require("convert 'bent/*.obj' bent.npy --mesh bar.obj");
  EXPECT_EQ(Motion(bench / "bent.npy", mesh).frame(2), Motion(bench / "bent", mesh).frame(2));
  bench.expect_refused("convert 'bent/*.obj' again.npy", "add --mesh MESH");
  bench.expect_refused("convert bar.obj x.npy --used-only", "--used-only belongs to meshes");
}

#ifdef MORULA_HAS_GLTF
TEST(ConvertCommand, animations_of_gltf_become_frames) {
  const Workbench bench;
  bench.write("arm.gltf", bending_arm().text());
  const Mesh mesh = read_mesh(bench / "arm.gltf");
  bench.require("convert arm.gltf arm.npy");
  bench.require("convert arm.gltf named.npy --mesh arm.gltf --fps 30 --animation 0");
  EXPECT_EQ(bench.read("arm.npy"), bench.read("named.npy"));
  bench.require("convert arm.gltf slow --fps 4");
  const Motion motion(bench / "arm.npy", mesh), slow(bench / "slow", mesh), own(bench / "arm.gltf", mesh);
  ASSERT_EQ(motion.frame_count(), 31u);
  ASSERT_EQ(slow.frame_count(), 5u);
  EXPECT_EQ(motion.frame(30), own.frame(30));
  // Carried up by two within a second.
  EXPECT_NEAR(slow.frame(4).back().y - slow.frame(0).back().y, 2, 1e-6);
  bench.expect_refused("convert arm.gltf x.npy --animation 1", "there is no animation 1");
}
#endif

}  // namespace
}  // namespace morula::test
