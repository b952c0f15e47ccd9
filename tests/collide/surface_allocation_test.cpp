// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Questions like those before them allocate nothing: every one is counted.
#include <gtest/gtest.h>

#include <morula/collide/crossings.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <support/allocations.hpp>

#include "collide/facets/contact_surface.hpp"

namespace morula {
using namespace detail;
namespace {

using test::allocations;

TEST(SurfaceAllocation, warm_queries_allocate_nothing) {
  const Mesh mesh = sample_body("limb", 16), other = sample_body("torus", 16);
  const BuildOptions options{.method = Method::octree, .branching = 8, .depth = 2};
  const Body body_a(mesh, build(mesh, options)), body_b(other, build(other, options));
  Collider a(mesh, body_a), b(other, body_b);
  CrossingQuery found;
  SurfaceScratch scratch;
  std::size_t sum = 0;
  const auto ask = [&](double shift) {
    a.set_transform({.translation = {shift, 0.3, 0.1}});
    ASSERT_TRUE(found.run(a, b));
    sum += found.pairs().size();
    scratch.start(a, b);
    for (std::uint32_t node = 0; node < body_a.spheres().size(); node += 7) {
      const std::uint32_t partner = node % static_cast<std::uint32_t>(body_b.spheres().size());
      sum += contact_surface(a, node, b, partner, {shift, 0, 0}, {0, 0, 1}, 0.1, scratch).on_a.facet;
    }
  };
  ask(0.5);
  ask(0.6);
  const std::size_t before = allocations;
  ask(0.6);
  ask(0.5);
  EXPECT_EQ(allocations - before, 0u);
  EXPECT_GT(before, 0u) << "the counter counts";
  EXPECT_GT(sum, 0u);
}

}  // namespace
}  // namespace morula
