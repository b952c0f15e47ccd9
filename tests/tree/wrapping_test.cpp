// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The last step of a build: spheres contain their regions in real numbers, and those that do stay as they are.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <tree/wrapping.hpp>

namespace morula {
using namespace detail;
namespace {

using Wide = Vector3<long double>;

// One facet of a size, far away, cut at a point of its inside: the root and three leaves, each about a place near by.
struct FarFacet {
  Mesh mesh{{}, {{0, 1, 2}}};
  CoveredTree model;

  FarFacet(Random& random, double size, double away) {
    const auto near = [&](const Vec3& p, double by) {
      return p + Vec3{random.uniform(-by, by), random.uniform(-by, by), random.uniform(-by, by)};
    };
    const Vec3 place{away * random.uniform(0.5, 1), away * random.uniform(-1, 1), away * random.uniform(-1, 1)};
    for (int i = 0; i < 3; ++i) mesh.positions.push_back(near(place, size));
    const double v = random.uniform(0.1, 0.4), w = random.uniform(0.1, 0.4);
    Cover& c = model.cover;
    c.vertex_count = 3, c.facet_count = 1;
    c.cut_points = {{{0, 1, 2}, {1 - v - w, v, w}}};
    c.patch_facet = {0, 0, 0};
    c.corner_begin = {0, 3, 6, 9};
    c.corners = {0, 1, 3, 1, 2, 3, 2, 0, 3};
    c.region_begin = {0, 0, 1, 2};
    c.region_end = {3, 1, 2, 3};
    model.tree.branching = 3;
    const auto any = [&] { return Sphere{near(place, size), 0}; };
    model.tree.append_level({}, std::vector<Sphere>{any()});
    model.tree.append_level(std::vector<std::uint32_t>{3}, std::vector<Sphere>{any(), any(), any()});
  }
  // As a builder measures it: in the order of the facet's corners.
  double measured(std::uint32_t node) const {
    double farthest = 0;
    for (const std::uint32_t c : model.cover.region_corners(node)) {
      const Vec3 p = corner_position(model.cover, c, mesh.positions);
      farthest = std::max(farthest, distance(model.tree.spheres[node].center, p));
    }
    return farthest;
  }
  // In real numbers, but for what long double loses.
  long double true_distance(std::uint32_t node) const {
    long double farthest = 0;
    for (const std::uint32_t c : model.cover.region_corners(node)) {
      Wide p{};
      if (c < 3) {
        p = Wide(mesh.positions[c]);
      } else {
        for (int k = 0; k < 3; ++k)
          p += Wide(mesh.positions[k]) * static_cast<long double>(model.cover.cut_points[0].weight[k]);
      }
      farthest = std::max(farthest, length(p - Wide(model.tree.spheres[node].center)));
    }
    return farthest;
  }
  double largest(std::uint32_t node) const {
    return std::max(largest_coordinate(mesh), max_norm(model.tree.spheres[node].center));
  }
};

// Radii that are the measured distance, to the bit, and a few roundings about it: what certify() finds inside may be
// outside.
TEST(Wrapping, contains_regions_in_real_numbers) {
  Random random(3);
  std::size_t outside = 0, grown = 0;
  for (int round = 0; round < 3000; ++round) {
    const double away = std::exp2(random.uniform(-20, 60)), size = away * std::exp2(random.uniform(-48, 2));
    FarFacet far(random, size, away);
    for (std::uint32_t node = 0; node < 4; ++node) {
      Sphere& s = far.model.tree.spheres[node];
      s.radius = std::max(0.0, far.measured(node) + random.uniform(-12, 12) * 0x1p-53 * far.largest(node));
      outside += far.true_distance(node) > static_cast<long double>(s.radius);
    }
    grown += wrap_regions(far.mesh, far.model, serial_workers()).grown;
    for (std::uint32_t node = 0; node < 4; ++node)
      ASSERT_LE(far.true_distance(node), static_cast<long double>(far.model.tree.spheres[node].radius) +
                                             0x1p-60L * static_cast<long double>(far.largest(node)))
          << round;
    ASSERT_TRUE(certify(far.model.cover, far.mesh.positions, far.model.tree.spheres).covered);
  }
  EXPECT_GT(outside, 1000u);
  EXPECT_GE(grown, outside);
}

TEST(Wrapping, leaves_fitted_spheres_as_they_are) {
  Random random(4);
  for (int round = 0; round < 3000; ++round) {
    const double away = std::exp2(random.uniform(-20, 60)), size = away * std::exp2(random.uniform(-48, 2));
    FarFacet far(random, size, away);
    for (std::uint32_t node = 0; node < 4; ++node) {
      // Measured in another order, or where a cut has moved the point since: off by ten roundings at most.
      const double off = random.uniform(-10, 10) * 0x1p-53 * far.largest(node);
      far.model.tree.spheres[node].radius =
          rounded_up_radius(std::max(0.0, far.measured(node) + off), far.largest(node));
    }
    const SphereTree before = far.model.tree;
    EXPECT_EQ(wrap_regions(far.mesh, far.model, serial_workers()).grown, 0u);
    ASSERT_EQ(far.model.tree.spheres, before.spheres) << round;
  }
}

TEST(Wrapping, says_how_many_grew_and_by_how_much) {
  Random random(5);
  FarFacet far(random, 1, 1);
  for (std::uint32_t node = 0; node < 4; ++node)
    far.model.tree.spheres[node].radius = node == 2 ? 0.5 * far.measured(node) : 2 * far.measured(node);
  const LevelGrowth growth = wrap_regions(far.mesh, far.model, serial_workers());
  EXPECT_EQ(growth.grown, 1u);
  EXPECT_NEAR(growth.largest_factor, 2, 1e-9);
  EXPECT_NEAR(growth.largest_growth, 0.5 * far.measured(2), 1e-9);
}

}  // namespace
}  // namespace morula
