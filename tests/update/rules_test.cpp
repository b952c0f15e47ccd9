// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Every rule against its plain double twin, over bodies, motions and options.
#include <gtest/gtest.h>

#include <morula/update/body.hpp>

#include "bodies.hpp"
#include "reference.hpp"

namespace morula {
namespace {

using test::motions;
using test::Specimen;
using test::specimens;
using test::spheres_of;

double size_of(const std::vector<Vec3>& positions, const Mesh& mesh) {
  Box box;
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f) box.add(positions[v]);
  return box.diagonal();
}

// Floats hold coordinates to 2^-24 of the body's size; ratios of distances magnify that by radius over distance, and
// each level above hands it on.
void expect_near(const std::vector<Sphere>& actual, const std::vector<Sphere>& expected, double size,
                 const std::string& where) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) {
    const double tolerance = 2e-5 * (size + expected[i].radius);
    EXPECT_LE(distance(actual[i].center, expected[i].center), tolerance) << where << ", node " << i;
    EXPECT_NEAR(actual[i].radius, expected[i].radius, tolerance) << where << ", node " << i;
  }
}

const std::vector<test::RestFacts>& rest_facts() {
  static const std::vector<test::RestFacts> facts = [] {
    std::vector<test::RestFacts> found;
    for (const Specimen& b : specimens()) found.emplace_back(b.mesh, b.model);
    return found;
  }();
  return facts;
}

void expect_like_reference(std::size_t specimen, const UpdateOptions& options, const std::string& rule_name) {
  const Specimen& b = specimens()[specimen];
  Body body(b.mesh, b.model, options);
  const std::vector<Sphere> rest = spheres_of(body);
  for (const test::Motion& motion : motions()) {
    const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
    ASSERT_TRUE(body.update(positions));
    const std::vector<Sphere> now = spheres_of(body);
    const auto reference = test::reference_update(rest_facts()[specimen], options, positions, rest, now);
    const std::string where = rule_name + " on " + b.name + ", " + motion.name;
    expect_near(rest, reference.rest, size_of(b.mesh.positions, b.mesh), where + ", rest");
    expect_near(now, reference.now, size_of(positions, b.mesh), where);
  }
}

TEST(Rules, names_round_trip) {
  EXPECT_EQ(all_rules().size(), rule_table.size());
  for (const Rule rule : all_rules()) EXPECT_EQ(rule_from_name(name(rule)), rule);
  EXPECT_EQ(name(Rule::exact), "exact");
  EXPECT_FALSE(rule_from_name("Exact"));
  EXPECT_FALSE(rule_from_name(""));
}

TEST(Rules, traditional_and_weighted_match_their_reference) {
  for (std::size_t b = 0; b < specimens().size(); ++b)
    for (const Rule rule : {Rule::traditional, Rule::weighted})
      expect_like_reference(b, {.rules = {rule}, .details = {}}, std::string(name(rule)));
}

TEST(Rules, approaches_match_their_reference) {
  for (std::size_t b = 0; b < specimens().size(); ++b)
    for (const Rule rule : {Rule::approach1, Rule::approach2})
      expect_like_reference(b, {.rules = {rule}, .details = {}}, std::string(name(rule)));
}

TEST(Rules, every_option_of_the_approaches_matches_its_reference) {
  const RuleOptions defaults;
  std::vector<RuleOptions> variants(5, defaults);
  variants[0].approach1_weights = RuleOptions::Weights::inverse_distance;
  variants[1].approach1_weights = RuleOptions::Weights::area;
  variants[2].approach1_inner_center = RuleOptions::InnerCenter::linked_vertices;
  variants[3].distance_floor = 0.25;
  variants[4].approach2_inner_boxes = RuleOptions::InnerBoxes::child_centers;
  for (std::size_t b = 0; b < specimens().size(); ++b)
    for (std::size_t k = 0; k < variants.size(); ++k)
      expect_like_reference(b, {.rules = {k == 4 ? Rule::approach2 : Rule::approach1}, .details = variants[k]},
                            "variant " + std::to_string(k));
}

TEST(Rules, levels_mix) {
  const std::vector<std::vector<Rule>> mixtures{
      {Rule::exact, Rule::approach1},
      {Rule::approach2, Rule::exact},
      {Rule::approach1, Rule::traditional, Rule::approach2},
      {Rule::traditional, Rule::approach1, Rule::exact, Rule::weighted},
      {Rule::approach2, Rule::approach1, Rule::weighted},
      {Rule::wrapped, Rule::wrapped, Rule::exact},
      {Rule::wrapped, Rule::approach2},
      {Rule::approach1, Rule::wrapped},
  };
  for (std::size_t b = 0; b < specimens().size(); ++b)
    for (std::size_t k = 0; k < mixtures.size(); ++k)
      expect_like_reference(b, {.rules = mixtures[k], .details = {}}, "mixture " + std::to_string(k));
}

TEST(Rules, exact_radii_are_the_farthest_owned_corners) {
  for (const Specimen& b : specimens()) {
    Body body(b.mesh, b.model);
    for (const test::Motion& motion : motions()) {
      const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
      ASSERT_TRUE(body.update(positions));
      const double tolerance = 1e-5 * size_of(positions, b.mesh);
      for (std::uint32_t node = 0; node < b.model.tree.node_count(); ++node) {
        const Sphere s = body.sphere(node);
        const double reach = test::owned_reach(b.model, node, s.center, positions);
        EXPECT_GE(s.radius, reach) << b.name << ", " << motion.name << ", node " << node;
        EXPECT_LE(s.radius, reach + tolerance) << b.name << ", " << motion.name << ", node " << node;
      }
    }
  }
}

