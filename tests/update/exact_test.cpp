// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The promises of the rule `exact`: cover at every level with no tolerance, radii that rigid motion leaves alone.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <morula/update/body.hpp>

#include "bodies.hpp"

namespace morula {
namespace {

using test::motions;
using test::Specimen;
using test::specimens;

Certificate certified(const Body& body, const PositionView& positions) {
  std::vector<Sphere> spheres;
  body.copy_spheres(spheres);
  return certify(body.cover(), positions, spheres);
}

Mesh with_positions(const Mesh& mesh, std::vector<Vec3> positions) {
  return {std::move(positions), mesh.facets};
}

// The tree of a mesh that was scaled and moved. Radii get what rounding of the new coordinates may take.
CoveredTree scaled_and_moved(CoveredTree model, double factor, const Vec3& offset) {
  for (Sphere& s : model.tree.spheres) {
    s.center = s.center * factor + offset;
    s.radius = rounded_up_radius(s.radius * factor, max_norm(s.center) + s.radius * factor);
  }
  return model;
}

TEST(Exact, covers_every_level_under_every_motion) {
  for (const Specimen& b : specimens()) {
    Body body(b.mesh, b.model);
    EXPECT_TRUE(certified(body, b.mesh.positions).covered) << b.name << " at rest";
    for (const test::Motion& motion : motions()) {
      const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
      ASSERT_TRUE(body.update(positions));
      const Certificate c = certified(body, positions);
      EXPECT_TRUE(c.covered) << b.name << ", " << motion.name << ": node " << c.worst_node << " by " << c.worst_excess;
    }
  }
}

TEST(Exact, covers_under_a_hundred_random_noises) {
  for (const Specimen& b : specimens()) {
    Body body(b.mesh, b.model);
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      const double amplitude = std::pow(10.0, -5.0 + 0.08 * static_cast<double>(seed));  // to a thousand times the body
      const std::vector<Vec3> positions = test::noisy(b.mesh.positions, amplitude, seed);
      ASSERT_TRUE(body.update(positions));
      const Certificate c = certified(body, positions);
      EXPECT_TRUE(c.covered) << b.name << ", seed " << seed << ": node " << c.worst_node << " by " << c.worst_excess;
    }
  }
}

TEST(Exact, covers_far_from_the_origin_and_at_every_scale) {
  for (const Specimen& b : specimens())
    for (const double scale : {1e-6, 1e-3, 1.0, 1e3, 1e6})
      for (const double far : {0.0, 1e3, 1e6, 1e9}) {
        const Vec3 offset{far, -0.7 * far, 0.3 * far};
        const Mesh mesh = with_positions(b.mesh, test::translated(test::scaled(b.mesh.positions, scale), offset));
        Body body(mesh, scaled_and_moved(b.model, scale, offset));
        std::uint64_t seed = 0;
        for (const test::Motion& motion : motions()) {
          // Deformed where it is, and deformed near the origin and then carried off, which rounds every vertex anew.
          const std::vector<Vec3> here = motion.apply(mesh.positions);
          const std::vector<Vec3> there = test::translated(
              test::noisy(test::scaled(motion.apply(b.mesh.positions), scale), 0.1 * scale, ++seed), offset);
          for (const auto* positions : {&here, &there}) {
            ASSERT_TRUE(body.update(*positions));
            const Certificate c = certified(body, *positions);
            EXPECT_TRUE(c.covered) << b.name << " × " << scale << " at " << far << ", " << motion.name << ": node "
                                   << c.worst_node << " by " << c.worst_excess;
          }
        }
      }
}

// A rest mesh near the origin whose frames are far away: what the moving origin is for.
TEST(Exact, distance_from_the_origin_costs_no_precision) {
  for (const Specimen& b : specimens()) {
    Body near(b.mesh, b.model), far(b.mesh, b.model);
    const std::vector<Vec3> bent = motions()[3].apply(b.mesh.positions);
    ASSERT_TRUE(near.update(bent));
    ASSERT_TRUE(far.update(test::translated(bent, {1e9, -2e9, 5e8})));
    for (std::uint32_t i = 0; i < b.model.tree.node_count(); ++i)
      EXPECT_NEAR(near.sphere(i).radius, far.sphere(i).radius, 2e-5) << b.name << ", node " << i;
  }
}

TEST(Exact, covers_float_positions_as_the_caller_holds_them) {
  for (const Specimen& b : specimens()) {
    Body body(b.mesh, b.model);
    for (const double far : {0.0, 1e4}) {
      std::vector<Vec3f> positions;
      for (const Vec3& p : test::noisy(b.mesh.positions, 0.1, 9)) positions.emplace_back(p + Vec3{far, far, -far});
      ASSERT_TRUE(body.update(positions));
      EXPECT_TRUE(certified(body, positions).covered) << b.name << " at " << far;
    }
  }
}

TEST(Exact, covers_denormal_bodies_and_refuses_ones_that_overflow) {
  const Specimen& b = specimens()[2];
  for (const double scale : {1e-300, 1e-42, 1e-25, 1e-18, 1e15}) {
    const Mesh mesh = with_positions(b.mesh, test::scaled(b.mesh.positions, scale));
    Body body(mesh, scaled_and_moved(b.model, scale, {}));
    ASSERT_TRUE(body.update(test::noisy(mesh.positions, 0.3 * scale, 2)));
    EXPECT_TRUE(certified(body, test::noisy(mesh.positions, 0.3 * scale, 2)).covered) << scale;
    for (const Spheref& s : body.spheres()) EXPECT_TRUE(is_finite(s.center) && std::isfinite(s.radius)) << scale;
  }
  for (const double scale : {1e18, 1e30, 1e200}) {
    const Mesh mesh = with_positions(b.mesh, test::scaled(b.mesh.positions, scale));
    EXPECT_THROW(Body(mesh, scaled_and_moved(b.model, scale, {})), std::invalid_argument) << scale;
  }
  // A frame that flies apart is reported, and the last good spheres stay.
  Body body(b.mesh, b.model);
  const std::uint64_t before = body.hash();
  std::vector<Vec3> positions = b.mesh.positions;
  positions[17].y = 1e18;
  const UpdateStatus status = body.update(positions);
  EXPECT_EQ(status.code, UpdateStatus::Code::non_finite_position);
  EXPECT_EQ(status.index, 17u);
  EXPECT_EQ(body.hash(), before);
  positions[17].y = 1e17;
  ASSERT_TRUE(body.update(positions));
  EXPECT_TRUE(certified(body, positions).covered);
}

TEST(Exact, rigid_motion_leaves_radii_alone) {
  for (const Specimen& b : specimens()) {
    Body body(b.mesh, b.model);
    const std::vector<Spheref> rest(body.spheres().begin(), body.spheres().end());
    const double tolerance = 1e-5 * bounding_box(b.mesh).diagonal();
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{1, -2, 0.5}})
      for (const double degrees : {17.0, 90.0, 180.0, 271.0})
        for (const Vec3& offset : {Vec3{0, 0, 0}, Vec3{5, -3, 11}, Vec3{1e5, 1e5, -1e5}}) {
          const auto positions = test::translated(test::rotated(b.mesh.positions, axis, degrees), offset);
          ASSERT_TRUE(body.update(positions));
          for (std::size_t i = 0; i < rest.size(); ++i)
            EXPECT_NEAR(body.spheres()[i].radius, rest[i].radius, tolerance)
                << b.name << ", node " << i << " turned by " << degrees;
          EXPECT_TRUE(certified(body, positions).covered);
        }
  }
}

