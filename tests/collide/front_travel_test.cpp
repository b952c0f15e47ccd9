// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What lets a verdict be carried over: no pair comes nearer, or moves apart, by more than its nodes have traveled.
#include <gtest/gtest.h>

#include <numbers>

#include "collide/front/front_walk.hpp"
#include "specimens.hpp"

namespace morula {
using namespace detail;
namespace {

// In the world: distance of the spheres of a child of one node and a child of another, or of themselves.
struct Pairs {
  explicit Pairs(const test::Specimen& a, const test::Specimen& b) {
    for (std::uint32_t i = 0; i < a.body->spheres().size(); ++i)
      for (std::uint32_t j = 0; j < b.body->spheres().size(); ++j) {
        const Sphere s = a.body->sphere(i), t = b.body->sphere(j);
        gap.push_back(distance(a.collider->transform()(s.center), b.collider->transform()(t.center)) - s.radius -
                      t.radius);
      }
  }
  std::vector<double> gap;
};

TEST(FrontTravel, no_gap_changes_by_more_than_was_traveled) {
  Random random(4);
  const BuildOptions options{.method = Method::octree, .depth = 2};
  test::Specimen a("limb", 8, options), b("blob", 7, options);
  a.set_transform(test::random_transform(random, 1));
  b.set_transform(test::random_transform(random, 1));
  const SphereTree &tree_a = a.body->rest_tree(), &tree_b = b.body->rest_tree();
  Front::Pair bodies;
  begin_travel(bodies, *a.collider, *b.collider, placed_pair(*a.collider, *b.collider, 0), true);
  const Pairs first(a, b);
  std::vector<double> scratch;
  double closest = 1e9;
  for (int frame = 0; frame < 12; ++frame) {
    const double step = frame % 2 == 0 ? 0.001 : 0.05;
    // The front half of a one way, the rest the other: what is in the middle stays.
    if (frame % 4 != 3)
      for (std::size_t i = 0; i < a.positions.size(); ++i)
        a.positions[i].y += (a.mesh.positions[i].x > 0 ? step : -step) * (1 + random.uniform());
    ASSERT_TRUE(a.body->update(a.positions));
    if (frame % 3 == 1) b.deform(random, step);
    if (frame % 3 == 2) {
      RigidTransform place = RigidTransform::from_axis({1, 2, 1}, step, b.collider->transform().translation);
      const RigidTransform columns = inverse({b.collider->transform().rows, {}});
      RigidTransform turned;
      for (std::size_t row = 0; row < 3; ++row)
        turned.rows[row] = {dot(place.rows[row], columns.rows[0]), dot(place.rows[row], columns.rows[1]),
                            dot(place.rows[row], columns.rows[2])};
      turned.translation = place.translation + Vec3{step, 0, 0};
      b.set_transform(turned);
    }
    follow_travel(bodies, *a.collider, *b.collider, placed_pair(*a.collider, *b.collider, 0), scratch);
    const Pairs now(a, b);
    const std::size_t count_b = tree_b.node_count();
    const auto check = [&](std::uint32_t i, std::uint32_t j, std::uint32_t above_i, std::uint32_t above_j) {
      const double change = std::abs(now.gap[i * count_b + j] - first.gap[i * count_b + j]);
      const double traveled = bodies.a.path_length[above_i] + bodies.b.path_length[above_j];
      closest = std::min(closest, traveled - change);
      return change <= traveled * (1 + 1e-12) + 1e-13;
    };
    std::size_t wrong = 0;
    for (std::uint32_t i = 1; i < tree_a.node_count(); ++i)
      for (std::uint32_t j = 1; j < count_b; ++j)
        wrong += !check(i, j, i, j) + !check(i, j, tree_a.parent[i], tree_b.parent[j]) +
                 !check(i, j, i, tree_b.parent[j]) + !check(i, j, tree_a.parent[i], j);
    EXPECT_EQ(wrong, 0u) << frame;
  }
  EXPECT_LT(closest, 1e-3) << "and not by much less";
}

// Nothing travels when nothing has changed, whatever the number of updates.
TEST(FrontTravel, at_rest_nothing_travels) {
  const BuildOptions options{.method = Method::octree, .depth = 2};
  test::Specimen a("limb", 8, options), b("blob", 7, options);
  a.set_transform(RigidTransform::from_axis({1, 2, 3}, 0.5, {1e6, 0, 0}));
  Front::Pair bodies;
  begin_travel(bodies, *a.collider, *b.collider, placed_pair(*a.collider, *b.collider, 0), true);
  const Front::Pair before = bodies;
  std::vector<double> scratch;
  ASSERT_TRUE(a.body->update(a.positions));
  follow_travel(bodies, *a.collider, *b.collider, placed_pair(*a.collider, *b.collider, 0), scratch);
  EXPECT_EQ(bodies.a.path_length, before.a.path_length);
  EXPECT_EQ(bodies.b.path_length, before.b.path_length);
  EXPECT_EQ(bodies.a.frame, before.a.frame + 1);
}

}  // namespace
}  // namespace morula
