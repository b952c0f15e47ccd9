// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Nested bodies in motion: the rule `wrapped`, judged in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/generators/build.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/update/body.hpp>
#include <support/aligned.hpp>

#include "bodies.hpp"

namespace morula {
namespace {

// The largest |c - c'| + r' - r below nodes of the rule `wrapped`, about the origin and in mesh coordinates.
long double worst_excess(const Body& body) {
  const SphereTree& tree = body.rest_tree();
  const std::vector<Sphere> in_mesh = test::spheres_of(body);
  long double worst = -std::numeric_limits<long double>::infinity();
  const auto add = [&](const auto& outer, const auto& inner) {
    long double squared = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const long double d = static_cast<long double>(outer.center[axis]) - static_cast<long double>(inner.center[axis]);
      squared += d * d;
    }
    worst = std::max(
        worst, std::sqrt(squared) + static_cast<long double>(inner.radius) - static_cast<long double>(outer.radius));
  };
  for (std::uint32_t node = 1; node < tree.node_count(); ++node) {
    const std::uint32_t parent = tree.parent[node];
    if (rule_of_level(body.options().rules, tree.level_of(parent)) != Rule::wrapped) continue;
    add(body.spheres()[parent], body.spheres()[node]);
    add(in_mesh[parent], in_mesh[node]);
  }
  return worst;
}

Vec3 farthest_corner(const Mesh& mesh, const Vec3& direction) {
  return *std::max_element(mesh.positions.begin(), mesh.positions.end(),
                           [&](const Vec3& p, const Vec3& q) { return dot(p, direction) < dot(q, direction); });
}

bool all_wrapped(const Body& body) {
  for (std::uint32_t node = 0; node < body.rest_tree().node_count(); ++node)
    if (!body.rest_tree().is_leaf(node) &&
        rule_of_level(body.options().rules, body.rest_tree().level_of(node)) != Rule::wrapped)
      return false;
  return true;
}

void expect_nested(const std::string& name, const Body& body) {
  EXPECT_LE(worst_excess(body), 0) << name;
  EXPECT_TRUE(certify_promised_nesting(body).nested) << name;
  EXPECT_EQ(body.sphere_state().nested, all_wrapped(body)) << name;
  EXPECT_EQ(body.current_tree().nested, body.sphere_state().nested) << name;
  const auto faults = validate(body.current_tree());
  EXPECT_TRUE(faults.empty()) << name << ": " << faults.front();
}

const std::vector<UpdateOptions>& options_that_wrap() {
  static const std::vector<UpdateOptions> options{
      {.rules = {Rule::wrapped}},
      {.rules = {Rule::wrapped}, .details = {.wrapped_center = RuleOptions::WrappedCenter::smallest}},
      {.rules = {Rule::wrapped, Rule::exact}},
      {.rules = {Rule::wrapped, Rule::wrapped, Rule::approach2}},
      {.rules = {Rule::wrapped, Rule::approach1}},
      {.rules = {Rule::exact, Rule::wrapped}},
      {.rules = {Rule::wrapped}, .conservative = true},
      {.rules = {Rule::wrapped, Rule::wrapped, Rule::approach2}, .conservative = true},
      {.rules = {Rule::wrapped, Rule::approach1}, .conservative = true},
      {.rules = {Rule::wrapped, Rule::traditional, Rule::wrapped, Rule::weighted}, .conservative = true}};
  return options;
}

TEST(Nested, spheres_of_the_rule_wrapped_contain_their_childrens_in_every_motion) {
  for (const test::Specimen& b : test::specimens())
    for (const UpdateOptions& options : options_that_wrap()) {
      Body body(b.mesh, b.model, options);
      const std::string rules = describe_rules(options.rules, b.model.tree.level_count());
      EXPECT_TRUE(any_promises_nesting(body) || b.model.tree.level_count() == 1);
      expect_nested(b.name + ", " + rules + " at rest", body);
      const std::uint64_t rest = body.hash();
      for (const test::Motion& motion : test::motions()) {
        const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
        ASSERT_TRUE(body.update(positions));
        expect_nested(b.name + ", " + rules + ", " + motion.name, body);
        if (covers(options)) {
          EXPECT_TRUE(certify(body.cover(), positions, test::spheres_of(body)).covered);
        }
      }
      ASSERT_TRUE(body.update(b.mesh.positions));
      EXPECT_EQ(body.hash(), rest);
    }
}

TEST(Nested, bodies_hold_far_away_at_any_size_and_on_aligned_meshes) {
  for (const test::NamedMesh& named : test::aligned_bodies()) {
    const CoveredTree model = build(named.mesh, {.method = Method::octree, .branching = 4, .depth = 2, .nested = true});
    Body body(named.mesh, model, {.rules = {Rule::wrapped}});
    expect_nested(named.name, body);
    for (const double scale : {1e-25, 1e-9, 1.0, 1e9, 1e16})
      for (const double offset : {0.0, 1e3, 1e7, 1e12}) {
        ASSERT_TRUE(body.update(
            test::translated(test::scaled(named.mesh.positions, scale), Vec3{1, -2, 0.3} * (offset * scale))));
        expect_nested(named.name + " at scale " + std::to_string(scale) + ", " + std::to_string(offset) + " away",
                      body);
      }
  }
}

// Ratios of the paper's rules grow without measure where a distance at rest was small; their radii stop at 2^60. Those
// of their parents do not, which have to contain them: here both leaves are as large as can be, and apart.
TEST(Nested, parents_of_spheres_whose_radii_stop_contain_them) {
  const Mesh mesh = test::icosphere(1);
  std::vector<Sphere> leaves;
  for (const double x : {-1.0, 1.0}) leaves.push_back({farthest_corner(mesh, {x, 0, 0}) * 0.999, 0.9});
  const CoveredTree model = test::root_with_leaves(mesh, {{0, 0, 0}, 2}, leaves);
  Body body(mesh, model, {.rules = {Rule::wrapped, Rule::approach1}});
  for (const std::uint64_t seed : {1, 2, 3}) {
    ASSERT_TRUE(body.update(test::noisy(test::scaled(mesh.positions, 0x1p52), 0x1p55, seed)));
    expect_nested("large", body);
    for (const std::uint32_t leaf : {1, 2}) EXPECT_EQ(body.spheres()[leaf].radius, largest_radius) << seed;
    EXPECT_NE(body.spheres()[1].center, body.spheres()[2].center) << seed;
    EXPECT_GT(body.spheres()[0].radius, largest_radius) << seed;
  }
}

// A convex function of the center, made least by steps in all directions that shrink where none helps.
double smallest_reach(const Body& body, std::uint32_t parent) {
  const SphereTree& tree = body.rest_tree();
  static const std::vector<Vec3> directions = fibonacci_directions(100);
  const auto reach = [&](const Vec3& center) {
    double largest = 0;
    for (std::uint32_t c = tree.first_child[parent]; c < tree.first_child[parent] + tree.child_count[parent]; ++c)
      largest = std::max(largest, distance(center, body.sphere(c).center) + body.sphere(c).radius);
    return largest;
  };
  Vec3 center = body.sphere(parent).center;
  double best = reach(center);
  for (double step = 0.5 * best; step > 1e-4 * best;) {
    const double before = best;
    const Vec3 from = center;
    for (const Vec3& direction : directions)
      if (const double r = reach(from + step * direction); r < best) best = r, center = from + step * direction;
    if (best == before) step *= 0.7;
  }
  return best;
}

TEST(Nested, centers_that_are_pulled_reach_their_children_with_little_more_than_the_least) {
  for (const test::Specimen& b : test::specimens()) {
    Body carried(b.mesh, b.model, {.rules = {Rule::wrapped, Rule::exact}});
    Body pulled(
        b.mesh, b.model,
        {.rules = {Rule::wrapped, Rule::exact}, .details = {.wrapped_center = RuleOptions::WrappedCenter::smallest}});
    for (const test::Motion& motion : test::motions()) {
      const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
      ASSERT_TRUE(carried.update(positions));
      ASSERT_TRUE(pulled.update(positions));
      EXPECT_LE(pulled.sphere(0).radius, carried.sphere(0).radius * (1 + 1e-6)) << b.name << ", " << motion.name;
      if (b.model.tree.child_count[0] > 0) {
        EXPECT_LE(pulled.sphere(0).radius, 1.05 * smallest_reach(pulled, 0)) << b.name << ", " << motion.name;
      }
    }
  }
}

TEST(Nested, the_certificate_finds_a_body_that_is_not) {
  const Mesh mesh = test::icosphere(2);
  const CoveredTree model = test::hand_made_tree(mesh, {.depth = 2});
  Body body(mesh, model, {.rules = {Rule::exact}});
  EXPECT_FALSE(any_promises_nesting(body));
  EXPECT_FALSE(body.sphere_state().nested);
  EXPECT_FALSE(certify_nesting(model.tree, test::spheres_of(body)).nested);
}

TEST(Nested, spheres_at_rest_are_no_larger_than_the_trees) {
  const Mesh mesh = test::icosphere(3);
  const CoveredTree model = build(mesh, {.method = Method::grid, .depth = 2, .nested = true});
  const Body body(mesh, model, {.rules = {Rule::wrapped}});
  for (std::uint32_t node = 0; node < model.tree.node_count(); ++node)
    EXPECT_LE(body.sphere(node).radius, model.tree.spheres[node].radius + 1e-5);
}

}  // namespace
}  // namespace morula
