// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files whose corners are vertices of their own, welded: a cube of 24 vertices with a skin, morph targets and motion,
// against positions that the test computes for each vertex by itself.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/geometry/inspect.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/skin_file.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/update/skin_morphs.hpp>

#include "files.hpp"
#include "gltf_files.hpp"

namespace morula {
namespace {

using test::expect_file_error;
using test::GltfMaker;
using test::Json;
using test::ScratchFolder;

constexpr int none = -1;

struct CubeOptions {
  bool has_skin = false, has_morph = false, moves_morph = false, has_two_nodes = false;
  int odd_weight = none, odd_morph = none;  // a vertex that differs from the others at its corner
};

/// Vertex v of the cube: its corner, as the file has it.
Vec3 corner_of(int v) {
  const int side = v / 4, axis = side / 2, at = v % 4;
  Vec3 p{};
  p[axis] = side % 2;
  p[(axis + 1) % 3] = at == 1 || at == 2 ? 1 : 0;
  p[(axis + 2) % 3] = at >= 2 ? 1 : 0;
  return p;
}
/// The weight of the second joint, which stands at z = 1 and turns about x by a right angle within a second.
double weight_of(int v, const CubeOptions& o) {
  return v == o.odd_weight ? 0.25 : corner_of(v).z > 0.5 ? 0.75 : 0;
}
Vec3 morph_of(int v, const CubeOptions& o) {
  return v == o.odd_morph ? Vec3{0, 0, 1} : corner_of(v).x > 0.5 ? Vec3{0.5, 0, 0} : Vec3{};
}

GltfMaker cube(const CubeOptions& o) {
  GltfMaker file;
  std::vector<float> positions, weights, morphs;
  std::vector<std::uint16_t> joints, indices;
  for (int v = 0; v < 24; ++v) {
    const Vec3 p = corner_of(v), m = morph_of(v, o);
    const auto second = static_cast<float>(weight_of(v, o));
    for (int k = 0; k < 3; ++k)
      positions.push_back(static_cast<float>(p[k])), morphs.push_back(static_cast<float>(m[k]));
    for (const float w : {1 - second, second, 0.0f, 0.0f}) weights.push_back(w);
    for (const std::uint16_t j : {0, 1, 0, 0}) joints.push_back(j);
  }
  for (int side = 0; side < 6; ++side)
    for (const int k : {0, 1, 2, 0, 2, 3})
      indices.push_back(static_cast<std::uint16_t>(4 * side + (side % 2 == 1 || k == 0 ? k : 4 - k)));
  Json attributes{{"POSITION", file.floats(positions, "VEC3")}};
  if (o.has_skin) {
    attributes["JOINTS_0"] = file.shorts(joints, "VEC4");
    attributes["WEIGHTS_0"] = file.floats(weights, "VEC4");
  }
  Json primitive{{"attributes", attributes}, {"indices", file.shorts(indices, "SCALAR")}};
  if (o.has_morph) primitive["targets"] = {{{"POSITION", file.floats(morphs, "VEC3")}}};
  file.push("meshes", {{"primitives", {primitive}}});
  Json node{{"mesh", 0}};
  if (o.has_skin) node["skin"] = 0;
  file.push("nodes", node);
  Json roots{0};
  const int times = file.floats({0, 1}, "SCALAR");
  Json samplers = Json::array(), channels = Json::array();
  if (o.has_skin) {
    file.push("nodes", {{"children", {2}}});
    file.push("nodes", {{"translation", {0, 0, 1}}});
    roots.push_back(1);
    const int inverse = file.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0,  1,  //
                                     1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 1},
                                    "MAT4");
    file.push("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", inverse}});
    const float half = 0.70710678f;
    samplers.push_back({{"input", times}, {"output", file.floats({0, 0, 0, 1, half, 0, 0, half}, "VEC4")}});
    channels.push_back({{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}});
  }
  if (o.moves_morph) {
    channels.push_back({{"sampler", samplers.size()}, {"target", {{"node", 0}, {"path", "weights"}}}});
    samplers.push_back({{"input", times}, {"output", file.floats({0, 1}, "SCALAR")}});
  }
  if (o.has_two_nodes) {
    file.push("nodes", {{"mesh", 0}, {"translation", {1, 0, 0}}});
    roots.push_back(static_cast<int>(file.json["nodes"].size()) - 1);
  }
  file.push("scenes", {{"nodes", roots}});
  if (!channels.empty()) file.push("animations", {{"samplers", samplers}, {"channels", channels}});
  return file;
}

