// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres written as glTF: by the rules of its JSON and binary chunk, and as the library reads such a scene.
#include <gtest/gtest.h>

#include <cstring>
#include <morula/geometry/inspect.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <nlohmann/json.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

std::vector<std::vector<Sphere>> moving_spheres() {
  std::vector<std::vector<Sphere>> frames;
  for (int f = 0; f < 4; ++f)
    frames.push_back({{{1.0 * f, 2, -3}, 0.5}, {{0, 0.25 * f, 7}, 1.0 + 0.5 * f}, {{-4, 0, 0}, 0.125}});
  return frames;
}

TEST(GltfSpheres, are_nodes_with_a_ball_moved_and_scaled_over_time) {
  const ScratchFolder folder;
  const auto frames = moving_spheres();
  write_gltf_spheres(folder.path() / "a.glb", frames, 10);
  const std::string file = bytes_of(folder.path() / "a.glb");
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, file.data() + at, 4);
    return value;
  };
  ASSERT_EQ(file.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2u);
  ASSERT_EQ(word(8), file.size());
  const std::size_t json_size = word(12), chunk = 20 + json_size;
  EXPECT_EQ(json_size % 4, 0u);
  EXPECT_EQ(file.substr(16, 4), "JSON");
  EXPECT_EQ(file.substr(chunk + 4, 4), std::string("BIN\0", 4));
  ASSERT_EQ(chunk + 8 + word(chunk), file.size());
  const nlohmann::json scene = nlohmann::json::parse(file.substr(20, json_size));
  EXPECT_EQ(scene["asset"]["version"], "2.0");
  EXPECT_EQ(scene["buffers"][0]["byteLength"], word(chunk));
  ASSERT_EQ(scene["nodes"].size(), 3u);
  EXPECT_EQ(scene["scenes"][0]["nodes"], nlohmann::json({0, 1, 2}));
  const auto floats = [&](std::size_t accessor) {
    const nlohmann::json& a = scene["accessors"][accessor];
    EXPECT_EQ(a["componentType"], 5126);
    const std::size_t begin = chunk + 8 + a["byteOffset"].get<std::size_t>();
    EXPECT_EQ(a["byteOffset"].get<std::size_t>() % 4, 0u);
    std::vector<float> values(a["count"].get<std::size_t>() * (a["type"] == "VEC3" ? 3 : 1));
    EXPECT_LE(begin + 4 * values.size(), file.size());
    std::memcpy(values.data(), file.data() + begin, 4 * values.size());
    return values;
  };
  const nlohmann::json& animation = scene["animations"][0];
  ASSERT_EQ(animation["channels"].size(), 6u);
  for (const nlohmann::json& channel : animation["channels"]) {
    const nlohmann::json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
    EXPECT_EQ(floats(sampler["input"]), (std::vector<float>{0.0f, 0.1f, 0.2f, 0.3f}));
    const std::vector<float> output = floats(sampler["output"]);
    const auto node = channel["target"]["node"].get<std::size_t>();
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const Sphere& s = frames[f][node];
      const bool is_scale = channel["target"]["path"] == "scale";
      const Vec3 expected = is_scale ? Vec3{s.radius, s.radius, s.radius} : s.center;
      EXPECT_EQ(Vec3(Vec3f(output[3 * f], output[3 * f + 1], output[3 * f + 2])), expected);
    }
  }
}

TEST(GltfSpheres, read_back_as_balls_that_move) {
  const ScratchFolder folder;
  const auto frames = moving_spheres();
  write_gltf_spheres(folder.path() / "a.glb", frames, 30);
  const Mesh mesh = read_mesh(folder.path() / "a.glb");
  ASSERT_EQ(mesh.vertex_count(), 3 * 162u);
  EXPECT_EQ(mesh.facet_count(), 3 * 320u);
  const MeshReport report = inspect(mesh);
  EXPECT_TRUE(report.has_volume());
  EXPECT_GT(report.volume, 0);  // outward
  const Motion motion(folder.path() / "a.glb", mesh);
  ASSERT_EQ(motion.frame_count(), frames.size());
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::vector<Vec3> positions = motion.frame(f);
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const Sphere& s = frames[f][v / 162];
      EXPECT_NEAR(distance(positions[v], s.center), s.radius, 1e-5) << f << ' ' << v;
    }
  }
  // One frame stands still.
  write_gltf_spheres(folder.path() / "b.glb", std::span(frames).first(1));
  const Mesh still = read_mesh(folder.path() / "b.glb");
  EXPECT_EQ(Motion(folder.path() / "b.glb", still).frame_count(), 1u);
}

TEST(GltfSpheres, refuse_what_is_no_motion) {
  const ScratchFolder folder;
  const auto refused = [&](const std::vector<std::vector<Sphere>>& frames, double rate) {
    EXPECT_THROW(write_gltf_spheres(folder.path() / "a.glb", frames, rate), std::invalid_argument);
  };
  refused({}, 30);
  refused({{}}, 30);
  refused({{{{0, 0, 0}, 1}}, {}}, 30);
  refused({{{{0, 0, 0}, 1e39}}}, 30);
  refused({{{{0, 0, 0}, 1}}}, 0);
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace morula::test
