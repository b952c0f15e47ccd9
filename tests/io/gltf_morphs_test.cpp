// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Morph targets and influences of glTF, against positions worked out by hand and the motion of the same file.
#include <gtest/gtest.h>

#include <cstring>
#include <morula/io/skin_file.hpp>
#include <morula/update/body.hpp>
#include <morula/update/skin_morphs.hpp>

#include "files.hpp"
#include "gltf_files.hpp"

namespace morula {
namespace {

using test::bending_arm;
using test::expect_file_error;
using test::GltfMaker;
using test::Json;
using test::ScratchFolder;
using test::tetrahedron;

// An arm of two targets on a skin, which an animation moves together with a joint, beside a body without a skin, which
// its node scales, with a target of its own that is sparse. Weights at rest are not 0.
GltfMaker morphing_arm() {
  GltfMaker file = bending_arm();
  std::vector<float> up(30), out(30);
  for (std::size_t v = 0; v < 10; ++v) {
    up[3 * v + 2] = 0.25f * static_cast<float>(v % 3);
    out[3 * v + 1] = v % 2 == 0 ? -0.5f : 0.75f;
  }
  const int first = file.floats(up, "VEC3"), second = file.floats(out, "VEC3");
  const int where = file.view(std::string("\2\0", 2));
  const std::vector<float> moved{0, 0.5f, 0};
  std::string bytes(12, '\0');
  std::memcpy(bytes.data(), moved.data(), 12);
  const int values = file.view(bytes);
  const int sparse = file.accessor({{"componentType", 5126},
                                    {"count", 4},
                                    {"type", "VEC3"},
                                    {"sparse",
                                     {{"count", 1},
                                      {"indices", {{"bufferView", where}, {"componentType", 5123}}},
                                      {"values", {{"bufferView", values}}}}}});
  file.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", first}}, {{"POSITION", second}}};
  file.json["meshes"][0]["weights"] = {0.5, 0};
  file.json["meshes"][1]["primitives"][0]["targets"] = {{{"POSITION", sparse}}};
  const int times = file.floats({0, 1}, "SCALAR"), arm = file.floats({0.5f, 0, -1, 2}, "SCALAR"),
            other = file.floats({0, 3}, "SCALAR");
  Json& animation = file.json["animations"][0];
  animation["samplers"].push_back({{"input", times}, {"output", arm}});
  animation["samplers"].push_back({{"input", times}, {"output", other}});
  animation["channels"].push_back({{"sampler", 2}, {"target", {{"node", 0}, {"path", "weights"}}}});
  animation["channels"].push_back({{"sampler", 3}, {"target", {{"node", 3}, {"path", "weights"}}}});
  return file;
}

TEST(GltfMorphs, targets_and_bones_make_the_same_frames) {
  const ScratchFolder folder;
  const auto gltf = folder.file("arm.glb", morphing_arm().glb());
  const Mesh mesh = read_mesh(gltf);
  EXPECT_EQ(mesh.positions[2], (Vec3{1, 0, 0.25})) << "half of the first target";
  const Skin skin = read_skin(gltf, mesh);
  const Modes targets = read_modes(gltf, mesh);
  ASSERT_EQ(targets.mode_count, 3u);
  EXPECT_EQ(targets.mode(0)[2], (Vec3{0, 0, 0.5}));
  EXPECT_EQ(targets.mode(1)[1], (Vec3{0, 0.75, 0}));
  EXPECT_EQ(targets.mode(2)[12], (Vec3{0, 1, 0})) << "scaled by its node";
  EXPECT_EQ(targets.mode(2)[11], Vec3{});
  EXPECT_EQ(targets.mode(1)[12], Vec3{});
  const MotionOptions options{.frames_per_second = 7};
  const BoneFrames bones = read_bone_frames(gltf, skin.bone_count, targets.mode_count, options);
  const Motion motion(gltf, mesh, options);
  ASSERT_EQ(bones.frame_count(), motion.frame_count());
  ASSERT_EQ(bones.morphs.frame_count(), motion.frame_count());
  EXPECT_EQ(bones.morphs.frame(0)[0], 0);
  EXPECT_EQ(bones.morphs.frame(7)[0], -1.5);
  EXPECT_EQ(bones.morphs.frame(7)[2], 3);
  std::vector<Vec3> positions(mesh.vertex_count());
  for (std::size_t i = 0; i < bones.frame_count(); ++i) {
    move_by_skin(skin, targets, mesh.positions, bones.frame(i), bones.morphs.frame(i), positions);
    const std::vector<Vec3> frame = motion.frame(i);
    for (std::size_t v = 0; v < frame.size(); ++v) EXPECT_LE(distance(positions[v], frame[v]), 1e-14) << i << ' ' << v;
  }
  move_by_skin(skin, targets, mesh.positions, bones.frame(0), bones.morphs.frame(0), positions);
  EXPECT_EQ(positions, mesh.positions) << "at rest, bit for bit";
  expect_file_error(gltf, 0, "read_modes()", [&] { read_bone_frames(gltf, skin.bone_count); });
  expect_file_error(gltf, 0, "read_modes()", [&] { read_bone_frames(gltf, skin.bone_count, {}); });  // no targets
  expect_file_error(gltf, 0, "has 3 morph targets, but 2", [&] { read_bone_frames(gltf, skin.bone_count, 2); });
  expect_file_error(gltf, 0, "but the mesh has 4", [&] { read_modes(gltf, Mesh{std::vector<Vec3>(4), {{0, 1, 2}}}); });
}

TEST(GltfMorphs, a_file_without_targets_has_no_modes) {
  const ScratchFolder folder;
  const auto gltf = folder.file("arm.glb", bending_arm().glb());
  const Mesh mesh = read_mesh(gltf);
  const Modes none = read_modes(gltf, mesh);
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.vertex_count, mesh.vertex_count());
  const BoneFrames bones = read_bone_frames(gltf, 3, none.mode_count);
  EXPECT_EQ(bones.transforms, read_bone_frames(gltf, 3).transforms);
  EXPECT_TRUE(bones.morphs.frame(1).empty());
}

// Many nodes that show one mesh have targets of their own, with a displacement for every vertex of all.
TEST(GltfMorphs, targets_of_more_nodes_than_the_file_can_mean_are_refused) {
  const ScratchFolder folder;
  GltfMaker file = tetrahedron();
  Json targets = Json::array();
  for (int k = 0; k < 60; ++k) targets.push_back({{"POSITION", 0}});
  file.json["meshes"][0]["primitives"][0]["targets"] = targets;
  for (int k = 1; k < 400; ++k) file.json["scenes"][0]["nodes"].push_back(file.push("nodes", {{"mesh", 0}}));
  const auto gltf = folder.file("many.gltf", file.text());
  const Mesh mesh = read_mesh(gltf);
  expect_file_error(gltf, 0, "24000 morph targets", [&] { read_modes(gltf, mesh); });
}

// Also of nodes that no scene shows: the weights of each are kept.
TEST(GltfMorphs, weights_of_more_nodes_than_the_file_can_mean_are_refused) {
  const ScratchFolder folder;
  GltfMaker file = tetrahedron();
  Json targets = Json::array(), nodes = file.json["nodes"];
  for (int k = 0; k < 7000; ++k) targets.push_back({{"NORMAL", 0}});
  for (int k = 0; k < 7000; ++k) nodes.push_back({{"mesh", 0}});
  file.json["meshes"][0]["primitives"][0]["targets"] = targets;
  file.json["nodes"] = nodes;
  const auto gltf = folder.file("many.gltf", file.text());
  expect_file_error(gltf, 0, "more weights of morph targets", [&] { read_mesh(gltf); });
}

// Two sets of four, in bytes and in words; a joint that comes twice, weights that add up to 1 as far as bytes can, or
// far from it.
TEST(GltfMorphs, influences_of_two_sets_are_divided_by_their_sum) {
  GltfMaker file = tetrahedron();
  file.json["nodes"][0]["skin"] = 0;
  for (int k = 0; k < 6; ++k)
    file.json["scenes"][0]["nodes"].push_back(file.push("nodes", {{"translation", {k, 0, 0}}}));
  file.push("skins", {{"joints", {1, 2, 3, 4, 5, 6}}});
  const std::vector<std::uint8_t> joints{0, 1, 2, 3, 0, 0, 0, 0, 5, 5, 0, 0, 1, 0, 0, 0},
      weights{31, 32, 33, 31, 255, 0, 0, 0, 100, 54, 0, 0, 7, 0, 0, 0};
  const std::vector<std::uint8_t> more_joints{4, 5, 0, 1, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0};
  const std::vector<std::uint16_t> more_weights{8000, 8100, 8200, 8300, 0, 0, 0, 0, 25000, 0, 0, 0, 0, 0, 0, 0};
  Json& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = file.add(joints, "VEC4", 5121);
  attributes["WEIGHTS_0"] = file.add(weights, "VEC4", 5121, true);
  attributes["JOINTS_1"] = file.add(more_joints, "VEC4", 5121);
  attributes["WEIGHTS_1"] = file.add(more_weights, "VEC4", 5123, true);
  const ScratchFolder folder;
  const auto gltf = folder.file("body.glb", file.glb());
  const Mesh mesh = read_mesh(gltf);
  const Skin skin = read_skin(gltf, mesh);
  ASSERT_EQ(skin.begin, (std::vector<std::uint32_t>{0, 8, 9, 12, 13}));
  EXPECT_EQ(skin.bones, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 0, 1, 0, 5, 5, 5, 1}));
  const double sum = 127 / 255. + 32600 / 65535.;
  EXPECT_NEAR(skin.weights[1], 32 / 255. / sum, 1e-15);
  EXPECT_NEAR(skin.weights[7], 8300 / 65535. / sum, 1e-15);
  EXPECT_EQ(skin.weights[12], 1);
  for (std::size_t v = 0; v < 4; ++v) {
    double total = 0;
    for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k) total += skin.weights[k];
    EXPECT_NEAR(total, 1, 1e-15) << v;
  }
}

}  // namespace
}  // namespace morula