/// The vertex at a time from 0 to 1.
Vec3 posed(int v, const CubeOptions& o, double time) {
  Vec3 p = corner_of(v);
  if (o.moves_morph) p = p + time * morph_of(v, o);
  if (!o.has_skin) return p;
  const double angle = std::acos(-1.0) / 2 * time, c = std::cos(angle), s = std::sin(angle), up = p.z - 1;
  const Vec3 turned{p.x, c * p.y - s * up, 1 + s * p.y + c * up};
  const double w = weight_of(v, o);
  return p * (1 - w) + turned * w;
}

struct Welded {
  MeshInfo info;
  MeshWeld weld;
  Mesh mesh;
  explicit Welded(const std::filesystem::path& path) { mesh = read_mesh(path, info, weld); }
};

TEST(Weld, closes_a_cube_whose_faces_have_corners_of_their_own) {
  const ScratchFolder folder;
  const auto path = folder.file("cube.gltf", cube({}).text());
  const Mesh apart = read_mesh(path);
  EXPECT_EQ(apart.vertex_count(), 24u);
  EXPECT_FALSE(inspect(apart).closed);
  const Welded cube(path);
  EXPECT_EQ(cube.mesh.vertex_count(), 8u);
  EXPECT_EQ(cube.weld.merged_count(), 16u);
  EXPECT_EQ(cube.weld.kept_apart, 0u);
  const MeshReport report = inspect(cube.mesh);
  EXPECT_TRUE(report.closed && report.oriented && report.manifold);
  EXPECT_EQ(report.component_count, 1u);
  EXPECT_DOUBLE_EQ(report.volume, 1);
  for (std::uint32_t v = 0; v < 24; ++v) {
    EXPECT_EQ(cube.mesh.positions[cube.weld.new_vertex[v]], apart.positions[v]);
    EXPECT_LE(cube.weld.old_vertex[cube.weld.new_vertex[v]], v);
  }
  for (std::size_t f = 0; f < 12; ++f)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(cube.mesh.facets[f][k], cube.weld.new_vertex[apart.facets[f][k]]);
  // A node that flattens the cube for the moment merges no corners that it may unfold again.
  GltfMaker flattened = ::morula::cube({});
  flattened.json["nodes"][0]["scale"] = {1, 1, 0};
  const Welded flat(folder.file("flat.gltf", flattened.text()));
  EXPECT_EQ(flat.mesh.vertex_count(), 8u);
  EXPECT_EQ(flat.weld.kept_apart, 4u);
  // A surface that is cut at its edges is near itself there.
  SurfaceTree cut(apart), whole(cube.mesh);
  EXPECT_EQ(cut.duplicate_vertices(), 16u);
  EXPECT_EQ(whole.duplicate_vertices(), 0u);
  ProximityQuery query({.distance = 0.1});
  ASSERT_TRUE(query.run(cut).finished);
  EXPECT_FALSE(query.pairs().empty());
  ASSERT_TRUE(query.run(whole).finished);
  EXPECT_TRUE(query.pairs().empty());
}

