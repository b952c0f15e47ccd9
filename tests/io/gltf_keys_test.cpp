// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Keys of glTF animations with equal times, which some exporters write: the last of them holds from that time on.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/io/mesh_file.hpp>
#include <morula/io/motion_file.hpp>
#include <numbers>
#include <support/scratch_folder.hpp>

#include "gltf_files.hpp"

namespace morula::test {
namespace {

// Frames of a tetrahedron whose node one channel moves, two a second.
std::vector<std::vector<Vec3>> frames_of(const char* path, const char* interpolation, const std::vector<float>& times,
                                         const std::vector<float>& values) {
  const ScratchFolder folder;
  GltfMaker file = tetrahedron();
  const int input = file.floats(times, "SCALAR");
  const int output = file.floats(values, std::string(path) == "rotation" ? "VEC4" : "VEC3");
  file.push("animations", {{"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}});
  const auto gltf = folder.file("body.gltf", file.text());
  const Motion motion(gltf, read_mesh(gltf), {.frames_per_second = 2});
  std::vector<std::vector<Vec3>> frames;
  for (std::size_t i = 0; i < motion.frame_count(); ++i) frames.push_back(motion.frame(i));
  return frames;
}

// Where vertex 0, the origin at rest, goes along x. tangents: whether to surround each key with tangents; those on the
// side of a key of the same time are 99 and must not be read.
std::vector<double> path_of(const char* interpolation, const std::vector<float>& times, const std::vector<float>& x,
                            bool tangents = false) {
  std::vector<float> values;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const bool equal_before = k > 0 && times[k] == times[k - 1];
    const bool equal_after = k + 1 < times.size() && times[k] == times[k + 1];
    if (tangents) values.insert(values.end(), {equal_before ? 99.0f : 0.0f, 0, 0});
    values.insert(values.end(), {x[k], 0, 0});
    if (tangents) values.insert(values.end(), {equal_after ? 99.0f : 0.0f, 0, 0});
  }
  std::vector<double> result;
  for (const auto& frame : frames_of("translation", interpolation, times, values)) result.push_back(frame[0].x);
  return result;
}

// Pairs at the begin, within and at the end, and three in a row.
const std::vector<float> doubled{0, 0, 1, 1, 1, 2, 2}, x_of_keys{7, 0, 1, -8, 4, 6, 9};

TEST(GltfKeys, the_last_of_equal_times_holds_from_then_on) {
  EXPECT_EQ(path_of("LINEAR", doubled, x_of_keys), (std::vector<double>{0, 0.5, 4, 5, 9}));
  EXPECT_EQ(path_of("STEP", doubled, x_of_keys), (std::vector<double>{0, 0, 4, 4, 9}));
  // Without slope at both ends, the cubic is at the mean half-way.
  EXPECT_EQ(path_of("CUBICSPLINE", doubled, x_of_keys, true), (std::vector<double>{0, 0.5, 4, 5, 9}));
}

TEST(GltfKeys, rotations_with_equal_times_turn_between_the_nearest_keys) {
  const std::vector<float> degrees{30, 0, 60, 200, 90, 150, 180};
  std::vector<float> values;
  for (const float d : degrees) {
    const float half = d * std::numbers::pi_v<float> / 360;
    values.insert(values.end(), {0, 0, std::sin(half), std::cos(half)});
  }
  const auto frames = frames_of("rotation", "LINEAR", doubled, values);
  const std::vector<double> expected{0, 30, 90, 120, 180};
  ASSERT_EQ(frames.size(), expected.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double angle = expected[i] * std::numbers::pi / 180;
    EXPECT_NEAR(frames[i][1].x, std::cos(angle), 1e-6) << i;
    EXPECT_NEAR(frames[i][1].y, std::sin(angle), 1e-6) << i;
  }
}

TEST(GltfKeys, all_times_may_be_equal) {
  for (const char* interpolation : {"LINEAR", "STEP"}) {
    EXPECT_EQ(path_of(interpolation, {0, 0}, {3, 5}), (std::vector<double>{5}));
    EXPECT_EQ(path_of(interpolation, {1, 1}, {3, 5}), (std::vector<double>{3, 3, 5}))
        << "the first key before its time";
  }
  EXPECT_EQ(path_of("CUBICSPLINE", {1, 1}, {3, 5}, true), (std::vector<double>{3, 3, 5}));
}

TEST(GltfKeys, times_that_go_down_are_refused) {
  for (const std::vector<float>& times :
       {std::vector<float>{0, 1, 0.5f}, {1, 1, std::nextafter(1.0f, 0.0f)}, {0, -0.5f, 1}})
    try {
      path_of("LINEAR", times, {1, 2, 3});
      ADD_FAILURE() << times[2] << " was read";
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("negative or go down"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace morula::test
