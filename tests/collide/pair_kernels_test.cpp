// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The pair test against double arithmetic, and every kind of processor against plain loops.
#include "collide/pairs/pair_kernels.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <vector>

#include "collide/pairs/placed_pair.hpp"
#include "simd/processors.hpp"
#include "specimens.hpp"

namespace morula {
using namespace detail;
namespace {

std::vector<Spheref> random_spheres(std::size_t count, Random& random, double scale) {
  std::vector<Spheref> spheres(count);
  for (Spheref& s : spheres) {
    for (int axis = 0; axis < 3; ++axis) s.center[axis] = static_cast<float>(random.uniform(-scale, scale));
    s.radius = static_cast<float>(random.uniform(0, scale));
  }
  return spheres;
}

NarrowPair random_pair(Random& random, double scale) {
  const RigidTransform t = test::random_transform(random, scale);
  NarrowPair pair{};
  for (std::size_t row = 0; row < 3; ++row)
    for (int axis = 0; axis < 3; ++axis) pair.rows[row][axis] = static_cast<float>(t.rows[row][axis]);
  for (int axis = 0; axis < 3; ++axis) pair.translation[axis] = static_cast<float>(t.translation[axis]);
  pair.pad = static_cast<float>(0x1p-20 * scale);
  return pair;
}

TEST(PairKernels, all_processors_give_the_bits_of_plain_loops) {
  const auto kernels = all_pair_kernels();
  ASSERT_FALSE(kernels.empty());
  Random random(1);
  for (const double scale : {1.0, 1e-12, 0x1p57})
    for (std::size_t round = 0; round < 400; ++round) {
      const std::size_t count_a = 1 + random.next() % 64, count_b = 1 + random.next() % 64;
      const std::size_t more = random.next() % 20;
      const auto a = random_spheres(count_a + more, random, scale), b = random_spheres(count_b + more, random, scale);
      const NarrowPair pair = random_pair(random, scale);
      // Exactly as much memory as may be read.
      const PairBlock block{a.data(), count_a, a.size(), b.data(), count_b, b.size()};
      std::uint64_t expected[64], masks[64];
      const float least = kernels[0].test_and_measure(pair, block, expected);
      EXPECT_TRUE(std::isfinite(least));
      for (std::size_t kind = 0; kind < kernels.size(); ++kind) {
        const PairKernels& kernel = kernels[kind];
        std::fill(masks, masks + 64, 0x5555u);
        kernel.test(pair, block, masks);
        EXPECT_TRUE(std::equal(masks, masks + count_b, expected)) << kind_name(kind);
        std::fill(masks, masks + 64, 0x5555u);
        EXPECT_EQ(std::bit_cast<std::uint32_t>(kernel.test_and_measure(pair, block, masks)),
                  std::bit_cast<std::uint32_t>(least))
            << kind_name(kind);
        EXPECT_TRUE(std::equal(masks, masks + count_b, expected)) << kind_name(kind);
      }
    }
}

TEST(PairKernels, what_is_measured_is_below_the_least_difference) {
  Random random(2);
  for (int round = 0; round < 200; ++round) {
    const auto a = random_spheres(8, random, 1), b = random_spheres(8, random, 1);
    const NarrowPair pair = random_pair(random, 1);
    std::uint64_t masks[8];
    const double least = all_pair_kernels()[0].test_and_measure(pair, {a.data(), 8, 8, b.data(), 8, 8}, masks);
    double expected = 1e9;
    for (const Spheref& s : a)
      for (const Spheref& t : b) {
        const Vec3 c(t.center);
        Vec3 moved;
        for (int row = 0; row < 3; ++row)
          moved[row] = pair.rows[row][0] * c.x + pair.rows[row][1] * c.y + pair.rows[row][2] * c.z +
                       static_cast<double>(pair.translation[row]);
        expected = std::min(expected, std::abs(distance(Vec3(s.center), moved) -
                                               (static_cast<double>(s.radius) + static_cast<double>(t.radius))));
      }
    EXPECT_LE(std::sqrt(0.5 * least), expected + 1e-5);
    EXPECT_GE(std::sqrt(least), 0.7 * expected - 1e-5) << "of use";
  }
}

// Spheres of bodies in the world, by double arithmetic: touching ones are found whatever the rounding, and nothing that
// is apart by more than the pads.
TEST(PairKernels, touching_spheres_overlap_wherever_the_bodies_are) {
  Random random(3);
  const BuildOptions options{.method = Method::octree, .depth = 2};
  for (const double scale : {1.0, 1e-9, 1e9}) {
    for (const double away : {0.0, 1e6}) {
      test::Specimen a("torus", 8, options, scale, scale * away * Vec3{1, -1, 0.5});
      test::Specimen b("limb", 8, options, scale);
      // A sphere of each, made to touch to the last bit.
      for (int round = 0; round < 200; ++round) {
        const auto node_a = static_cast<std::uint32_t>(random.next() % a.body->spheres().size());
        const auto node_b = static_cast<std::uint32_t>(random.next() % b.body->spheres().size());
        a.set_transform(test::random_transform(random, scale * away));
        RigidTransform place = test::random_transform(random, 1);
        const Sphere sphere_a = a.body->sphere(node_a), sphere_b = b.body->sphere(node_b);
        const Vec3 direction = normalized(place.translation);
        const Vec3 wanted = a.collider->transform()(sphere_a.center) + (sphere_a.radius + sphere_b.radius) * direction;
        place.translation = {};
        place.translation = wanted - place(sphere_b.center);
        b.set_transform(place);
        const auto verdict = [&] {
          const PlacedPair placed = placed_pair(*a.collider, *b.collider, 0);
          const Spheref* first_a = &a.body->spheres()[node_a];
          const Spheref* first_b = &b.body->spheres()[node_b];
          std::uint64_t mask;
          pair_kernels().test(placed.narrow, {first_a, 1, 1, first_b, 1, 1}, &mask);
          return mask == 1;
        };
        EXPECT_TRUE(verdict()) << scale << ' ' << away;
        place.translation += (1e-5 * a.size + 1e-9 * scale * away) * direction;
        b.set_transform(place);
        EXPECT_FALSE(verdict()) << scale << ' ' << away;
      }
    }
  }
}

}  // namespace
}  // namespace morula