TEST(Weld, moves_every_vertex_as_before) {
  const ScratchFolder folder;
  int number = 0;
  for (const CubeOptions& o :
       {CubeOptions{.has_skin = true}, CubeOptions{.has_morph = true, .moves_morph = true},
        CubeOptions{.has_skin = true, .has_morph = true, .moves_morph = true},
        CubeOptions{.has_skin = true, .has_morph = true, .odd_weight = 9, .odd_morph = 14},
        CubeOptions{.has_skin = true, .has_morph = true, .moves_morph = true, .odd_weight = 9, .odd_morph = 14}}) {
    const auto path = folder.file("cube" + std::to_string(++number) + ".gltf", cube(o).text());
    const Mesh apart = read_mesh(path);
    const Welded cube(path);
    const std::size_t odd = (o.odd_weight == none ? 0u : 1u) + (o.odd_morph == none ? 0u : 1u);
    EXPECT_EQ(cube.mesh.vertex_count(), 8 + odd);
    EXPECT_EQ(cube.weld.kept_apart, odd);
    const Motion before(path, apart, {.frames_per_second = 4});
    const Motion after(path, cube.mesh, {.frames_per_second = 4, .weld = &cube.weld});
    ASSERT_EQ(before.frame_count(), 5u);
    ASSERT_EQ(after.frame_count(), 5u);
    for (std::size_t f = 0; f < 5; ++f) {
      const std::vector<Vec3> one = before.frame(f), other = after.frame(f);
      for (int v = 0; v < 24; ++v) {
        const Vec3 here = other[cube.weld.new_vertex[static_cast<std::size_t>(v)]];
        EXPECT_EQ(here, one[static_cast<std::size_t>(v)]);
        EXPECT_LT(length(here - posed(v, o, 0.25 * static_cast<double>(f))), 1e-6) << number << ' ' << f << ' ' << v;
      }
    }
  }
}

TEST(Weld, keeps_the_skin) {
  const ScratchFolder folder;
  const CubeOptions o{.has_skin = true, .odd_weight = 9};
  const auto path = folder.file("cube.gltf", cube(o).text());
  const Mesh apart = read_mesh(path);
  const Welded cube(path);
  const Skin before = read_skin(path, apart), after = read_skin(path, cube.mesh, cube.weld);
  ASSERT_EQ(after.vertex_count(), 9u);
  ASSERT_EQ(after.bone_count, before.bone_count);
  const BoneFrames bones = read_bone_frames(path, after.bone_count, {.frames_per_second = 4});
  for (std::size_t f = 0; f < bones.frame_count(); ++f) {
    std::vector<Vec3> one(24), other(9);
    move_by_skin(before, apart.positions, bones.frame(f), one);
    move_by_skin(after, cube.mesh.positions, bones.frame(f), other);
    for (int v = 0; v < 24; ++v) {
      const Vec3 here = other[cube.weld.new_vertex[static_cast<std::size_t>(v)]];
      EXPECT_EQ(here, one[static_cast<std::size_t>(v)]);
      EXPECT_LT(length(here - posed(v, o, 0.25 * static_cast<double>(f))), 1e-6);
    }
  }
  write_skin(folder.path() / "same.npy", before);
  EXPECT_EQ(read_skin(folder.path() / "same.npy", cube.mesh, cube.weld).vertex_count(), 9u);
  // By their positions alone, vertices of different weights are merged.
  const MeshWeld by_place = weld_vertices(apart);
  const Mesh all = welded(apart, by_place);
  EXPECT_EQ(all.vertex_count(), 8u);
  expect_file_error(path, 0, "different weights", [&] { static_cast<void>(read_skin(path, all, by_place)); });
}

TEST(Weld, keeps_the_morph_targets) {
  const ScratchFolder folder;
  const CubeOptions o{.has_skin = true, .has_morph = true, .moves_morph = true, .odd_morph = 9};
  const auto path = folder.file("cube.gltf", cube(o).text());
  const Welded cube(path);
  const Skin skin = read_skin(path, cube.mesh, cube.weld);
  const Modes targets = read_modes(path, cube.mesh, cube.weld);
  ASSERT_EQ(targets.vertex_count, 9u);
  ASSERT_EQ(targets.mode_count, 1u);
  const BoneFrames bones = read_bone_frames(path, skin.bone_count, 1, {.frames_per_second = 4});
  for (std::size_t f = 0; f < bones.frame_count(); ++f) {
    std::vector<Vec3> moved(9);
    move_by_skin(skin, targets, cube.mesh.positions, bones.frame(f), bones.morphs.frame(f), moved);
    for (int v = 0; v < 24; ++v) {
      const Vec3 here = moved[cube.weld.new_vertex[static_cast<std::size_t>(v)]];
      EXPECT_LT(length(here - posed(v, o, 0.25 * static_cast<double>(f))), 1e-6);
    }
  }
  const Mesh apart = read_mesh(path);
  const MeshWeld by_place = weld_vertices(apart);
  const Mesh all = welded(apart, by_place);
  expect_file_error(path, 0, "moves them apart", [&] { static_cast<void>(read_modes(path, all, by_place)); });
  EXPECT_THROW(static_cast<void>(read_modes(path, apart, by_place)), std::invalid_argument);
}

