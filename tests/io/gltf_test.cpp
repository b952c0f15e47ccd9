// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// glTF as a mesh, a motion and a skin, against positions worked out by hand; and files that must be refused.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <morula/io/motion_file.hpp>
#include <morula/io/skin_file.hpp>
#include <numbers>

#include "files.hpp"
#include "gltf_files.hpp"

namespace morula {
namespace {

using test::base64;
using test::bending_arm;
using test::can_make_links;
using test::expect_file_error;
using test::GltfMaker;
using test::Json;
using test::ScratchFolder;
using test::tetrahedron;

Mesh read(const GltfMaker& file, const std::string& name = "body.gltf") {
  const ScratchFolder folder;
  return read_mesh(folder.file(name, name.ends_with(".glb") ? file.glb() : file.text()));
}

const std::vector<Vec3> four_corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1.5}};
const std::vector<Facet> four_facets{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

TEST(Gltf, text_binary_and_a_file_beside_it_give_the_same_mesh) {
  const ScratchFolder folder;
  const GltfMaker file = tetrahedron();
  folder.file("a part.bin", file.buffer);
  std::filesystem::create_directory(folder.path() / "parts");
  folder.file("parts/b.bin", file.buffer);
  for (const auto& path : {folder.file("inside.gltf", file.text()), folder.file("one.glb", file.glb()),
                           folder.file("beside.gltf", file.with_uri("a%20part.bin")),
                           folder.file("below.GLTF", file.with_uri("parts/b.bin"))}) {
    const Mesh mesh = read_mesh(path);
    EXPECT_EQ(mesh.positions, four_corners) << path;
    EXPECT_EQ(mesh.facets, four_facets) << path;
  }
}

TEST(Gltf, indices_of_every_type_and_none_give_the_same_facets) {
  GltfMaker bytes = tetrahedron(), words = tetrahedron(), plain = tetrahedron();
  bytes.json["meshes"][0]["primitives"][0]["indices"] =
      bytes.add(std::vector<std::uint8_t>{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}, "SCALAR", 5121);
  words.json["meshes"][0]["primitives"][0]["indices"] =
      words.add(std::vector<std::uint32_t>{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}, "SCALAR", 5125);
  EXPECT_EQ(read(bytes).facets, four_facets);
  EXPECT_EQ(read(words).facets, four_facets);
  Json& primitive = plain.json["meshes"][0]["primitives"][0];
  primitive.erase("indices");
  primitive["attributes"]["POSITION"] = plain.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5, 6, 5, 5, 5, 6, 5}, "VEC3");
  EXPECT_EQ(read(plain).facets, (std::vector<Facet>{{0, 1, 2}, {3, 4, 5}}));
}

TEST(Gltf, strips_and_fans_keep_their_orientation_and_lines_are_passed_over) {
  GltfMaker file;
  const int p = file.floats({0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0}, "VEC3");
  const Json attributes{{"POSITION", p}};
  file.push("meshes", {{"primitives",
                        {{{"attributes", attributes}, {"mode", 5}},
                         {{"attributes", attributes}, {"mode", 1}},
                         {{"attributes", attributes}, {"mode", 6}}}}});
  file.push("nodes", {{"mesh", 0}});
  const Mesh mesh = read(file);
  EXPECT_EQ(mesh.vertex_count(), 5u) << "primitives of the same vertices share them";
  const std::vector<Facet> strip{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}, fan{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}};
  std::vector<Facet> both = strip;
  both.insert(both.end(), fan.begin(), fan.end());
  EXPECT_EQ(mesh.facets, both);
  // All of a strip face the same way.
  for (std::size_t f = 0; f < 3; ++f) {
    const auto [a, b, c] = mesh.corners(f);
    EXPECT_LT(cross(b - a, c - a).z, 0) << f;
  }
}

