// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The command on meshes whose corners are vertices of their own. Facets keep their order, so each corner of the output
// is compared with the same corner of the input.
#include <gtest/gtest.h>

#include <morula/io/motion_file.hpp>
#include <morula/io/skin_file.hpp>
#include <sstream>

#ifdef MORULA_HAS_GLTF
#include "../io/gltf_files.hpp"
#endif
#include "workbench.hpp"

namespace morula::test {
namespace {

/// A tetrahedron of 12 vertices: three for each facet.
constexpr const char* corners_of_four =
    "v 0 0 0\nv 0 2 0\nv 2 0 0\nv 0 0 0\nv 2 0 0\nv 0 0 2\n"
    "v 2 0 0\nv 0 2 0\nv 0 0 2\nv 0 2 0\nv 0 0 0\nv 0 0 2\n"
    "f 1 2 3\nf 4 5 6\nf 7 8 9\nf 10 11 12\n";

/// "vertex,welded" and a row per vertex, ascending.
std::vector<std::uint32_t> read_weld_map(const std::string& text) {
  std::istringstream stream(text);
  std::string line;
  std::getline(stream, line);
  EXPECT_EQ(line, "vertex,welded");
  std::vector<std::uint32_t> map;
  while (std::getline(stream, line)) {
    const std::size_t comma = line.find(',');
    EXPECT_EQ(line.substr(0, comma), std::to_string(map.size()));
    map.push_back(static_cast<std::uint32_t>(std::stoul(line.substr(comma + 1))));
  }
  return map;
}

void expect_same_corners(const Mesh& mesh, std::span<const Vec3> positions, const Mesh& other,
                         std::span<const Vec3> other_positions) {
  ASSERT_EQ(mesh.facets.size(), other.facets.size());
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(other_positions[other.facets[f][k]], positions[mesh.facets[f][k]]) << f << ' ' << k;
}

TEST(WeldOption, converts_corners_to_a_whole_mesh_and_says_where_each_vertex_went) {
  const Workbench bench;
  bench.write("corners.obj", corners_of_four);
  const CommandResult done = bench.require("convert corners.obj whole.ply --weld --index-map map.csv");
  EXPECT_NE(done.err.find("corners.obj: 8 of 12 vertices merged into others\n"), std::string::npos) << done.err;
  const Mesh corners = read_mesh(bench / "corners.obj"), whole = read_mesh(bench / "whole.ply");
  EXPECT_EQ(whole.vertex_count(), 4u);
  expect_same_corners(corners, corners.positions, whole, whole.positions);
  const std::vector<std::uint32_t> map = read_weld_map(bench.read("map.csv"));
  ASSERT_EQ(map.size(), 12u);
  for (std::size_t v = 0; v < 12; ++v) EXPECT_EQ(whole.positions[map[v]], corners.positions[v]) << v;
  // Six edges; the corners alone have twelve.
  EXPECT_EQ(bench.require("pairs whole.ply --crossing --json").json()["edges"], 6);
}

TEST(WeldOption, leaves_no_pair_of_a_surface_where_it_is_whole) {
  const Workbench bench;
  bench.write("corners.obj", corners_of_four);
  const auto count = [](const nlohmann::json& json) {
    return json["vertex_facet"].get<int>() + json["edge_edge"].get<int>();
  };
  const CommandResult cut = bench.require("pairs corners.obj --within 0.01 --self --json");
  EXPECT_GT(count(cut.json()), 0);
  EXPECT_EQ(cut.json()["duplicate_vertices"], 8);
  EXPECT_EQ(cut.json()["least_distance"], 0);
  EXPECT_NE(cut.err.find("8 vertices at the position of another vertex"), std::string::npos) << cut.err;
  EXPECT_NE(cut.err.find("add --weld"), std::string::npos) << cut.err;
  const CommandResult whole = bench.require("pairs corners.obj --within 0.01 --self --weld --json");
  EXPECT_EQ(count(whole.json()), 0);
  EXPECT_EQ(whole.json()["duplicate_vertices"], 0);
  EXPECT_EQ(whole.json()["vertices"], 4);
  EXPECT_EQ(whole.err.find("add --weld"), std::string::npos) << whole.err;
  // The end of a step and the mesh at rest may have the vertices of the file or those of the welded mesh.
  bench.require("convert corners.obj whole.ply --weld");
  for (const std::string to : {"corners.obj", "whole.ply"})
    EXPECT_EQ(count(bench.require("pairs corners.obj " + to + " --swept --self --weld --json").json()), 0) << to;
  std::string torn = corners_of_four;
  torn.replace(torn.rfind("v "), 2, "v 1");
  bench.write("torn.obj", torn);
  for (const std::string rest : {"torn.obj --swept", "--within 0.01 --rest-distance 0.1 --rest torn.obj"}) {
    const CommandResult parted = bench.run("pairs corners.obj " + rest + " --self --weld");
    EXPECT_EQ(parted.exit_code, 2);
    EXPECT_NE(parted.err.find("error: torn.obj: vertices 5 and 11 are merged, but they are at different positions"),
              std::string::npos)
        << parted.err;
  }
}

// Every command that reads a mesh and what moves it takes the files of the unwelded mesh with --weld.
TEST(WeldOption, serves_all_commands_on_files_of_the_unwelded_mesh) {
  const Workbench bench;
  bench.write("corners.obj", corners_of_four);
  const Mesh corners = read_mesh(bench / "corners.obj");
  std::vector<Vec3> moved = corners.positions;
  for (Vec3& p : moved) p = {p.y, 3 * p.z, p.x - 1};
  MotionWriter writer(bench / "moved.npy", corners, 2);
  writer.write(corners.positions);
  writer.write(moved);
  writer.finish();
  const auto built = bench.require("build corners.obj -o t.morula --weld --depth 1 --json").json();
  EXPECT_EQ(built["vertices"], 4);
  EXPECT_EQ(bench.require("update corners.obj t.morula moved.npy -o s.npz --weld --json").json()["vertices"], 4);
  EXPECT_EQ(bench.require("measure corners.obj t.morula --weld --json").json()["frames"].size(), 1u);
  EXPECT_EQ(bench.require("measure corners.obj s.npz --motion moved.npy --weld --json").json()["frames"].size(), 2u);
  bench.require("collide corners.obj corners.obj --motion-a moved.npy --weld --json");
  const CommandResult cut = bench.require("collide corners.obj --self --json"),
                      whole = bench.require("collide corners.obj --self --weld --json");
  EXPECT_NE(cut.err.find("add --weld"), std::string::npos) << cut.err;
  EXPECT_EQ(whole.err.find("add --weld"), std::string::npos) << whole.err;
  // At rest they are at distance 0 and left out: there is nothing to say.
  const CommandResult rest = bench.require("pairs corners.obj --within 0.01 --self --rest-distance 0.001 --json");
  EXPECT_EQ(rest.err.find("add --weld"), std::string::npos) << rest.err;
  EXPECT_EQ(bench.run("collide --scene x.json --weld").exit_code, 2);
}

TEST(WeldOption, converts_motions_unless_merged_vertices_part) {
  const Workbench bench;
  bench.write("corners.obj", corners_of_four);
  const Mesh corners = read_mesh(bench / "corners.obj");
  std::vector<Vec3> moved = corners.positions;
  for (Vec3& p : moved) p = {p.y, 3 * p.z, p.x - 1};
  for (const bool parts : {false, true}) {
    MotionWriter writer(bench / (parts ? "torn.npy" : "moved.npy"), corners, 2);
    writer.write(corners.positions);
    if (parts) moved[11].y += 1e-12;
    writer.write(moved);
    writer.finish();
  }
  bench.require("convert corners.obj whole.ply --weld");
  bench.require("convert moved.npy whole.npy --mesh corners.obj --weld --index-map map.csv");
  const Mesh whole = read_mesh(bench / "whole.ply");
  const Motion before(bench / "moved.npy", corners), after(bench / "whole.npy", whole);
  ASSERT_EQ(after.frame_count(), 2u);
  for (std::size_t f = 0; f < 2; ++f) expect_same_corners(corners, before.frame(f), whole, after.frame(f));
  EXPECT_EQ(read_weld_map(bench.read("map.csv")).size(), 12u);
  const auto listing = bench.listing();
  const CommandResult torn = bench.run("convert torn.npy x.npy --mesh corners.obj --weld --index-map x.csv");
  EXPECT_EQ(torn.exit_code, 2);
  EXPECT_NE(torn.err.find("torn.npy: frame 1: vertices 5 and 11 of the unwelded mesh are merged, but they are at "
                          "different positions; read the mesh without welding"),
            std::string::npos)
      << torn.err;
  EXPECT_EQ(bench.listing(), listing);
}

TEST(WeldOption, is_refused_where_nothing_is_welded) {
  const Workbench bench;
  bench.write("corners.obj", corners_of_four);
  bench.write("one.sph", "1 8\n0 0 0 9 0\n");
  bench.require("convert corners.obj corners.npy");
  bench.expect_refused("convert corners.obj x.obj --index-map map.csv", "belongs to --used-only or --weld");
  bench.expect_refused("convert corners.obj x.npy --index-map map.csv", "belongs to --used-only or --weld");
  bench.expect_refused("convert corners.obj x.obj --weld --used-only --index-map map.csv", "numbers of one step");
  bench.expect_refused("convert corners.npy x.npy --mesh corners.obj --weld --index-map corners.obj",
                       "is also what is read");
  bench.expect_refused("convert one.sph x.json --weld", "--weld belongs to meshes and motions");
}

/// Vertex v of the tetrahedron is on the second of two bones with weight x/4; vertex 11 has a weight of its own.
Skin skin_of_corners(const Mesh& corners) {
  Skin skin{.bone_count = 2, .begin = {0}};
  for (std::size_t v = 0; v < corners.vertex_count(); ++v) {
    const double second = v == 11 ? 0.75 : corners.positions[v].x / 4;
    for (const std::uint32_t bone : {0u, 1u}) {
      skin.bones.push_back(bone);
      skin.weights.push_back(bone == 0 ? 1 - second : second);
    }
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

TEST(WeldOption, of_repair_keeps_the_poses_of_a_skin) {
  const Workbench bench;
  bench.write("corners.obj", corners_of_four);
  const Mesh corners = read_mesh(bench / "corners.obj");
  const Skin skin = skin_of_corners(corners);
  write_skin(bench / "skin.npy", skin);
  bench.require("repair corners.obj -o whole.ply --no-orient --skin skin.npy --skin-output whole.npy");
  const Mesh whole = read_mesh(bench / "whole.ply");
  EXPECT_EQ(whole.vertex_count(), 5u);  // vertex 11 stays apart
  const Skin kept = read_skin(bench / "whole.npy", whole);
  ASSERT_EQ(kept.bone_count, 2u);
  const std::vector<AffineTransform> bones{
      {.columns = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}}, .translation = {0.5, 0, 0.25}},
      {.columns = {Vec3{1, 0, 0}, Vec3{0, 0, 2}, Vec3{0, -1, 0}}, .translation = {0, 3, 0}}};
  std::vector<Vec3> before(12), after(5);
  move_by_skin(skin, corners.positions, bones, before);
  move_by_skin(kept, whole.positions, bones, after);
  expect_same_corners(corners, before, whole, after);
  // Vertex 11 has moved away from where it was, so its own weight matters.
  EXPECT_NE(before[11], before[5]);
  bench.expect_refused("repair corners.obj -o x.ply --skin skin.npy", "belong together");
  bench.expect_refused("repair corners.obj -o x.ply --skin-output x.npy", "belong together");
  bench.expect_refused("repair corners.obj -o x.ply --skin skin.npy --skin-output x.csv", "skins are written as .npy");
  bench.expect_refused("repair corners.obj -o x.ply --skin skin.npy --skin-output skin.npy", "is also what is read");
}

#ifdef MORULA_HAS_GLTF
/// Two triangles of six vertices with an edge in common, on two joints; the second one turns. An odd one has a vertex
/// there with another weight.
GltfMaker hinge(bool is_odd) {
  GltfMaker file;
  const int positions = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3");
  std::vector<float> weights;
  for (int v = 0; v < 6; ++v) {
    const float second = v == 0 ? 0.0f : v == 4 ? 1.0f : is_odd && v == 5 ? 0.25f : 0.5f;
    for (const float w : {1 - second, second, 0.0f, 0.0f}) weights.push_back(w);
  }
  std::vector<std::uint16_t> joints;
  for (int v = 0; v < 6; ++v)
    for (const std::uint16_t j : {0, 1, 0, 0}) joints.push_back(j);
  const int w = file.floats(weights, "VEC4"), j = file.shorts(joints, "VEC4"),
            f = file.shorts({0, 1, 2, 3, 4, 5}, "SCALAR");
  const int times = file.floats({0, 1}, "SCALAR");
  const int turns = file.floats({0, 0, 0, 1, 0.70710678f, 0, 0, 0.70710678f}, "VEC4");
  file.push("meshes",
            {{"primitives",
              {{{"attributes", {{"POSITION", positions}, {"JOINTS_0", j}, {"WEIGHTS_0", w}}}, {"indices", f}}}}});
  file.push("nodes", {{"mesh", 0}, {"skin", 0}});
  file.push("nodes", {{"children", {2}}});
  file.push("nodes", Json::object());
  file.push("scenes", {{"nodes", {0, 1}}});
  file.push("skins", {{"joints", {1, 2}}});
  file.push("animations", {{"samplers", {{{"input", times}, {"output", turns}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}}}});
  return file;
}

TEST(WeldOption, takes_the_frames_of_a_gltf_and_its_skin) {
  for (const bool is_odd : {false, true}) {
    const Workbench bench;
    bench.write("hinge.gltf", hinge(is_odd).text());
    const CommandResult done = bench.require("convert hinge.gltf whole.ply --weld");
    EXPECT_EQ(done.err.find("may move apart") != std::string::npos, is_odd) << done.err;
    bench.require("convert hinge.gltf whole.npy --weld --fps 4");
    bench.require("convert hinge.gltf apart.npy --fps 4");
    bench.require("convert hinge.gltf frames --weld --fps 4");
    bench.require("repair hinge.gltf -o mended.ply --no-orient --skin hinge.gltf --skin-output skin.npy");
    const Mesh apart = read_mesh(bench / "hinge.gltf"), whole = read_mesh(bench / "whole.ply");
    EXPECT_EQ(apart.vertex_count(), 6u);
    EXPECT_EQ(whole.vertex_count(), is_odd ? 5u : 4u);
    EXPECT_EQ(bench.read("mended.ply"), bench.read("whole.ply"));
    const Motion before(bench / "apart.npy", apart), after(bench / "whole.npy", whole), files(bench / "frames", whole);
    ASSERT_EQ(before.frame_count(), 5u);
    ASSERT_EQ(after.frame_count(), 5u);
    const Skin skin = read_skin(bench / "skin.npy", whole);
    const BoneFrames bones = read_bone_frames(bench / "hinge.gltf", skin.bone_count, {.frames_per_second = 4});
    for (std::size_t f = 0; f < 5; ++f) {
      expect_same_corners(apart, before.frame(f), whole, after.frame(f));
      EXPECT_EQ(files.frame(f), after.frame(f));
      std::vector<Vec3> posed(whole.vertex_count());
      move_by_skin(skin, whole.positions, bones.frame(f), posed);
      for (std::size_t v = 0; v < posed.size(); ++v) EXPECT_LT(length(posed[v] - after.frame(f)[v]), 1e-12);
    }
    // It moves: the far corner is above the plane at the end.
    EXPECT_NEAR(after.frame(4)[whole.facets[1][1]].z, 1, 1e-6);
    const CommandResult pairs = bench.require("pairs hinge.gltf --within 0.01 --self --weld --json");
    EXPECT_EQ(pairs.json()["duplicate_vertices"], is_odd ? 1 : 0);
    EXPECT_EQ(pairs.err.find("morula repair merges them") != std::string::npos, is_odd) << pairs.err;
  }
}

// The hinge of a target that lifts a free corner; its weight goes down from 1 to -1 while the joint turns.
TEST(UpdateCommand, follows_the_bones_and_morph_targets_of_a_gltf) {
  GltfMaker file = hinge(false);
  const int up = file.floats({0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.5f, 0, 0, 0}, "VEC3");
  const int times = file.floats({0, 1}, "SCALAR"), weights = file.floats({1, -1}, "SCALAR");
  file.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}};
  file.json["meshes"][0]["weights"] = {1};
  Json& animation = file.json["animations"][0];
  animation["samplers"].push_back({{"input", times}, {"output", weights}});
  animation["channels"].push_back({{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}});
  const Workbench bench;
  bench.write("hinge.gltf", file.text());
  for (const std::string weld : {"", " --weld"}) {
    bench.require("build hinge.gltf -o hinge.morula --method octree --depth 1" + weld);
    for (const std::string rule : {"exact", "skinned"}) {
      const auto json =
          bench
              .require("update hinge.gltf hinge.morula --skin hinge.gltf --transforms hinge.gltf -o s --json --rule " +
                       rule + weld)
              .json();
      EXPECT_EQ(json["frames"], 31);
      EXPECT_TRUE(json["certificate"]["covered"].get<bool>()) << rule << weld;
      EXPECT_EQ(json["skin"]["bones"], 2);
      EXPECT_EQ(json["skin"]["morph_targets"], 1);
    }
    bench.require("update hinge.gltf hinge.morula hinge.gltf -o m --rule skinned" + weld);
    EXPECT_EQ(bench.read("m/0020.sph"), bench.read("s/0020.sph"));
  }
}
#endif

}  // namespace
}  // namespace morula::test