TEST(Exact, centers_inside_their_anchors_follow_affine_motion) {
  const Specimen& b = specimens()[2];
  Body body(b.mesh, b.model);
  const BindReport& report = body.bind_report();
  const std::size_t nodes = b.model.tree.node_count();
  ASSERT_LT(report.degenerate_anchors + report.carried_centers, nodes);
  // Shortens every distance, so no sphere grows and no center is pulled.
  const auto map = [](const Vec3& p) { return Vec3{0.7 * p.x + 0.2 * p.y, 0.6 * p.y, 0.8 * p.z - 0.3 * p.x}; };
  std::vector<Vec3> positions, centers;
  for (const Vec3& p : b.mesh.positions) positions.push_back(map(p));
  for (std::uint32_t i = 0; i < nodes; ++i) centers.push_back(map(body.sphere(i).center));
  ASSERT_TRUE(body.update(positions));
  std::size_t followed = 0;
  for (std::uint32_t i = 0; i < nodes; ++i) followed += distance(body.sphere(i).center, centers[i]) < 1e-5;
  EXPECT_GE(followed, nodes - report.degenerate_anchors - report.carried_centers);
}

TEST(Wrapped, covers_every_level_in_every_motion_and_contains_the_children) {
  for (const Specimen& b : specimens()) {
    Body body(b.mesh, b.model, {.rules = {Rule::wrapped}});
    const std::uint64_t rest = body.hash();
    for (const test::Motion& motion : test::motions()) {
      const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
      ASSERT_TRUE(body.update(positions));
      EXPECT_TRUE(certified(body, positions).covered) << b.name << ", " << motion.name;
      for (std::uint32_t i = 1; i < b.model.tree.node_count(); ++i) {
        const Sphere child = body.sphere(i), parent = body.sphere(b.model.tree.parent[i]);
        EXPECT_GE(parent.radius, distance(parent.center, child.center) + child.radius) << b.name << ", node " << i;
      }
    }
    ASSERT_TRUE(body.update(b.mesh.positions));
    EXPECT_EQ(body.hash(), rest);
  }
}

