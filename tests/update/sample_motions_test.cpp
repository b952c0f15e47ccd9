// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Modes and bones made by formula: what the header promises, on the bodies made by formula.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/sample_motions.hpp>
#include <stdexcept>
#include <support/numbers.hpp>

namespace morula {
namespace {

using test::pi;

// The bar is 4 × 1 × 1 about the origin.
TEST(SampleMotions, modes_of_the_bar_are_sines_with_tilted_cross_sections) {
  const Mesh bar = sample_body("bar", 16);
  const Modes modes = sample_modes(bar.positions, 4);
  ASSERT_EQ(modes.vertex_count, bar.vertex_count());
  ASSERT_EQ(modes.mode_count, 4u);
  for (std::size_t v = 0; v < bar.vertex_count(); ++v) {
    const Vec3 p = bar.positions[v];
    for (std::size_t j = 0; j < 4; ++j) {
      const double k = j < 2 ? 1 : 2, phase = k * pi * (p.x + 2) / 4, slope = 0.1 * k * pi * std::cos(phase);
      const Vec3 u = modes.mode(j)[v];
      EXPECT_NEAR(j % 2 == 0 ? u.y : u.z, 0.4 * std::sin(phase), 1e-14);
      EXPECT_EQ(j % 2 == 0 ? u.z : u.y, 0);
      EXPECT_NEAR(u.x, -(j % 2 == 0 ? p.y : p.z) * slope, 1e-14);
    }
  }
}

TEST(SampleMotions, coordinates_swing_from_rest) {
  const std::vector<double> q = sample_coordinates(3, 9);
  ASSERT_EQ(q.size(), 27u);
  for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(q[j], 0);
  EXPECT_NEAR(q[2 * 3 + 0], 1, 1e-15);    // a quarter of the way
  EXPECT_NEAR(q[2 * 3 + 1], 0, 1e-15);    // half a swing
  EXPECT_NEAR(q[1 * 3 + 1], 0.5, 1e-15);  // an eighth of the way
  EXPECT_NEAR(q[2 * 3 + 2], -1.0 / 3, 1e-15);
  EXPECT_EQ(sample_coordinates(2, 1), (std::vector<double>{0, 0}));
}

TEST(SampleMotions, the_skin_is_one_bone_at_the_ends_and_both_at_the_joint) {
  const Mesh bar = sample_body("bar", 40);
  const Skin skin = sample_skin(bar.positions);
  ASSERT_EQ(skin.vertex_count(), bar.vertex_count());
  std::size_t shared = 0;
  for (std::size_t v = 0; v < bar.vertex_count(); ++v) {
    double sum = 0;
    for (std::uint32_t i = skin.begin[v]; i < skin.begin[v + 1]; ++i) {
      sum += skin.weights[i];
      if (bar.positions[v].x < -0.41) {
        EXPECT_EQ(skin.bones[i], 0u);
      }
      if (bar.positions[v].x > 0.41) {
        EXPECT_EQ(skin.bones[i], 1u);
      }
    }
    shared += skin.begin[v + 1] - skin.begin[v] == 2;
    EXPECT_NEAR(sum, 1, 1e-15);
  }
  EXPECT_GT(shared, 0u);
}

TEST(SampleMotions, the_second_bone_turns_about_the_middle_and_comes_back) {
  const Mesh limb = sample_body("limb", 16);
  const std::vector<AffineTransform> bones = sample_bones(limb.positions, 5);
  ASSERT_EQ(bones.size(), 10u);
  for (const std::size_t rest : {0, 1, 2, 8, 9}) EXPECT_EQ(bones[rest], AffineTransform{}) << rest;
  // In the middle 60 degrees about z: what is right of the joint ends up at an angle, as far from it as before.
  const Vec3 joint = bounding_box(limb).center(), moved = bones[5](joint + Vec3{1, 0, 0}) - joint;
  EXPECT_NEAR(moved.x, 0.5, 1e-14);
  EXPECT_NEAR(moved.y, std::sqrt(0.75), 1e-14);
  EXPECT_NEAR(moved.z, 0, 1e-14);
}

TEST(SampleMotions, positions_without_a_length_are_refused) {
  EXPECT_THROW(sample_modes({}), std::invalid_argument);
  const std::vector<Vec3> flat{{1, 0, 0}, {1, 2, 0}, {1, 0, 3}};
  EXPECT_THROW(sample_modes(flat), std::invalid_argument);
  EXPECT_THROW(sample_skin(flat), std::invalid_argument);
  EXPECT_THROW(sample_bones({}, 3), std::invalid_argument);
}

}  // namespace
}  // namespace morula