// A robust floor may only lower ratios of near vertices, and all enclosed vertices of a leaf stay enclosed.
TEST(Rules, robust_distances_keep_enclosed_vertices_enclosed) {
  const Specimen& b = specimens()[2];
  UpdateOptions options{.rules = {Rule::approach1}, .details = {}};
  options.details.distance_floor = 0.25;
  Body robust(b.mesh, b.model, options);
  options.details.distance_floor = 0;
  Body paper(b.mesh, b.model, options);
  const std::vector<Vec3> positions = test::noisy(b.mesh.positions, 0.05, 11);
  ASSERT_TRUE(robust.update(positions));
  ASSERT_TRUE(paper.update(positions));
  std::size_t smaller = 0;
  for (std::uint32_t node = 0; node < b.model.tree.node_count(); ++node) {
    if (!b.model.tree.is_leaf(node)) continue;
    const Sphere& rest = b.model.tree.spheres[node];
    const Sphere now = robust.sphere(node);
    EXPECT_LE(now.radius, paper.sphere(node).radius * (1 + 1e-6));
    smaller += now.radius < 0.9 * paper.sphere(node).radius;
    for (const Facet& f : b.mesh.facets)
      for (const std::uint32_t v : f)
        if (distance(b.mesh.positions[v], rest.center) <= rest.radius) {
          EXPECT_LE(distance(positions[v], now.center), now.radius * (1 + 1e-5)) << "node " << node << ", vertex " << v;
        }
  }
  EXPECT_GT(smaller, 0u);
}

TEST(Rules, void_spheres_follow_the_nearest_linked_facet_with_their_radius) {
  const Mesh mesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {9, 9, 9}, {10, 9, 9}, {9, 10, 9}}, {{0, 1, 2}, {3, 4, 5}}};
  const std::vector<Sphere> leaves{
      {{1, 1, 0.25}, 0.5},  // cuts the first facet, no vertex inside
      {{1, 1, 3.0}, 0.5},   // touches nothing: moves as its parent does
      {{9, 9, 9}, 0.5},     // one vertex
  };
  const CoveredTree model = test::root_with_leaves(mesh, {{0, 0, 0}, 0.5}, leaves);
  for (const Rule rule : {Rule::traditional, Rule::weighted}) {
    Body body(mesh, model, {.rules = {rule}, .details = {}});
    EXPECT_EQ(body.bind_report().void_spheres, 2u);
    std::vector<Vec3> positions = mesh.positions;
    positions[0] += Vec3{0.3, 0, 0};
    positions[1] += Vec3{0, 0.6, 0};
    positions[3] += Vec3{0, 0, 2};
    ASSERT_TRUE(body.update(positions));
    EXPECT_LE(distance(body.sphere(1).center, Vec3{1.1, 1.2, 0.25}), 1e-5);
    EXPECT_NEAR(body.sphere(1).radius, 0.5, 1e-6);
    EXPECT_LE(distance(body.sphere(2).center, Vec3{1.3, 1, 3}), 1e-5) << "the root encloses vertex 0 alone";
    EXPECT_NEAR(body.sphere(2).radius, 0.5, 1e-6);
    EXPECT_LE(distance(body.sphere(3).center, Vec3{9, 9, 11}), 1e-5);
    EXPECT_LE(body.sphere(3).radius, 1e-4);
  }
}

TEST(Rules, leaves_that_touch_nothing_are_linked_to_the_nearest_facet) {
  const Mesh mesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {9, 9, 9}, {10, 9, 9}, {9, 10, 9}}, {{0, 1, 2}, {3, 4, 5}}};
  const std::vector<Sphere> leaves{{{1, 1, 3.0}, 0.5}, {{8, 8, 8}, 0.5}, {{9, 9, 9}, 0.5}};
  const CoveredTree model = test::root_with_leaves(mesh, {{5, 5, 5}, 10}, leaves);
  for (const Rule rule : {Rule::approach1, Rule::approach2}) {
    Body body(mesh, model, {.rules = {rule}, .details = {}});
    EXPECT_EQ(body.bind_report().unlinked_spheres, 2u);
    std::vector<Vec3> positions = mesh.positions;
    for (int v = 0; v < 3; ++v) positions[v] += Vec3{0, 0, 1};
    ASSERT_TRUE(body.update(positions));
    EXPECT_LE(distance(body.sphere(1).center, Vec3{1, 1, 4}), 1e-5) << name(rule);
    EXPECT_LE(distance(body.sphere(2).center, Vec3{8, 8, 8}), 1e-5) << name(rule);
  }
}

TEST(Rules, counters_are_those_of_the_work_and_the_same_every_time) {
  const Specimen& b = specimens()[2];
  for (const Rule rule : position_rules()) {
    Body body(b.mesh, b.model, {.rules = {rule}, .details = {}});
    const UpdateStatus first = body.update(b.mesh.positions);
    const UpdateStatus second = body.update(test::noisy(b.mesh.positions, 0.1, 3));
    EXPECT_EQ(first.nodes_updated, b.model.tree.node_count());
    EXPECT_EQ(first.vertices_read, b.mesh.vertex_count());
    EXPECT_EQ(first.cut_points_moved > 0, rule == Rule::exact || rule == Rule::wrapped);
    EXPECT_GT(first.points_tested, 0u);
    EXPECT_EQ(first.points_tested, second.points_tested);
    EXPECT_EQ(first.vertices_read, second.vertices_read);
    EXPECT_EQ(first.cut_points_moved, second.cut_points_moved);
  }
  Body exact(b.mesh, b.model);
  EXPECT_GE(exact.bind_report().corners_owned, b.mesh.vertex_count());
  EXPECT_GE(exact.update(b.mesh.positions).points_tested, 2 * exact.bind_report().corners_owned);
}

}  // namespace
}  // namespace morula
