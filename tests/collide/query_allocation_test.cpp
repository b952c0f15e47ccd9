// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// No query allocates once it is warm: every one is counted.
#include <gtest/gtest.h>

#include <morula/collide/containment.hpp>
#include <morula/collide/distance.hpp>
#include <support/allocations.hpp>
#include <support/meshes.hpp>

#include "placed_bodies.hpp"

namespace morula {
namespace {

using test::allocations;

TEST(QueryAllocation, none_when_the_same_questions_have_been_asked_before) {
  test::PlacedBody a(test::icosphere(3)), b(test::uv_sphere(15, 9, 0.7)), plate(test::grid_plate(5));
  DistanceQuery query;
  InsideQuery inside(a.collider);
  TouchQuery touched;
  Containment contained;
  const std::vector<std::uint32_t> parts = component_vertices(b.mesh);
  const std::size_t before_all = allocations;
  const auto ask_everything = [&] {
    bool good = true;
    for (const double x : {0.0, 0.5, 1.65, 1.9, 3.0}) {
      b.collider.set_transform(RigidTransform::from_axis({1, 2, 3}, x, {x, 0.1, 0.2}));
      for (const bool warm : {true, false})
        good = good && query.run(a.collider, b.collider, {.warm_start = warm}).status;
      good = good && query.run(a.collider, b.collider, {.to_facets = false, .budget = 40}).status;
      good = good && touched.run(a.collider, HalfSpace{{0, 0, 1}, x - 1}, {.collect_all = true}).status;
      good = good && touched.run(a.collider, Sphere{{x, 0, 0}, 0.5}, {.nearest = true}).status;
      good = good && touched.run(a.collider, Capsule{{x, 0, 0}, {x, 3, 0}, 0.3}, {.stop_at_first = true}).status;
      good = good && first_hit(b.collider, {{5, 0.1, 0.2}, {-1, 0, 0}}).status;
      good = good && inside.locate({x, 0, 0}).status && inside.probe({{x, 0, 0}, 0.1}).status;
      good = good && inside.components_inside(b.collider, parts, contained);
      // Refusals as well.
      good = good && !touched.run(a.collider, Sphere{{x, 0, 0}, -1}, {}).status;
      good = good && !query.run(a.collider, b.collider, {.tolerance = -1}).status;
    }
    return good;
  };
  // Twice: the second round starts where the first one ended.
  EXPECT_TRUE(ask_everything() && ask_everything());
  EXPECT_GT(allocations, before_all) << "the counter counts";
  const std::size_t before = allocations;
  const bool good = ask_everything();
  const std::size_t after = allocations;
  EXPECT_TRUE(good);
  EXPECT_EQ(after - before, 0u);
}

}  // namespace
}  // namespace morula