TEST(Gltf, strided_normalized_and_sparse_numbers_are_decoded) {
  GltfMaker strided = tetrahedron();
  std::string records;
  for (const Vec3& p : four_corners) {
    for (const double x : {p.x, p.y, p.z, 99.0, 98.0}) {
      const auto narrow = static_cast<float>(x);
      records.append(reinterpret_cast<const char*>(&narrow), 4);
    }
  }
  Json& position = strided.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
  position = strided.accessor(
      {{"bufferView", strided.view(records, 20)}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
  EXPECT_EQ(read(strided).positions, four_corners);

  GltfMaker small = tetrahedron();
  small.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
      small.add(std::vector<std::int16_t>{-32768, 0, 32767, 0, -16384, 0, 1, 2, 3, 0, 0, 0}, "VEC3", 5122, true);
  EXPECT_EQ(read(small).positions[0], (Vec3{-1, 0, 1}));
  EXPECT_EQ(read(small).positions[1].y, -16384 / 32767.0);
  small.json["accessors"].back().erase("normalized");
  EXPECT_EQ(read(small).positions[2], (Vec3{1, 2, 3})) << "plain integers, as KHR_mesh_quantization has them";

  GltfMaker sparse = tetrahedron();
  const std::vector<std::uint16_t> which{3, 1};
  const std::vector<float> instead{7, 8, 9, -1, -2, -3};
  const int at = sparse.view({reinterpret_cast<const char*>(which.data()), 4}),
            to = sparse.view({reinterpret_cast<const char*>(instead.data()), 24});
  sparse.json["accessors"][0]["sparse"] = {
      {"count", 2}, {"indices", {{"bufferView", at}, {"componentType", 5123}}}, {"values", {{"bufferView", to}}}};
  std::vector<Vec3> expected = four_corners;
  expected[3] = {7, 8, 9};
  expected[1] = {-1, -2, -3};
  EXPECT_EQ(read(sparse).positions, expected);
}

TEST(Gltf, nodes_place_their_meshes_in_the_order_of_the_scene) {
  GltfMaker file = tetrahedron();
  file.json["nodes"] = Json::array({{{"children", {2, 1}}, {"translation", {10, 0, 0}}},
                                    {{"mesh", 0}, {"scale", {2, 3, 4}}, {"rotation", {0, 0, 1, 0}}},  // half a turn
                                    {{"mesh", 0}, {"matrix", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 5, 6, 7, 1}}},
                                    {{"mesh", 0}}});  // in no scene
  const Mesh mesh = read(file);
  ASSERT_EQ(mesh.vertex_count(), 8u);
  for (std::size_t v = 0; v < 4; ++v) {
    const Vec3& p = four_corners[v];
    EXPECT_EQ(mesh.positions[v], (Vec3{15 + p.z, 6 + p.y, 7 + p.x})) << v;  // the child named first
    EXPECT_LE(distance(mesh.positions[4 + v], {10 - 2 * p.x, -3 * p.y, 4 * p.z}), 1e-15) << v;
  }
  // The first one mirrors.
  EXPECT_EQ(mesh.facets[0], (Facet{0, 1, 2}));
  EXPECT_EQ(mesh.facets[4], (Facet{4, 6, 5}));
}

TEST(Gltf, an_animation_is_played_at_the_rate_asked_for) {
  const ScratchFolder folder;
  GltfMaker file = tetrahedron();
  const int times = file.floats({0, 1, 1.5f}, "SCALAR"), path = file.floats({0, 0, 0, 4, 0, 0, 4, 8, 0}, "VEC3");
  file.push("animations", {{"samplers", {{{"input", times}, {"output", path}}}},
                           {"channels",
                            {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}},
                             {{"sampler", 0}, {"target", {{"path", "translation"}}}}}}});
  const auto at = [&](const char* kind, double rate, std::size_t frame) {
    file.json["animations"][0]["samplers"][0]["interpolation"] = kind;
    const auto gltf = folder.file("body.gltf", file.text());
    return Motion(gltf, read_mesh(gltf), {.frames_per_second = rate}).frame(frame)[0];
  };
  EXPECT_EQ(at("LINEAR", 4, 0), (Vec3{0, 0, 0}));
  EXPECT_EQ(at("LINEAR", 4, 1), (Vec3{1, 0, 0}));
  EXPECT_EQ(at("LINEAR", 4, 5), (Vec3{4, 4, 0}));
  EXPECT_EQ(at("LINEAR", 4, 6), (Vec3{4, 8, 0}));
  EXPECT_EQ(at("STEP", 4, 3), (Vec3{0, 0, 0}));
  EXPECT_EQ(at("STEP", 4, 5), (Vec3{4, 0, 0}));
  const auto gltf = folder.file("body.gltf", file.text());
  const Mesh mesh = read_mesh(gltf);
  EXPECT_EQ(Motion(gltf, mesh).frame_count(), 46u);
  EXPECT_EQ(Motion(gltf, mesh, {.frames_per_second = 4}).frame_count(), 7u);
  EXPECT_EQ(Motion(gltf, mesh, {.frames_per_second = 0.1}).frame_count(), 1u);
  EXPECT_EQ(Motion(gltf, mesh).frame_name(3), "body.gltf frame 3");
  EXPECT_THROW(Motion(gltf, mesh, {.frames_per_second = 0}), std::invalid_argument);
  EXPECT_THROW(Motion(gltf, mesh, {.frames_per_second = std::nan("")}), std::invalid_argument);
  expect_file_error(gltf, 0, "there is no animation 1", [&] { Motion(gltf, mesh, {.animation = 1}); });
  expect_file_error(gltf, 0, "too many frames", [&] { Motion(gltf, mesh, {.frames_per_second = 1e9}); });
  const auto still = folder.file("still.gltf", tetrahedron().text());
  EXPECT_EQ(Motion(still, mesh).frame_count(), 1u);
  EXPECT_EQ(Motion(still, mesh).frame(0), four_corners);
}

