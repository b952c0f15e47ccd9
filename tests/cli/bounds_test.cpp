// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <morula/io/mesh_file.hpp>
#include <morula/io/modal_file.hpp>
#include <morula/io/skin_file.hpp>
#include <morula/update/skin_bounds.hpp>

#include "../io/gltf_files.hpp"
#include "workbench.hpp"

namespace morula::test {
namespace {

/// A bar of two bones that bends, as mesh, skin and transforms.
void make_bar(const Workbench& bench, const std::string& size = "12") {
  for (const std::string name : {"bar", "bar-weights", "bar-bones"})
    bench.require("sample " + name + " -o " + (name == "bar" ? "bar.obj" : name + ".npy") + " --resolution " + size);
}
const std::string bar_files = "bar.obj --skin bar-weights.npy --transforms bar-bones.npy ";

/// Every facet is in one cluster; the sizes of the clusters.
std::vector<std::size_t> sizes_of_partition(const Json& bounds, std::size_t facet_count) {
  std::vector<int> seen(facet_count);
  std::vector<std::size_t> sizes;
  for (const Json& cluster : bounds["clusters"]) {
    sizes.push_back(0);
    for (const Json& range : cluster["facet_ranges"])
      for (std::size_t f = range[0]; f < range[1]; ++f, ++sizes.back()) ++seen.at(f);
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(facet_count));
  return sizes;
}

TEST(BoundsCommand, clusters_are_a_partition_of_the_facets_by_any_choice) {
  const Workbench bench;
  make_bar(bench);
  const std::size_t facets = read_mesh(bench / "bar.obj").facet_count();
  bench.require("bounds " + bar_files + "-o one.json --clusters 1");
  EXPECT_EQ(sizes_of_partition(Json::parse(bench.read("one.json")), facets), std::vector{facets});
  bench.require("bounds " + bar_files + "-o seven.json --clusters 7");
  const std::vector<std::size_t> sizes = sizes_of_partition(Json::parse(bench.read("seven.json")), facets);
  EXPECT_EQ(sizes.size(), 7u);
  for (const std::size_t size : sizes) EXPECT_NEAR(static_cast<double>(size), static_cast<double>(facets) / 7, 2);
  bench.require("bounds " + bar_files + "-o all.json --clusters 1000000");
  EXPECT_EQ(sizes_of_partition(Json::parse(bench.read("all.json")), facets), std::vector<std::size_t>(facets, 1));

  std::string text;
  for (std::size_t f = 0; f < facets; ++f) text += f % 3 == 0 ? "5\n" : f % 3 == 1 ? "2 " : "9 ";
  bench.write("clusters.txt", text);
  bench.require("bounds " + bar_files + "-o own.json --clusters-from clusters.txt");
  const Json own = Json::parse(bench.read("own.json"));
  EXPECT_EQ(sizes_of_partition(own, facets).size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) {
    const bool is_used = i == 2 || i == 5 || i == 9;
    EXPECT_EQ(own["clusters"][i]["facet_ranges"].empty(), !is_used);
    EXPECT_EQ(own["clusters"][i]["data"][11] == 0, !is_used);
    for (const Json& range : own["clusters"][i]["facet_ranges"])
      EXPECT_EQ(range[0].get<std::size_t>() % 3, i == 5 ? 0u : i == 2 ? 1u : 2u);
  }
}

/// The file has the rest data of the library, to the bit.
TEST(BoundsCommand, file_has_the_rest_data_of_the_library) {
  const Workbench bench;
  make_bar(bench);
  bench.require("bounds " + bar_files + "-o a.json --clusters 5");
  const Json file = Json::parse(bench.read("a.json"));
  EXPECT_EQ(file["format"], "morula skin bounds");
  EXPECT_EQ(file["version"], 1);
  const Mesh mesh = read_mesh(bench / "bar.obj");
  std::vector<std::uint32_t> clusters(mesh.facet_count());
  for (std::uint32_t i = 0; i < 5; ++i)
    for (const Json& range : file["clusters"][i]["facet_ranges"])
      for (std::size_t f = range[0]; f < range[1]; ++f) clusters[f] = i;
  const SkinBounds bounds(mesh, read_skin(bench / "bar-weights.npy", mesh), clusters);
  SkinBoundsData read{.bone_count = file["bone_count"], .reach = file["reach"], .largest_size = file["largest_size"]};
  for (const Json& cluster : file["clusters"]) {
    const Json& n = cluster["data"];
    ASSERT_EQ(n.size(), 12u);
    read.clusters.push_back({{n[0], n[1], n[2]}, n[3], {n[4], n[5], n[6]}, n[7], n[8], n[9], n[10], n[11]});
  }
  for (const Json& n : file["rows"]) {
    ASSERT_EQ(n.size(), 8u);
    read.rows.push_back({n[0], n[1], n[2], n[3], {n[4], n[5], n[6]}, n[7]});
  }
  EXPECT_EQ(read, bounds.data());
}

#ifdef MORULA_HAS_GLTF
/// A file in two parts: with a skin, and without.
std::string small_gltf() {
  GltfMaker arm = bending_arm();
  for (std::size_t i = 0; i < arm.json["nodes"].size(); ++i) arm.json["nodes"][i]["name"] = "n" + std::to_string(i);
  return arm.glb();
}

TEST(BoundsCommand, primitives_of_a_gltf_file_are_clusters_and_bones_are_named) {
  const Workbench bench;
  bench.write("arm.glb", small_gltf());
  const Json report = bench.require("bounds arm.glb -o a.json --primitives --json").json();
  EXPECT_EQ(report["clusters"], 2);
  EXPECT_GT(report["frames"], 1);
  EXPECT_EQ(report["uncovered_corners"], 0);
  const Json file = Json::parse(bench.read("a.json"));
  EXPECT_EQ(sizes_of_partition(file, 12), (std::vector<std::size_t>{8, 4}));
  EXPECT_EQ(file["primitives"][1]["facet_range"], Json({8, 12}));
  EXPECT_EQ(file["primitives"][1]["node"], 3);
  EXPECT_EQ(file["bones"], Json::parse(R"([{"node": 1, "name": "n1", "skin": 0, "joint": 0, "mesh_node": 0},
                                           {"node": 2, "name": "n2", "skin": 0, "joint": 1, "mesh_node": 0},
                                           {"node": 3, "name": "n3"}])"));
}

/// The skin of another file: its bones are named, and primitives are those of the mesh.
TEST(BoundsCommand, mesh_and_skin_may_be_two_files) {
  const Workbench bench;
  bench.write("arm.glb", small_gltf());
  const Mesh mesh = read_mesh(bench / "arm.glb");
  write_mesh(bench / "arm.obj", mesh);
  write_skin(bench / "arm.npy", read_skin(bench / "arm.glb", mesh));
  bench.require("bounds arm.glb --skin arm.npy -o a.json --primitives");
  const Json primitives = Json::parse(bench.read("a.json"));
  EXPECT_EQ(sizes_of_partition(primitives, 12), (std::vector<std::size_t>{8, 4}));
  EXPECT_FALSE(primitives.contains("bones"));
  bench.require("bounds arm.obj --skin arm.glb -o b.json");
  const Json bones = Json::parse(bench.read("b.json"));
  EXPECT_FALSE(bones.contains("primitives"));
  EXPECT_EQ(bones["bones"][1]["name"], "n2");
}

TEST(BoundsCommand, copy_of_a_gltf_file_has_the_bounds_and_nothing_else_new) {
  const Workbench bench;
  const std::string bytes = small_gltf();
  bench.write("arm.glb", bytes);
  bench.require("bounds arm.glb -o arm.json --clusters 3");
  bench.require("bounds arm.glb -o with.glb --clusters 3");
  const std::string copy = bench.read("with.glb");
  const auto json_size = [](const std::string& glb) {
    return static_cast<std::size_t>(static_cast<unsigned char>(glb[12])) +
           (static_cast<std::size_t>(static_cast<unsigned char>(glb[13])) << 8);
  };
  const std::string before = bytes.substr(20, json_size(bytes)), after = copy.substr(20, json_size(copy));
  EXPECT_EQ(copy.substr(20 + after.size()), bytes.substr(20 + before.size()));
  Json extended = Json::parse(after);
  EXPECT_EQ(extended["extras"]["morula_skin_bounds"], Json::parse(bench.read("arm.json")));
  extended.erase("extras");
  EXPECT_EQ(extended, Json::parse(before));
  // A copy of the copy has them once.
  bench.require("bounds with.glb -o again.glb --clusters 3");
  EXPECT_EQ(bench.read("again.glb"), copy);
  bench.expect_refused("bounds arm.glb -o arm.gltf", "give it that extension");
  bench.expect_refused("bounds arm.glb -o arm.glb", "arm.glb");
}
/// The arm with two targets, whose weights the animation moves from those at rest, and a last primitive without facets.
GltfMaker morphing_arm_with_empty_primitive() {
  GltfMaker arm = bending_arm();
  std::vector<float> up(30), out(30);
  for (std::size_t v = 0; v < 10; ++v) {
    up[3 * v + 2] = 0.25f * static_cast<float>(v % 3);
    out[3 * v + 1] = v % 2 == 0 ? -0.5f : 0.75f;
  }
  const int first = arm.floats(up, "VEC3"), second = arm.floats(out, "VEC3");
  arm.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", first}}, {{"POSITION", second}}};
  arm.json["meshes"][0]["weights"] = {0.5, 0};
  const int times = arm.floats({0, 1}, "SCALAR"), values = arm.floats({0.5f, 0, -3, 2}, "SCALAR");
  Json& animation = arm.json["animations"][0];
  animation["samplers"].push_back({{"input", times}, {"output", values}});
  animation["channels"].push_back({{"sampler", 2}, {"target", {{"node", 0}, {"path", "weights"}}}});
  Json& primitives = arm.json["meshes"][1]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[1]["mode"] = 5;  // a strip of two corners
  primitives[1]["indices"] = arm.shorts({0, 1}, "SCALAR");
  return arm;
}

TEST(BoundsCommand, morph_targets_of_a_gltf_file_are_in_its_bounds) {
  const Workbench bench;
  bench.write("arm.glb", morphing_arm_with_empty_primitive().glb());
  const Json report = bench.require("bounds arm.glb -o a.json --clusters 3 --json").json();
  EXPECT_EQ(report["morph_targets"], 2);
  EXPECT_EQ(report["uncovered_corners"], 0);
  const Json file = Json::parse(bench.read("a.json"));
  EXPECT_EQ(file["target_count"], 2);
  EXPECT_EQ(file["morph_targets"], Json::parse(R"([{"node": 0, "mesh": 0, "target": 0, "rest_weight": 0.5},
                                                   {"node": 0, "mesh": 0, "target": 1, "rest_weight": 0.0}])"));
  const Mesh mesh = read_mesh(bench / "arm.glb");
  std::vector<std::uint32_t> clusters(mesh.facet_count());
  for (std::uint32_t i = 0; i < 3; ++i)
    for (const Json& range : file["clusters"][i]["facet_ranges"])
      for (std::size_t f = range[0]; f < range[1]; ++f) clusters[f] = i;
  const SkinBounds bounds(mesh, read_skin(bench / "arm.glb", mesh), read_modes(bench / "arm.glb", mesh), clusters);
  EXPECT_EQ(file["target_begin"], Json(bounds.data().target_begin));
  std::vector<SkinBoundsTarget> targets;
  for (const Json& n : file["targets"]) targets.push_back({{n[0], n[1], n[2]}, n[3], {n[4], n[5], n[6]}, n[7]});
  EXPECT_EQ(targets, bounds.data().targets);
  ASSERT_FALSE(targets.empty());
  // The same from a mesh with the skin of the file, and from arrays.
  write_mesh(bench / "arm.obj", mesh);
  bench.require("bounds arm.obj --skin arm.glb -o b.json --clusters 3");
  EXPECT_EQ(Json::parse(bench.read("b.json"))["targets"], file["targets"]);
  const Skin skin = read_skin(bench / "arm.glb", mesh);
  const BoneFrames frames = read_bone_frames(bench / "arm.glb", skin.bone_count, 2);
  write_skin(bench / "skin.npy", skin);
  write_bone_frames(bench / "bones.npy", {frames.bone_count, frames.transforms, {}});
  write_modes(bench / "modes.npy", read_modes(bench / "arm.glb", mesh));
  write_coordinates(bench / "coords.npy", frames.morphs);
  const std::string arrays =
      "bounds arm.obj --skin skin.npy --transforms bones.npy --modes modes.npy --coords coords.npy ";
  const Json same = bench.require(arrays + "-o c.json --clusters 3 --json").json();
  EXPECT_EQ(same["radius_over_smallest"], report["radius_over_smallest"]);
  EXPECT_EQ(Json::parse(bench.read("c.json"))["targets"], file["targets"]);
  bench.expect_refused("bounds arm.glb -o d.json --modes modes.npy", "leave out --modes");
  bench.expect_refused("bounds arm.obj --skin skin.npy -o d.json --coords coords.npy", "add --modes FILE");
}

TEST(BoundsCommand, primitives_without_facets_are_empty_clusters) {
  const Workbench bench;
  bench.write("arm.glb", morphing_arm_with_empty_primitive().glb());
  const Json report = bench.require("bounds arm.glb -o a.json --primitives --json").json();
  EXPECT_EQ(report["clusters"], 3);
  const Json file = Json::parse(bench.read("a.json"));
  EXPECT_EQ(file["primitives"].size(), 3u);
  EXPECT_EQ(sizes_of_partition(file, 12), (std::vector<std::size_t>{8, 4, 0}));
  EXPECT_EQ(file["clusters"][2]["data"][11], 0);
  EXPECT_EQ(file["target_begin"].size(), 4u);
}
#endif

TEST(BoundsCommand, same_bytes_for_any_number_of_threads) {
  const Workbench bench;
  make_bar(bench);
  bench.require("bounds " + bar_files + "-o a.json --clusters 9 --threads 1");
  bench.require("bounds " + bar_files + "-o b.json --clusters 9 --threads 3");
  EXPECT_EQ(bench.read("a.json"), bench.read("b.json"));
}

TEST(BoundsCommand, report_says_how_tight_and_that_no_corner_is_uncovered) {
  const Workbench bench;
  make_bar(bench);
  const Json report = bench.require("bounds " + bar_files + "-o a.json --clusters 9 --json").json();
  EXPECT_EQ(report["clusters"], 9);
  EXPECT_EQ(report["bones"], 2);
  EXPECT_EQ(report["spheres"], 9 * report["frames"].get<int>());
  EXPECT_EQ(report["uncovered_corners"], 0);
  const Json& ratio = report["radius_over_smallest"];
  EXPECT_GE(ratio["median"], 1.0);
  EXPECT_LE(ratio["median"], ratio["95%"]);
  EXPECT_LE(ratio["95%"], ratio["largest"]);
  EXPECT_LT(ratio["largest"], 4.0);
  const std::string text = bench.require("bounds " + bar_files + "-o a.json --clusters 9").out;
  EXPECT_NE(text.find("uncovered     0 corners"), std::string::npos) << text;
  // Without transforms there is nothing to measure by.
  const Json rest = bench.require("bounds bar.obj --skin bar-weights.npy -o a.json --json").json();
  EXPECT_EQ(rest["frames"], 0);
  EXPECT_FALSE(rest.contains("uncovered_corners"));
}

TEST(BoundsCommand, refuses_what_has_no_skin_and_what_it_cannot_write) {
  const Workbench bench;
  make_bar(bench);
  bench.expect_refused("bounds", "MESH is missing");
  bench.expect_refused("bounds bar.obj --skin bar-weights.npy", "-o is missing");
  bench.expect_refused("bounds bar.obj -o a.json", "has no skin; add --skin FILE");
  bench.expect_refused("bounds bar.obj --skin bar-weights.npy -o a.txt", "bounds are written as .json");
  bench.expect_refused("bounds bar.obj --skin bar-weights.npy -o a.glb", "name a .json");
  bench.expect_refused("bounds bar.obj --skin bar-weights.npy -o a.json --primitives", "--primitives needs a .gltf");
  bench.expect_refused("bounds bar.obj --skin bar-weights.npy -o a.json --clusters 0", "--clusters");
  bench.expect_refused("bounds bar.obj --skin bar-weights.npy -o no/a.json", "no");
  bench.write("few.txt", "0 0 1");
  bench.expect_refused("bounds bar.obj --skin bar-weights.npy -o a.json --clusters-from few.txt", "has 3 numbers for");
  bench.expect_refused("bounds --evaluator cobol", "unknown evaluator 'cobol'");
  bench.expect_refused("bounds bar.obj --evaluator c", "leave out MESH and -o");
}

TEST(BoundsCommand, evaluators_are_printed_as_they_are_tested) {
  const Workbench bench;
  for (const std::string name : {"c", "glsl", "wgsl"}) {
    std::ifstream file(std::string(MORULA_PAGES) + "/apps/morula/evaluators/skin_bounds." + (name == "c" ? "h" : name));
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    EXPECT_EQ(bench.require("bounds --evaluator " + name).out, text);
    EXPECT_EQ(bench.require("bounds --json --evaluator " + name).json()["text"], text);
  }
}

}  // namespace
}  // namespace morula::test
