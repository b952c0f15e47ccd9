// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds of skinned clusters contain every vertex, rounding included.
#include <gtest/gtest.h>

#include <string>

#include "bodies.hpp"
#include "skin_bounds_oracle.hpp"

namespace morula {
namespace {

using test::Specimen;
using test::specimens;
using namespace test::skin_bounds;

void expect_all_inside(const std::string& name, const Mesh& mesh, double size, std::size_t characters) {
  for (const Weights kind :
       {Weights::smooth, Weights::rough, Weights::negative, Weights::eight, Weights::loose_sums, Weights::one})
    for (const std::size_t per_cluster : {std::size_t{3}, std::size_t{40}, mesh.facet_count()}) {
      const Skin skin = skin_of_kind(mesh, 9, kind, size);
      const std::vector<std::uint32_t> clusters = some_clusters(mesh, per_cluster);
      SkinBounds bounds(mesh, skin, clusters);
      Random random(3);
      Motions motions;
      for (std::size_t c = 0; c < characters; ++c) {
        const int round = static_cast<int>(c % 8);
        for (std::size_t b = 0; b < skin.bone_count; ++b)
          motions.push_back(
              motion_of_kind(random, round == 6 ? static_cast<int>(b % motion_kinds) : round % motion_kinds, size));
        if (c % 4 == 0) motions[c * skin.bone_count] = {};
        if (round == 7) std::fill_n(motions.end() - 9, 9, motions.back());
      }
      const Bounds result = bounds_of(bounds, motions);
      for (std::size_t c = 0; c < characters; ++c)
        for (const Missing missing : {Missing::stays_at_rest, Missing::is_dropped}) {
          const Excess most = excess_of(result, mesh, clusters, c, [&](std::size_t v) {
            return moved_vertex(mesh, skin, motions.data() + c * skin.bone_count, v, missing);
          });
          const std::string where =
              name + ", weights " + std::to_string(static_cast<int>(kind)) + ", character " + std::to_string(c);
          EXPECT_LE(most.sphere, 0) << where;
          EXPECT_LE(most.box, 0) << where;
          EXPECT_LE(most.whole, 0) << where;
        }
    }
}

TEST(SkinBounds, contain_every_vertex_at_any_transforms) {
  for (const Specimen& b : specimens()) expect_all_inside(b.name, b.mesh, 1, 8);
}

TEST(SkinBounds, contain_every_vertex_far_from_the_origin_and_at_any_size) {
  const Specimen& b = specimens()[2];
  for (const double scale : {1e-25, 1e-9, 1e3})
    for (const double away : {0.0, 1e3, 1e7}) {
      Mesh mesh = b.mesh;
      for (Vec3& p : mesh.positions) p = (p + Vec3{away, -away, 0.3 * away}) * scale;
      expect_all_inside("scale " + std::to_string(scale) + ", away " + std::to_string(away), mesh, scale, 8);
    }
}

// Facets far smaller than the rounding of their positions; one motion for all bones, so that spheres have no slack.
TEST(SkinBounds, pay_for_rounding) {
  Random random(11);
  for (int round = 0; round < 4000; ++round) {
    Mesh mesh;
    const Vec3 middle = vector_within(random, 2);
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(middle + vector_within(random, 0x1p-33));
    mesh.facets = {{0, 1, 2}};
    const std::size_t bones = round % 3 == 0 ? 1 : 8;
    Skin skin{.bone_count = bones, .begin = {0}};
    for (std::uint32_t v = 0; v < 3; ++v) {
      for (std::uint32_t k = 0; k < bones; ++k)
        skin.bones.push_back(k), skin.weights.push_back(1 / static_cast<double>(bones));
      skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
    }
    const std::vector<std::uint32_t> cluster{0};
    SkinBounds bounds(mesh, skin, cluster);
    AffineTransform motion = motion_of_kind(random, 0, 1);
    Motions motions(bones, motion);
    if (round % 2 == 0)
      for (AffineTransform& t : motions) t = motion_of_kind(random, 3, 4);
    const Bounds result = bounds_of(bounds, motions);
    const Excess exact = excess_of(result, mesh, cluster, 0, [&](std::size_t v) {
      return moved_vertex(mesh, skin, motions.data(), v, Missing::stays_at_rest);
    });
    const Excess shaded = excess_of(result, mesh, cluster, 0,
                                    [&](std::size_t v) { return shaded_vertex(mesh, skin, motions.data(), v); });
    ASSERT_LE(std::max({exact.sphere, exact.box, exact.whole}), 0) << round;
    ASSERT_LE(std::max({shaded.sphere, shaded.box, shaded.whole}), 0) << round;
    // Not by a wide margin.
    EXPECT_LE(result.spheres[0].radius, 2e-2f) << round;
  }
}

// Influences of one bone that cancel: what a shader rounds is far larger than the weights that are left.
TEST(SkinBounds, pay_for_influences_that_cancel) {
  Mesh mesh;
  for (int k = 0; k < 3; ++k) mesh.positions.push_back({0.7 + (k == 1 ? 1e-6 : 0), 0.3 + (k == 2 ? 1e-6 : 0), 0.9});
  mesh.facets = {{0, 1, 2}};
  const std::vector<std::uint32_t> cluster{0};
  // Bone 1 is left with no weight at all, and moves farther than bone 0.
  for (const double weight : {1.0, 1e3, 1e5}) {
    const std::vector<double> of_vertex{1 + weight, -weight, weight, -weight};
    Skin skin{.bone_count = 2, .begin = {0, 4, 8, 12}};
    for (int v = 0; v < 3; ++v) {
      skin.bones.insert(skin.bones.end(), {0, 0, 1, 1});
      skin.weights.insert(skin.weights.end(), of_vertex.begin(), of_vertex.end());
    }
    SkinBounds bounds(mesh, skin, cluster);
    Random random(5);
    for (int round = 0; round < 200; ++round) {
      const Motions motions{motion_of_kind(random, 0, 1), motion_of_kind(random, 0, 100)};
      const Bounds result = bounds_of(bounds, motions);
      const Excess shaded = excess_of(result, mesh, cluster, 0,
                                      [&](std::size_t v) { return shaded_vertex(mesh, skin, motions.data(), v); });
      ASSERT_LE(std::max({shaded.sphere, shaded.box, shaded.whole}), 0) << weight << ", " << round;
    }
  }
}

TEST(SkinBounds, pay_for_weights_that_do_not_add_up) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.facets = {{0, 1, 2}};
  const std::vector<std::uint32_t> cluster{0};
  for (const double slack : {-9.9e-7, 9.9e-7}) {
    const Skin skin{1, {0, 1, 2, 3}, {0, 0, 0}, {1 - slack, 1 + slack, 1}};
    SkinBounds bounds(mesh, skin, cluster);
    for (int axis = 0; axis < 3; ++axis)
      for (const double far : {-1e3, 1e3}) {
        Motions motions(1);
        motions[0].translation[axis] = far;
        const Bounds result = bounds_of(bounds, motions);
        for (const Missing missing : {Missing::stays_at_rest, Missing::is_dropped}) {
          const Excess most = excess_of(result, mesh, cluster, 0, [&](std::size_t v) {
            return moved_vertex(mesh, skin, motions.data(), v, missing);
          });
          EXPECT_LE(std::max({most.sphere, most.box, most.whole}), 0);
        }
      }
  }
}

// The largest transforms that are accepted: all results are numbers, and cover.
TEST(SkinBounds, stay_in_range_at_the_largest_transforms) {
  const Mesh& mesh = specimens()[0].mesh;
  for (const Weights kind : {Weights::rough, Weights::negative}) {
    const Skin skin = skin_of_kind(mesh, 9, kind, 1);
    const std::vector<std::uint32_t> clusters = some_clusters(mesh, 25);
    SkinBounds bounds(mesh, skin, clusters);
    const double most = static_cast<double>(bounds.data().largest_size);
    EXPECT_GE(most, 0x1p48);
    const double turned = most / (6 * std::max(1.0, static_cast<double>(bounds.data().reach)));
    Motions motions(9);
    for (std::size_t b = 0; b < 9; ++b) {
      const double sign = b % 2 == 0 ? 1 : -1;
      for (Vec3& column : motions[b].columns) column = Vec3{turned, turned, turned} * sign;
      motions[b].translation = Vec3{most, most, most} * (-0.49 * sign);
    }
    const Bounds result = bounds_of(bounds, motions);
    const Excess excess = excess_of(result, mesh, clusters, 0, [&](std::size_t v) {
      return moved_vertex(mesh, skin, motions.data(), v, Missing::stays_at_rest);
    });
    EXPECT_LE(std::max({excess.sphere, excess.box, excess.whole}), 0);
    for (const Spheref& s : result.spheres) EXPECT_TRUE(std::isfinite(s.radius));
  }
}

}  // namespace
}  // namespace morula