// Hermite's cubic through (0, 0) and (2, 1) with slopes 3 and -1 a second: worked by hand at one second.
TEST(Gltf, cubic_splines_use_their_tangents) {
  const ScratchFolder folder;
  GltfMaker file = tetrahedron();
  const int times = file.floats({0, 2}, "SCALAR"),
            keys = file.floats({9, 9, 9, 0, 0, 0, 3, 0, 0, -1, 0, 0, 1, 0, 0, 9, 9, 9}, "VEC3");
  file.push("animations", {{"samplers", {{{"input", times}, {"output", keys}, {"interpolation", "CUBICSPLINE"}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
  const auto gltf = folder.file("body.gltf", file.text());
  const Motion motion(gltf, read_mesh(gltf), {.frames_per_second = 1});
  ASSERT_EQ(motion.frame_count(), 3u);
  EXPECT_NEAR(motion.frame(1)[0].x, 0.5 + 2 * (0.125 * 3 + 0.125 * 1), 1e-15);
  EXPECT_EQ(motion.frame(2)[0].x, 1);
}

TEST(Gltf, skins_and_nodes_move_their_vertices) {
  const ScratchFolder folder;
  const auto gltf = folder.file("arm.glb", bending_arm().glb());
  const Mesh mesh = read_mesh(gltf);
  ASSERT_EQ(mesh.vertex_count(), 14u);
  EXPECT_EQ(mesh.positions[6], (Vec3{3, 0, 0})) << "as it is bound: neither node nor joint moves it";
  EXPECT_EQ(mesh.positions[11], (Vec3{2, 0, 5})) << "no skin: at its node";
  const Motion motion(gltf, mesh, {.frames_per_second = 2});
  ASSERT_EQ(motion.frame_count(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = static_cast<double>(i) * std::numbers::pi / 4, rise = static_cast<double>(i);
    const std::vector<Vec3> frame = motion.frame(i);
    for (std::size_t v = 0; v < 10; ++v) {
      const Vec3 p = mesh.positions[v];
      const double c = std::cos(angle), s = std::sin(angle);
      const Vec3 turned{2 + c * (p.x - 2) - s * p.y, s * (p.x - 2) + c * p.y, 0};
      const double share = p.x < 2 ? 0 : p.x == 2 ? 0.5 : 1;
      EXPECT_LE(distance(frame[v], (1 - share) * p + share * turned), 1e-7) << i << ' ' << v;
    }
    for (std::size_t v = 10; v < 14; ++v)
      EXPECT_LE(distance(frame[v], mesh.positions[v] + Vec3{0, rise, 0}), 1e-15) << i << ' ' << v;
  }
}

TEST(Gltf, the_skin_and_its_bones_make_the_same_frames) {
  const ScratchFolder folder;
  const auto gltf = folder.file("arm.glb", bending_arm().glb());
  const Mesh mesh = read_mesh(gltf);
  const Skin skin = read_skin(gltf, mesh);
  ASSERT_EQ(skin.bone_count, 3u);  // two joints, and the node without a skin
  ASSERT_EQ(skin.vertex_count(), mesh.vertex_count());
  const MotionOptions options{.frames_per_second = 7};
  const BoneFrames bones = read_bone_frames(gltf, skin.bone_count, options);
  const Motion motion(gltf, mesh, options);
  ASSERT_EQ(bones.frame_count(), motion.frame_count());
  ASSERT_EQ(bones.frame_count(), 8u);
  std::vector<Vec3> positions(mesh.vertex_count());
  for (std::size_t i = 0; i < bones.frame_count(); ++i) {
    move_by_skin(skin, mesh.positions, bones.frame(i), positions);
    const std::vector<Vec3> frame = motion.frame(i);
    for (std::size_t v = 0; v < frame.size(); ++v) EXPECT_LE(distance(positions[v], frame[v]), 1e-14) << i << ' ' << v;
  }
  move_by_skin(skin, mesh.positions, bones.frame(0), positions);
  EXPECT_EQ(positions, mesh.positions) << "at rest, bit for bit";
}

TEST(Gltf, morph_targets_displace_vertices_by_their_weights) {
  const ScratchFolder folder;
  GltfMaker file = tetrahedron();
  const int up = file.floats({0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3"),
            out = file.floats({0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3");
  Json& mesh = file.json["meshes"][0];
  mesh["primitives"][0]["targets"] = {{{"POSITION", up}}, {{"POSITION", out}}};
  mesh["weights"] = {0.25, 0};
  const int times = file.floats({0, 1}, "SCALAR"), weights = file.floats({0, 1, 1, 3}, "SCALAR");
  const auto still = folder.file("still.gltf", file.text());
  EXPECT_EQ(read_mesh(still).positions[0], (Vec3{0, 0, 0.25}));
  EXPECT_EQ(read_skin(still, read_mesh(still)).bone_count, 1u);
  file.push("animations", {{"samplers", {{{"input", times}, {"output", weights}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}});
  const auto gltf = folder.file("body.gltf", file.text());
  const Motion motion(gltf, read_mesh(gltf), {.frames_per_second = 2});
  ASSERT_EQ(motion.frame_count(), 3u);
  EXPECT_EQ(motion.frame(0)[1], (Vec3{3, 0, 0}));
  EXPECT_EQ(motion.frame(1)[0], (Vec3{0, 0, 0.5}));
  EXPECT_EQ(motion.frame(1)[1], (Vec3{5, 0, 0}));
  EXPECT_EQ(motion.frame(2)[1], (Vec3{7, 0, 0}));
  expect_file_error(gltf, 0, "morph targets", [&] { read_bone_frames(gltf, 1); });
}

TEST(Gltf, frames_of_another_mesh_are_refused) {
  const ScratchFolder folder;
  const auto gltf = folder.file("body.gltf", tetrahedron().text());
  Mesh mesh = read_mesh(gltf);
  mesh.facets.pop_back();
  expect_file_error(gltf, 0, "has 4 facets", [&] { Motion(gltf, mesh); });
  mesh = read_mesh(gltf);
  mesh.positions.push_back({});
  expect_file_error(gltf, 0, "has 4 vertices", [&] { Motion(gltf, mesh); });
  expect_file_error(gltf, 0, "has 4 vertices", [&] { read_skin(gltf, mesh); });
  expect_file_error(gltf, 0, "has 1 bones", [&] { read_bone_frames(gltf, 2); });
}

TEST(Gltf, hostile_files_are_refused_by_name) {
  const ScratchFolder folder;
  folder.file("part.bin", tetrahedron().buffer);
  folder.file("short.bin", tetrahedron().buffer.substr(1));
  const auto outside = folder.path().parent_path() / "outside.bin";
  using Spoil = std::function<void(GltfMaker&)>;
  const auto accessor = [](std::size_t i, const char* key, Json value) -> Spoil {
    return [=](GltfMaker& file) { file.json["accessors"][i][key] = value; };
  };
  const auto view = [](std::size_t i, const char* key, Json value) -> Spoil {
    return [=](GltfMaker& file) { file.json["bufferViews"][i][key] = value; };
  };
  const auto node = [](std::size_t i, const char* key, Json value) -> Spoil {
    return [=](GltfMaker& file) { file.json["nodes"][i][key] = value; };
  };
  const auto primitive = [](const char* key, Json value) -> Spoil {
    return [=](GltfMaker& file) { file.json["meshes"][0]["primitives"][0][key] = value; };
  };
  const std::vector<std::pair<std::string, Spoil>> spoilt{
      {"outside its buffer", accessor(0, "count", 5)},
      {"brings more numbers", accessor(0, "count", std::uint64_t{1} << 62)},
      {"outside its buffer", accessor(0, "byteOffset", 4)},
      {"outside its buffer", accessor(0, "byteOffset", std::uint64_t{0xfffffffffffffff0})},
      {"buffer view 9", accessor(0, "bufferView", 9)},
      {"another type", accessor(0, "type", "VEC4")},
      {"another type", accessor(1, "type", "VEC3")},
      {"no unsigned integers", accessor(1, "componentType", 5126)},
      {"is no glTF", accessor(1, "componentType", 7)},
      {"does not know", accessor(0, "componentType", 5124)},
      {"is no glTF", accessor(0, "type", "VEC9")},
      {"outside its buffer", view(0, "byteLength", 47)},
      {"outside its buffer", view(0, "byteOffset", 1000)},
      {"outside its buffer", view(0, "byteOffset", std::uint64_t{0xfffffffffffffff0})},
      {"stride is too short", view(0, "byteStride", 4)},
      {"is no glTF", view(0, "byteStride", 300)},
      {"buffer 1", view(0, "buffer", 1)},
      {"accessor 7 of 2", primitive("attributes", {{"POSITION", 7}})},
      {"no positions", primitive("attributes", {{"NORMAL", 0}})},
      {"is no glTF", primitive("indices", 7)},
      {"mode that glTF", primitive("mode", 17)},
      {"no unsigned integers", primitive("indices", 0)},
      {"refers to vertex 9 of 4",
       [](GltfMaker& file) { file.buffer[file.json["bufferViews"][1]["byteOffset"].get<std::size_t>()] = 9; }},
      {"shows more vertices",
       [](GltfMaker& file) {
         for (int k = 1; k < 4000; ++k) file.json["nodes"].push_back({{"mesh", 0}});
         const std::vector<std::uint8_t> all(30000);
         file.json["meshes"][0]["primitives"][0]["indices"] = file.add(all, "SCALAR", 5121);
         file.json.erase("scenes");
         file.json.erase("scene");
       }},
      {"brings more numbers",
       [](GltfMaker& file) {
         file.accessor({{"componentType", 5126}, {"count", std::uint64_t{1} << 40}, {"type", "VEC3"}});
         file.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 2;
       }},
      {"has a skin, but",
       [](GltfMaker& file) {
         file.push("skins", {{"joints", {0}}});
         file.json["nodes"][0]["skin"] = 0;
       }},
      {"refers to node 8",
       [](GltfMaker& file) {
         file.push("skins", {{"joints", {8}}});
       }},
      {"refers to mesh 5", node(0, "mesh", 5)},
      {"refers to skin 5", node(0, "skin", 5)},
      {"circle", node(0, "children", {0})},
      {"refers to node 3", node(0, "children", {3})},
      {"circle",
       [](GltfMaker& file) {
         file.push("nodes", {{"children", {2}}});
         file.push("nodes", {{"children", {1}}});
       }},
      {"two parents",
       [](GltfMaker& file) {
         file.push("nodes", {{"children", {0}}});
         file.push("nodes", {{"children", {0}}});
       }},
      {"is no root",
       [](GltfMaker& file) {
         file.push("nodes", {{"children", {0}}});
       }},
      {"twice",
       [](GltfMaker& file) {
         file.json["scenes"][0]["nodes"] = {0, 0};
       }},
      {"refers to scene 4", [](GltfMaker& file) { file.json["scene"] = 4; }},
      {"has no mesh", [](GltfMaker& file) { file.json["scenes"][0]["nodes"] = Json::array(); }},
      {"last row", node(0, "matrix", {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1})},
      {"16 are needed", node(0, "matrix", {1, 0, 0})},
      {"3 are needed", node(0, "scale", {1, 0})},
      {"not finite", node(0, "scale", {1, 1, 1.5e308})},
      {"weights for 0 morph", [](GltfMaker& file) { file.json["meshes"][0]["weights"] = {1}; }},
      {"requires the extension 'KHR_draco",
       [](GltfMaker& file) { file.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }},
      {"not glTF version 2", [](GltfMaker& file) { file.json["asset"]["version"] = "1.0"; }},
      {"no \"asset\"", [](GltfMaker& file) { file.json.erase("asset"); }},
      {"not a list", [](GltfMaker& file) { file.json["meshes"] = 3; }},
      {"not an object", [](GltfMaker& file) { file.json["nodes"] = {3}; }},
      {"nested",
       [](GltfMaker& file) {
         Json deep = 1;
         for (int i = 0; i < 100; ++i) deep = Json::array({deep});
         file.json["nodes"][0]["extras"] = deep;
       }},
  };
  std::size_t i = 0;
  for (const auto& [fragment, spoil] : spoilt) {
    GltfMaker file = tetrahedron();
    spoil(file);
    SCOPED_TRACE(fragment);
    const std::string name = std::to_string(i++);
    const auto text = folder.file(name + ".gltf", file.text());
    expect_file_error(text, 0, fragment, [&] { read_mesh(text); });
    const auto binary = folder.file(name + ".glb", file.glb());
    expect_file_error(binary, 0, fragment, [&] { read_mesh(binary); });
  }
  const GltfMaker good = tetrahedron();
  const ScratchFolder elsewhere;
  const std::filesystem::path part = elsewhere.file("part.bin", good.buffer);
  if (can_make_links()) {
    std::filesystem::create_symlink(part, folder.path() / "linked.bin");
    std::filesystem::create_directory_symlink(elsewhere.path(), folder.path() / "folder");
    folder.file("a part.bin", good.buffer);
    std::filesystem::create_symlink("a part.bin", folder.path() / "inside.bin");
    EXPECT_EQ(read_mesh(folder.file("uri.gltf", good.with_uri("inside.bin"))).facet_count(), 4u);
    for (const char* uri : {"linked.bin", "linked%2Ebin", "folder/part.bin"}) {
      const auto path = folder.file("uri.gltf", good.with_uri(uri));
      SCOPED_TRACE(uri);
      expect_file_error(path, 0, "a link out of its folder", [&] { read_mesh(path); });
    }
  }
  // Names with blanks in the folder itself are read.
  folder.file("a part.bin", good.buffer);
  for (const char* uri : {"a%20part.bin", "a part.bin"})
    EXPECT_EQ(read_mesh(folder.file("uri.gltf", good.with_uri(uri))).facet_count(), 4u) << uri;
  for (const auto& [uri, fragment] : std::vector<std::pair<std::string, std::string>>{
           {(folder.path() / "part.bin").string(), "only files in its folder"},
           {"../" + folder.path().filename().string() + "/part.bin", "only files in its folder"},
           {"x/%2e%2E/part.bin", "only files in its folder"},
           {"..%5Cpart.bin", "only files in its folder"},
           {"file:part.bin", "only files in its folder"},
           {"file:///etc/passwd", "only files in its folder"},
           {"//etc/passwd", "only files in its folder"},
           {"C:/part.bin", "only files in its folder"},
           {"missing.bin", "its buffer 'missing.bin' cannot be read"},
           {"short.bin", "is no glTF"},
           {"", "is no glTF"},
           {"data:application/octet-stream;base64,AAAA", "is no glTF"}}) {
    const auto path = folder.file("uri.gltf", good.with_uri(uri));
    SCOPED_TRACE(uri);
    try {
      read_mesh(path);
      ADD_FAILURE() << "was read";
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(fragment), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find(path.string()), 0u) << error.what();
    }
  }
}

TEST(Gltf, hostile_animations_and_skins_are_refused_by_name) {
  const ScratchFolder folder;
  const Mesh mesh = read(bending_arm());
  using Spoil = std::function<void(GltfMaker&)>;
  const auto channel = [](const char* key, Json value) -> Spoil {
    return [=](GltfMaker& file) { file.json["animations"][0]["channels"][0][key] = value; };
  };
  const auto sampler = [](const char* key, Json value) -> Spoil {
    return [=](GltfMaker& file) { file.json["animations"][0]["samplers"][0][key] = value; };
  };
  const auto numbers = [](std::size_t accessor, std::size_t offset, float value) -> Spoil {
    return [=](GltfMaker& file) {
      const std::size_t view = file.json["accessors"][accessor]["bufferView"];
      const std::size_t begin = file.json["bufferViews"][view]["byteOffset"];
      std::memcpy(file.buffer.data() + begin + 4 * offset, &value, 4);
    };
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto& [fragment, spoil] : std::vector<std::pair<std::string, Spoil>>{
           {"refers to node 50", channel("target", {{"node", 50}, {"path", "rotation"}})},
           {"glTF does not know", channel("target", {{"node", 2}, {"path", "color"}})},
           {"without morph targets", channel("target", {{"node", 2}, {"path", "weights"}})},
           {"moves what another one moves",
            [](GltfMaker& file) {
              Json& channels = file.json["animations"][0]["channels"];
              channels.push_back(channels[0]);
            }},
           {"refers to sampler 9", channel("sampler", 9)},
           {"has a matrix",
            [](GltfMaker& file) {
              file.json["nodes"][2] = {{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1}}};
            }},
           {"interpolated by 'CURVE'", sampler("interpolation", "CURVE")},
           {"values for", sampler("interpolation", "CUBICSPLINE")},
           {"another type", sampler("input", 0)},
           {"refers to accessor 99", sampler("output", 99)},
           {"go down",
            [=](GltfMaker& file) {
              numbers(5, 0, 0.5f)(file);
              numbers(5, 1, 0.25f)(file);
            }},
           {"negative", numbers(5, 0, -1)},
           {"not finite", numbers(5, 1, nan)},
           {"not finite", numbers(6, 1, nan)},
           {"not finite", numbers(0, 2, nan)},
           {"not finite", numbers(4, 2, nan)},
           {"negative weight", numbers(1, 0, -1)},
           {"no weights of vertex 0", numbers(1, 0, 0)},
           {"last row", numbers(4, 3, 1)},
           {"refers to joint 1", [](GltfMaker& file) { file.json["skins"][0]["joints"] = {1}; }},
           {"fewer inverse bind matrices",
            [](GltfMaker& file) {
              file.json["skins"][0]["joints"] = {1, 2, 0};
            }},
           {"joints without weights",
            [](GltfMaker& file) { file.json["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0"); }},
       }) {
    GltfMaker file = bending_arm();
    spoil(file);
    SCOPED_TRACE(fragment);
    const auto path = folder.file("arm.gltf", file.text());
    expect_file_error(path, 0, fragment, [&] { Motion(path, mesh).frame(0); });
  }
}

// Every file that was cut short is refused or read as something sound; none reads beyond its end.
TEST(Gltf, binary_files_that_were_cut_short_are_refused) {
  const ScratchFolder folder;
  const std::string whole = tetrahedron().glb();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto path = folder.file("cut.glb", whole.substr(0, size));
    expect_file_error(path, 0, "", [&] { read_mesh(path); });
  }
  for (std::size_t at = 0; at < 20; ++at)
    for (const char value : {'\0', '\x7f', '\xff'}) {
      std::string bytes = whole;
      bytes[at] = value;
      const auto path = folder.file("changed.glb", bytes);
      try {
        EXPECT_EQ(read_mesh(path).positions, four_corners);
      } catch (const FileError&) {
      }
    }
}

// What a reader says of the tetrahedron when it was changed so.
std::vector<std::string> notes_of(const std::function<void(GltfMaker&)>& change) {
  const ScratchFolder folder;
  GltfMaker file = tetrahedron();
  change(file);
  MeshInfo info;
  EXPECT_EQ(read_mesh(folder.file("a.glb", file.glb()), info).facet_count(), 4u);
  return info.notes;
}

TEST(Gltf, says_what_extensions_show_or_move) {
  EXPECT_TRUE(notes_of([](GltfMaker&) {}).empty());
  const auto instances = notes_of([](GltfMaker& file) {
    file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = 0;
    file.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  });
  ASSERT_EQ(instances.size(), 1u);
  EXPECT_EQ(instances[0].find("1 node shows its mesh many times by EXT_mesh_gpu_instancing"), 0u) << instances[0];
  const auto channel = [](const std::string& pointer) {
    return Json{{"sampler", 0},
                {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}};
  };
  const auto pointers = notes_of([&](GltfMaker& file) {
    const int times = file.floats({0, 1}, "SCALAR"), values = file.floats({0, 0, 0, 1, 1, 1}, "VEC3");
    file.push(
        "animations",
        {{"samplers", {{{"input", times}, {"output", values}}}},
         {"channels",
          {channel("/nodes/0/translation"), channel("/meshes/0/weights"), channel("/materials/0/emissiveFactor")}}});
  });
  ASSERT_EQ(pointers.size(), 1u);
  EXPECT_EQ(pointers[0].find("2 channels of animations move what KHR_animation_pointer points at"), 0u) << pointers[0];
  const auto unknown = notes_of([](GltfMaker& file) {
    for (const char* list : {"nodes", "meshes"}) file.json[list][0]["extensions"]["XYZ_fur"] = Json::object();
    file.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    file.json["nodes"][0]["extensions"]["EXT_mesh_features"] = Json::object();
    file.json["extensions"]["CESIUM_RTC"]["center"] = {1, 2, 3};
  });
  ASSERT_EQ(unknown.size(), 2u);
  EXPECT_EQ(unknown[0].find("the extension 'CESIUM_RTC' is used in 1 place"), 0u) << unknown[0];
  EXPECT_EQ(unknown[1].find("the extension 'XYZ_fur' is used in 2 places"), 0u) << unknown[1];
}

TEST(Gltf, says_that_weights_are_divided_by_their_sum) {
  const auto notes = [](float first, float second) {
    return notes_of([&](GltfMaker& file) {
      const int joints = file.shorts(std::vector<std::uint16_t>(16), "VEC4");
      const int weights = file.floats({first, 0, 0, 0, second, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
      Json& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
      attributes["JOINTS_0"] = joints, attributes["WEIGHTS_0"] = weights;
    });
  };
  EXPECT_TRUE(notes(1, 1 + 0x1p-22f).empty());
  const auto both = notes(0.5f, 1.25f), one = notes(1, 0.99f);
  ASSERT_EQ(both.size(), 1u);
  EXPECT_EQ(both[0],
            "2 vertices have weights that do not add up to 1 within 1e-6, the sums from 0.500000 to 1.250000; "
            "they are divided by their sum");
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].find("1 vertex has weights that do not add up to 1 within 1e-6, the sums from 0.99"), 0u) << one[0];
}

TEST(Gltf, counts_nodes_that_are_in_no_scene) {
  const auto notes = notes_of([](GltfMaker& file) {
    for (int i = 0; i < 2; ++i) file.push("nodes", {{"mesh", 0}});
    file.push("scenes", {{"nodes", {2}}});
  });
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].find("2 nodes with meshes are not in the default scene"), 0u) << notes[0];
}

TEST(Gltf, packed_primitives_are_read_where_their_plain_data_are_there) {
  const auto pack = [](GltfMaker& file) {
    file.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = 0;
    file.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  };
  EXPECT_TRUE(notes_of(pack).empty());
  const ScratchFolder folder;
  for (const int accessor : {0, 1}) {
    GltfMaker file = tetrahedron();
    pack(file);
    // Full of zeros, as glTF has it, but for the extension.
    file.json["accessors"][static_cast<std::size_t>(accessor)].erase("bufferView");
    const auto path = folder.file("a.gltf", file.text());
    expect_file_error(path, 0, "KHR_draco_mesh_compression alone", [&] { read_mesh(path); });
  }
}

TEST(Gltf, version_1_is_named) {
  const ScratchFolder folder;
  const auto path = folder.file("a.gltf", R"({"asset":{"version":"1.0"},"scene":"s","scenes":{"s":{"nodes":["n"]}},)"
                                          R"("nodes":{"n":{"meshes":["m"]}},"meshes":{"m":{"primitives":[]}}})");
  expect_file_error(path, 0, "is not glTF version 2 but '1.0'", [&] { read_mesh(path); });
}

}  // namespace
}  // namespace morula