TEST(Weld, keeps_meshes_of_two_nodes_apart) {
  const ScratchFolder folder;
  const Welded cubes(folder.file("cubes.gltf", cube({.has_two_nodes = true}).text()));
  EXPECT_EQ(cubes.mesh.vertex_count(), 16u);
  EXPECT_EQ(cubes.weld.kept_apart, 4u);
  EXPECT_TRUE(inspect(cubes.mesh).closed);
}

TEST(Weld, takes_frames_of_the_unwelded_mesh_unless_merged_vertices_are_apart) {
  const ScratchFolder folder;
  const auto path = folder.file("cube.gltf", cube({}).text());
  const Mesh apart = read_mesh(path);
  const Welded cube(path);
  std::vector<Vec3> moved = apart.positions;
  for (Vec3& p : moved) p = p * 2.0;
  for (const bool tears : {false, true}) {
    const auto frames = folder.path() / (tears ? "torn.npy" : "frames.npy");
    MotionWriter writer(frames, apart, 2);
    writer.write(apart.positions);
    if (tears) moved[23].x += 1e-9;
    writer.write(moved);
    writer.finish();
    const Motion motion(frames, cube.mesh, {.weld = &cube.weld});
    EXPECT_EQ(motion.frame(0), cube.mesh.positions);
    if (tears)
      expect_file_error(frames, 0, "different positions", [&] { static_cast<void>(motion.frame(1)); });
    else
      EXPECT_EQ(motion.frame(1), welded_positions(moved, cube.weld));
  }
  EXPECT_THROW(Motion(path, apart, {.weld = &cube.weld}), std::invalid_argument);
}

// A concave polygon of other vertices in every frame is cut as in the mesh at rest, though its corners are welded.
TEST(Weld, frames_of_polygons_are_cut_as_the_welded_mesh_is) {
  const ScratchFolder folder;
  const auto text = [](double reflex) {
    return "v 0 0 0\nv 4 0 0\nv " + std::to_string(reflex) + " " + std::to_string(reflex) +
           " 0\nv 0 4 0\nv 0 0 0\nv 4 0 0\nv 0 0 3\nf 2 3 4 1\nf 6 5 7\n";
  };
  // At rest the reflex corner decides the cut; in the second frame the polygon is convex.
  std::filesystem::create_directory(folder.path() / "frames");
  const auto rest = folder.file("rest.obj", text(1));
  folder.file("frames/0.obj", text(1)), folder.file("frames/1.obj", text(3));
  const Welded cut(rest);
  EXPECT_EQ(cut.weld.merged_count(), 2u);
  EXPECT_EQ(cut.info.concave_polygons, 1u);
  const Motion motion(folder.path() / "frames", cut.mesh, {.weld = &cut.weld});
  ASSERT_EQ(motion.frame_count(), 2u);
  EXPECT_EQ(motion.frame(0), cut.mesh.positions);
  EXPECT_EQ(motion.frame(1)[2], (Vec3{3, 3, 0}));
  // Corners in another order are another polygon.
  std::string other = text(3);
  other.replace(other.find("f 2 3 4 1"), 9, "f 2 4 3 1");
  folder.file("frames/1.obj", other);
  const Motion wrong(folder.path() / "frames", cut.mesh, {.weld = &cut.weld});
  EXPECT_THROW(static_cast<void>(wrong.frame(1)), FileError);
}

TEST(Weld, labels_of_skins_reject_weights_that_are_not_numbers) {
  Skin skin{.bone_count = 2, .begin = {0, 1, 2, 3}, .bones = {0, 1, 0}, .weights = {1, 1, 1}};
  EXPECT_EQ(skin_labels(skin)[0], skin_labels(skin)[2]);
  skin.weights[1] = std::numeric_limits<double>::quiet_NaN();
  try {
    static_cast<void>(skin_labels(skin));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("weight of vertex 1 for bone 1"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace morula