TEST(Exact, centers_of_spheres_that_grow_are_pulled_to_where_they_grow_less) {
  const Specimen& b = specimens()[2];
  Body body(b.mesh, b.model);
  const auto map = [](const Vec3& p) { return Vec3{2 * p.x, p.y, p.z}; };
  std::vector<Vec3> positions, carried_along;
  for (const Vec3& p : b.mesh.positions) positions.push_back(map(p));
  for (std::uint32_t i = 0; i < b.model.tree.node_count(); ++i) carried_along.push_back(map(body.sphere(i).center));
  ASSERT_TRUE(body.update(positions));
  EXPECT_TRUE(certified(body, positions).covered);
  double with_pull = 0, without = 0;
  for (std::uint32_t i = 0; i < b.model.tree.node_count(); ++i) {
    with_pull += body.sphere(i).radius;
    double farthest = 0;
    for (const std::uint32_t c : body.cover().region_corners(i))
      farthest = std::max(farthest, distance(corner_position(body.cover(), c, positions), carried_along[i]));
    without += farthest;
  }
  EXPECT_LT(with_pull, 0.95 * without);
}

TEST(Exact, flat_bodies_have_degenerate_anchors_and_say_so) {
  const Specimen& plate = specimens()[1];
  EXPECT_EQ(Body(plate.mesh, plate.model).bind_report().degenerate_anchors, plate.model.tree.node_count());
  const Specimen& ball = specimens()[0];
  EXPECT_LT(Body(ball.mesh, ball.model).bind_report().degenerate_anchors, ball.model.tree.node_count() / 4);
}

// Under exact, levels are independent of each other: mixing changes nothing for the levels that keep the rule.
TEST(Exact, spheres_do_not_depend_on_the_rules_of_other_levels) {
  for (const Specimen& b : specimens()) {
    Body all(b.mesh, b.model);
    Body upper(b.mesh, b.model, {.rules = {Rule::exact, Rule::exact, Rule::approach2}, .details = {}});
    Body lower(b.mesh, b.model, {.rules = {Rule::traditional, Rule::exact}, .details = {}});
    const std::vector<Vec3> positions = test::noisy(b.mesh.positions, 0.2, 4);
    for (Body* body : {&all, &upper, &lower}) ASSERT_TRUE(body->update(positions));
    for (std::uint32_t i = 0; i < b.model.tree.node_count(); ++i) {
      const std::uint32_t level = b.model.tree.level_of(i);
      if (level < 2) {
        EXPECT_EQ(all.spheres()[i], upper.spheres()[i]) << b.name << ", node " << i;
      }
      if (level > 0) {
        EXPECT_EQ(all.spheres()[i], lower.spheres()[i]) << b.name << ", node " << i;
      }
    }
  }
}

}  // namespace
}  // namespace morula
