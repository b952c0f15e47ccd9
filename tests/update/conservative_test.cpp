// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The paper's rules made to cover: radii raised to what owned corners need, no more.
#include <gtest/gtest.h>

#include <morula/update/body.hpp>

#include "bodies.hpp"

namespace morula {
namespace {

using test::Motion;
using test::motions;
using test::Specimen;
using test::specimens;
using test::spheres_of;

const std::vector<std::vector<Rule>> rule_lists{{Rule::traditional},
                                                {Rule::weighted},
                                                {Rule::approach1},
                                                {Rule::approach2},
                                                {Rule::exact, Rule::approach2},
                                                {Rule::approach1, Rule::exact, Rule::traditional}};

TEST(Conservative, rules_cover_every_level_of_every_body_in_every_motion) {
  std::size_t bare_without = 0;
  for (const Specimen& b : specimens())
    for (const auto& rules : rule_lists) {
      Body body(b.mesh, b.model, {.rules = rules, .conservative = true});
      EXPECT_TRUE(certify(body.cover(), b.mesh.positions, spheres_of(body)).covered) << b.name << " at rest";
      Body as_published(b.mesh, b.model, {.rules = rules});
      for (const Motion& motion : motions()) {
        const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
        ASSERT_TRUE(body.update(positions));
        ASSERT_TRUE(as_published.update(positions));
        EXPECT_TRUE(certify(body.cover(), positions, spheres_of(body)).covered) << b.name << ", " << motion.name;
        bare_without += !certify(body.cover(), positions, spheres_of(as_published)).covered;
      }
    }
  EXPECT_GT(bare_without, 20u) << "the option is needed";
}

TEST(Conservative, spheres_keep_their_centers_and_grow_to_the_farthest_owned_corner_only) {
  for (const Specimen& b : specimens())
    for (const Rule rule : {Rule::traditional, Rule::approach1, Rule::approach2}) {
      Body body(b.mesh, b.model, {.rules = {rule}, .conservative = true}), plain(b.mesh, b.model, {.rules = {rule}});
      const std::vector<Vec3> positions = test::noisy(b.mesh.positions, 0.2, 9);
      ASSERT_TRUE(body.update(positions));
      ASSERT_TRUE(plain.update(positions));
      const double size = bounding_box(b.mesh).diagonal();
      for (std::uint32_t i = 0; i < b.model.tree.node_count(); ++i) {
        EXPECT_EQ(body.spheres()[i].center, plain.spheres()[i].center);
        double needed = 0;
        for (const std::uint32_t c : body.cover().region_corners(i))
          needed = std::max(needed, distance(corner_position(body.cover(), c, positions), body.sphere(i).center));
        EXPECT_NEAR(body.sphere(i).radius, std::max(needed, plain.sphere(i).radius), 1e-5 * size)
            << b.name << ", node " << i;
      }
    }
}

TEST(Conservative, bodies_return_to_rest_and_change_nothing_under_exact) {
  const Specimen& b = specimens()[2];
  for (const auto& rules : rule_lists) {
    Body body(b.mesh, b.model, {.rules = rules, .conservative = true});
    const std::uint64_t rest = body.hash();
    ASSERT_TRUE(body.update(test::noisy(b.mesh.positions, 0.3, 2)));
    EXPECT_NE(body.hash(), rest);
    ASSERT_TRUE(body.update(b.mesh.positions));
    EXPECT_EQ(body.hash(), rest);
  }
  EXPECT_EQ(Body(b.mesh, b.model, {.conservative = true}).hash(), Body(b.mesh, b.model).hash());
}

}  // namespace
}  // namespace morula
