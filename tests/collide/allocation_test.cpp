// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// No query allocates once its memory suffices: every one is counted.
#include <gtest/gtest.h>

#include <morula/collide/contact_query.hpp>
#include <morula/collide/overlap.hpp>
#include <support/allocations.hpp>

#include "specimens.hpp"

namespace morula {
namespace {

using test::allocations;

TEST(Allocation, no_query_allocates_with_a_reused_result) {
  const BuildOptions options{.method = Method::octree, .depth = 3};
  test::Specimen a("limb", 9, options), b("torus", 8, options);
  a.set_transform(RigidTransform::from_axis({1, 2, 3}, 1));
  std::size_t time = 0;
  CollideOptions timed{.budget = std::chrono::nanoseconds(20)};
  timed.clock = [&time] { return std::chrono::nanoseconds(time++); };
  const CollideOptions cases[]{{}, {.level = 2, .margin = 0.1}, {.budget = 500}, {.surfaces = true}, timed};
  Workers three(3);
  for (const CollideOptions& each : cases) {
    ContactQuery plain(each);
    plain.add(*a.collider, *b.collider);
    const Contacts& contacts = plain.contacts();
    ContactQuery query(each);
    query.add(*a.collider, *b.collider);
    const auto all = [&] {
      bool good = plain.run() && overlap(*a.collider, *b.collider);
      good = query.start() && query.resume(three) && query.carry(three) && query.carry() && good;
      return good && !contacts.contacts.empty();
    };
    const bool first = all() && all();
    const std::size_t before = allocations;
    const bool again = all();
    const std::size_t after = allocations;
    EXPECT_TRUE(first && again);
    EXPECT_EQ(after - before, 0u);
  }
  EXPECT_GT(allocations, 0u) << "the counter counts";
}

}  // namespace
}  // namespace morula
