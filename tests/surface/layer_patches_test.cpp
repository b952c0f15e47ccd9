// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Layer patches: sums of many points, formulas, differences of volumes, dense slides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/surface/layer_patches.hpp>
#include <numbers>
#include <support/allocations.hpp>
#include <support/error_text.hpp>
#include <support/meshes.hpp>

#include "layer_oracle.hpp"
#include "surfaces.hpp"

namespace morula {
namespace {

using test::grid_plate;
using test::icosphere;
using test::LayerRule;

double plain_volume(const Mesh& a, const Mesh& b, double thickness, int points) {
  return 0.5 * (test::plain_layer(a, a.positions, b, b.positions, thickness, points) +
                test::plain_layer(b, b.positions, a, a.positions, thickness, points));
}

double volume_of(const Mesh& a, const Mesh& b, double thickness) {
  LayerPatchQuery query({.thickness = thickness});
  EXPECT_TRUE(query.run(SurfaceTree(a), SurfaceTree(b)));
  return query.volume();
}

Vec3 random_vector(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

/// A plate that is centered at the origin, with noise.
Mesh rough_plate(int n, double noise, Random& random) {
  Mesh mesh = test::translated(grid_plate(n), {-0.5, -0.5, 0});
  for (Vec3& p : mesh.positions) p += random_vector(random, noise);
  return mesh;
}

/// The relations that hold for every patch.
void expect_consistent(const LayerPatchQuery& query, const SurfaceTree& a, const SurfaceTree& b, double tolerance) {
  double volume = 0;
  for (const LayerPatch& patch : query.patches()) {
    volume += patch.volume;
    EXPECT_LE(length(patch.a.area_vector + patch.b.area_vector), tolerance);
    EXPECT_LE(length(patch.a.moment + patch.b.moment), tolerance);
    for (const LayerSide* side : {&patch.a, &patch.b}) {
      const SurfaceTree& surface = side == &patch.a ? a : b;
      Vec3 sum, moment;
      for (const VertexGradient& g : side->gradients) {
        sum += g.gradient;
        moment += cross(surface.from(g.vertex) - patch.centroid, g.gradient);
      }
      EXPECT_LE(length(sum - side->area_vector), tolerance);
      EXPECT_LE(length(moment - side->moment), tolerance);
      EXPECT_TRUE(std::is_sorted(side->facets.begin(), side->facets.end()));
      EXPECT_TRUE(std::is_sorted(side->gradients.begin(), side->gradients.end(),
                                 [](const auto& g, const auto& h) { return g.vertex < h.vertex; }));
    }
    if (patch.points.size() < 3) continue;
    Vec3 force, moment;
    double sum = 0;
    for (const LayerPoint& point : patch.points) {
      force += point.force, sum += point.volume;
      moment += cross(point.point - patch.centroid, point.force);
    }
    EXPECT_LE(length(force + patch.a.area_vector), tolerance);
    EXPECT_LE(length(moment + patch.a.moment), tolerance);
    EXPECT_NEAR(sum, patch.volume, tolerance);
  }
  EXPECT_NEAR(volume, query.volume(), tolerance);
}

TEST(LayerPatches, volume_is_the_sum_of_many_points) {
  Random random(1);
  for (int round = 0; round < 6; ++round) {
    const Mesh a = rough_plate(3, 0.05, random);
    Mesh b = round % 2 == 0 ? rough_plate(4, 0.05, random) : icosphere(1, 0.4, {0.1, 0, 0.45});
    if (round % 2 == 0) b = test::translated(b, {0.2, 0.1, 0.08});
    for (const double thickness : {0.1, 0.3}) {
      const double expected = plain_volume(a, b, thickness, 200);
      EXPECT_NEAR(volume_of(a, b, thickness), expected, 2e-5 * expected) << round << ' ' << thickness;
    }
  }
}

// Coordinates are whole numbers: facets without area or with a repeated vertex, edges of one to many facets, coplanar
// and equal facets, and edges in the planes of others.
TEST(LayerPatches, volume_of_soups_is_the_sum_of_many_points) {
  Random random(2);
  for (int round = 0; round < 20; ++round) {
    const Mesh a = test::random_soup(8, 8, 2, random).mesh, b = test::random_soup(8, 8, 2, random).mesh;
    const double expected = plain_volume(a, b, 0.9, 100);
    EXPECT_NEAR(volume_of(a, b, 0.9), expected, 1e-3 * (1 + std::abs(expected))) << round;
  }
}

TEST(LayerPatches, slivers_are_nearly_segments) {
  for (const double height : {0.0, 1e-300, 1e-12, 1e-9, 1e-7, 1e-4}) {
    Mesh b;
    b.positions = {{-1, 0, 0.1}, {1, 0, 0.1}, {0.3, height, 0.1}, {0, 1, 0.1}};
    b.facets = {{0, 1, 2}, {2, 1, 3}, {0, 2, 3}};
    const Mesh a = test::translated(grid_plate(3), {-0.4, -0.3, 0});
    const double expected = plain_volume(a, b, 0.4, 200);
    EXPECT_NEAR(volume_of(a, b, 0.4), expected, 5e-5 * expected) << height;
  }
}

TEST(LayerPatches, gradients_are_differences_of_volumes) {
  Random random(3);
  for (int round = 0; round < 4; ++round) {
    Mesh a = rough_plate(3, 0.05, random);
    const Mesh b = round % 2 == 0 ? test::translated(rough_plate(3, 0.05, random), {0.2, 0.1, 0.1})
                                  : icosphere(1, 0.4, {0.1, 0, 0.45});
    SurfaceTree tree_a(a), tree_b(b);
    LayerPatchQuery query({.thickness = 0.2}), moved({.thickness = 0.2});
    ASSERT_TRUE(query.run(tree_a, tree_b));
    expect_consistent(query, tree_a, tree_b, 1e-14);
    for (const bool of_b : {false, true}) {
      const Mesh& mesh = of_b ? b : a;
      SurfaceTree& tree = of_b ? tree_b : tree_a;
      std::vector<Vec3> gradients(mesh.positions.size());
      for (const LayerPatch& patch : query.patches())
        for (const VertexGradient& g : (of_b ? patch.b : patch.a).gradients) gradients[g.vertex] += g.gradient;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        for (int k = 0; k < 3; ++k) {
          double at[2];
          for (const int sign : {0, 1}) {
            std::vector<Vec3> positions = mesh.positions;
            positions[v][k] += sign == 0 ? -1e-5 : 1e-5;
            ASSERT_TRUE(tree.update(positions));
            ASSERT_TRUE(moved.run(tree_a, tree_b));
            at[sign] = moved.volume();
          }
          EXPECT_NEAR(gradients[v][k], (at[1] - at[0]) / 2e-5, 2e-8) << round << ' ' << v << ' ' << k;
        }
      ASSERT_TRUE(tree.update(mesh.positions));
    }
  }
}

}  // namespace
}  // namespace morula
