// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The judge is judged: what is uncovered it calls uncovered, however little it is, and nothing else.
#include "judge.hpp"

#include <gtest/gtest.h>

#include <morula/collide/contact_query.hpp>
#include <morula/generators/build.hpp>
#include <morula/update/body.hpp>
#include <support/meshes.hpp>

#include "cases.hpp"
#include "contacts.hpp"
#include "covering.hpp"

namespace morula::properties {
namespace {

using oracle::Ball;
using oracle::CoverTally;
using oracle::find_uncovered;
using oracle::Point;
using oracle::Real;
using oracle::Triangle;

// Corners at whole distances: no rounding anywhere.
constexpr Triangle on_ball{Point{3, 4, 0}, Point{-3, 4, 0}, Point{0, 0, 5}};

TEST(Judge, proves_what_one_ball_holds_and_sees_it_shrink_by_little) {
  Dice dice(1);
  CoverTally tally;
  const std::vector<Triangle> facets{on_ball};
  EXPECT_FALSE(find_uncovered(facets, std::vector<Ball>{{{0, 0, 0}, 5}}, dice, tally));
  EXPECT_EQ(tally.proved, 1u);
  for (const Real less : {1e-3L, 1e-9L, 1e-15L}) {
    const auto uncovered = find_uncovered(facets, std::vector<Ball>{{{0, 0, 0}, 5 - less}}, dice, tally);
    ASSERT_TRUE(uncovered) << less;
    EXPECT_NEAR(static_cast<double>(uncovered->gap / less), 1, 1e-3);
  }
  EXPECT_FALSE(find_uncovered(facets, std::vector<Ball>{{{0, 0, 0}, 5 - 1e-18L}}, dice, tally)) << "what is allowed";
}

TEST(Judge, finds_a_hole_between_three_balls) {
  // Centers one away from the middle of a triangle: what they leave open there is as small as one likes.
  const Triangle facet{Point{-1, -0.5L, 0}, Point{1, -0.5L, 0}, Point{0, 0.9L, 0}};
  const Real s = std::sqrt(Real(3)) / 2;
  const auto balls = [&](Real radius) {
    return std::vector<Ball>{{{0, 1, 0}, radius}, {{s, -0.5L, 0}, radius}, {{-s, -0.5L, 0}, radius}};
  };
  for (const Real open : {1e-2L, 1e-4L, 1e-6L}) {
    Dice dice(2);
    CoverTally tally;
    const auto uncovered = find_uncovered(std::vector<Triangle>{facet}, balls(1 - open), dice, tally, {.cuts = 1000});
    ASSERT_TRUE(uncovered) << open;
    EXPECT_LE(uncovered->gap, open * 1.001L);
    EXPECT_LT(static_cast<double>(oracle::distance(uncovered->point, {0, 0, 0})), 10 * static_cast<double>(open));
    EXPECT_FALSE(find_uncovered(std::vector<Triangle>{facet}, balls(1 + open), dice, tally, {.cuts = 1000}));
  }
}

TEST(Judge, looks_at_segments_and_points) {
  Dice dice(3);
  CoverTally tally;
  const std::vector<Triangle> segment{{Point{0, 0, 0}, {4, 0, 0}, {0, 0, 0}}},
      dot{{Point{7, 0, 0}, {7, 0, 0}, {7, 0, 0}}};
  EXPECT_TRUE(find_uncovered(segment, std::vector<Ball>{{{0, 0, 0}, 1.99L}, {{4, 0, 0}, 2}}, dice, tally));
  EXPECT_FALSE(find_uncovered(segment, std::vector<Ball>{{{0, 0, 0}, 2}, {{4, 0, 0}, 2}}, dice, tally));
  EXPECT_TRUE(find_uncovered(dot, std::vector<Ball>{{{0, 0, 0}, 6.99L}}, dice, tally));
  EXPECT_TRUE(find_uncovered(dot, std::vector<Ball>{}, dice, tally)) << "no ball at all";
}

// Something to be judged: a body at rest, its numbers open to be changed.
struct Judged {
  Mesh mesh;
  CoveredTree model;
  Body body;
  std::vector<Sphere> spheres;
  explicit Judged(Mesh m, Method method = Method::octree)
      : mesh(std::move(m)), model(build(mesh, {.method = method, .branching = 8, .depth = 2})), body(mesh, model) {
    body.copy_spheres(spheres);
  }
  std::map<std::string, std::size_t> faults(std::vector<Ball> balls, std::uint64_t seed = 1) const {
    Record record("", false);
    record.begin(0, 0);
    Dice dice(seed);
    const std::vector<std::uint8_t> all(balls.size(), 1);
    judge({mesh, model.tree, model.cover, points_of(mesh.positions), balls, all}, dice, record);
    return record.failures();
  }
};

std::vector<Judged> specimens() {
  std::vector<Judged> all;
  all.emplace_back(test::icosphere(2));
  all.emplace_back(test::icosphere(1), Method::grid);
  all.emplace_back(test::mesh_named("facet_soup").mesh);
  all.emplace_back(test::mesh_named("three_pages").mesh);
  return all;
}

TEST(Judge, reports_any_sphere_that_is_smaller_or_gone) {
  for (const Judged& s : specimens()) {
    const std::vector<Ball> balls = balls_of(s.spheres);
    EXPECT_TRUE(s.faults(balls).empty());
    for (std::size_t node = 0; node < balls.size(); ++node) {
      std::vector<Ball> changed = balls;
      // Radii are the distance to the farthest corner, and 2^-20 of the body, which is about 1, on top.
      changed[node].radius *= 1 - 1e-4L;
      changed[node].radius -= 0x1p-18L;
      EXPECT_EQ(s.faults(changed).count("uncovered-region"), 1u) << "node " << node << " made smaller";
      changed[node].radius = -1;
      EXPECT_EQ(s.faults(changed).count("uncovered-region"), 1u) << "node " << node << " gone";
      changed[node].radius = std::numeric_limits<Real>::quiet_NaN();
      EXPECT_EQ(s.faults(changed).count("not-finite"), 1u) << "node " << node << " no number";
    }
    std::vector<Ball> root = balls;
    root[0].radius *= 1 - 1e-4L;
    EXPECT_EQ(s.faults(root).count("uncovered"), 1u) << "level 0 is its root";
  }
}

// Points by the thousand, in plain double: what these find uncovered, the judge has to.
bool seen_uncovered(const Judged& s, const std::vector<Ball>& balls, const std::vector<std::uint32_t>& level,
                    Dice& dice) {
  for (int n = 0; n < 20000; ++n) {
    const auto c = s.mesh.corners(dice.below(s.mesh.facet_count()));
    double v = dice.uniform(), w = dice.uniform();
    if (v + w > 1) v = 1 - v, w = 1 - w;
    const Vec3 p = c[0] + (c[1] - c[0]) * v + (c[2] - c[0]) * w;
    bool held = false;
    for (const std::uint32_t node : level) {
      const Vec3 center{static_cast<double>(balls[node].center.x), static_cast<double>(balls[node].center.y),
                        static_cast<double>(balls[node].center.z)};
      held = held || distance(p, center) <= static_cast<double>(balls[node].radius) + 1e-9;
    }
    if (!held) return true;
  }
  return false;
}

TEST(Judge, sees_uncovered_surface_wherever_thousands_of_points_do) {
  Dice dice(4);
  std::size_t uncovered = 0;
  for (const Judged& s : specimens()) {
    const auto leaves = level_sets(s.model.tree).back();
    for (int n = 0; n < 25; ++n) {
      std::vector<Ball> balls = balls_of(s.spheres);
      const std::uint32_t node = leaves[dice.below(leaves.size())];
      balls[node].radius *= dice.chance(0.5) ? -1 : static_cast<Real>(dice.uniform(0.5, 1));
      if (!seen_uncovered(s, balls, leaves, dice)) continue;
      ++uncovered;
      // By points of the surface alone, the proof by regions aside.
      CoverTally tally;
      std::vector<Ball> level;
      for (const std::uint32_t leaf : leaves) level.push_back(balls[leaf]);
      std::vector<Triangle> facets;
      const auto points = points_of(s.mesh.positions);
      for (const Facet& f : s.mesh.facets) facets.push_back({points[f[0]], points[f[1]], points[f[2]]});
      EXPECT_TRUE(find_uncovered(facets, level, dice, tally)) << "leaf " << node;
    }
  }
  EXPECT_GT(uncovered, 30u);
}

TEST(Judge, level_sets_are_those_of_the_library) {
  for (const Judged& s : specimens()) {
    const auto sets = level_sets(s.model.tree);
    ASSERT_EQ(sets.size(), s.model.tree.level_count());
    for (std::size_t level = 0; level < sets.size(); ++level) {
      auto nodes = sets[level];
      std::sort(nodes.begin(), nodes.end());
      EXPECT_EQ(nodes, level_set(s.model.tree, level));
    }
  }
}

TEST(Judge, misses_no_contact_that_is_taken_away) {
  const Judged s(test::icosphere(1)), t(test::box_mesh({0, 0, 0}, {1, 1, 1}, 2));
  const Collider a(s.mesh, s.body);
  Collider b(t.mesh, t.body);
  Dice dice(6);
  for (const bool turned : {false, true}) {
    if (turned) b.set_transform(RigidTransform::from_axis({1, 2, 3}, 0.7, {-0.2, 0.1, 0.3}));
    const PairJudge pair(a, b, dice);
    ASSERT_FALSE(pair.meetings().empty());
    const auto faults = [&](const Contacts& contacts, double margin) {
      Record record("", false);
      record.begin(0, 0);
      pair.judge_contacts(contacts, 0, margin, record, "");
      return record.failures();
    };
    const Contacts all = collide(a, b, {.margin = 1});
    EXPECT_TRUE(faults(all, 1).empty());
    Contacts none = all;
    none.contacts.clear();
    EXPECT_EQ(faults(none, 0).count("missed-contact"), 1u);
    EXPECT_EQ(faults(none, 1).count("missed-margin"), 1u);
    Contacts narrow = all;
    for (Contact& c : narrow.contacts) c.error_bound = 0;
    EXPECT_EQ(faults(narrow, 0).count("missed-contact"), 1u) << "none within its error bound";
    // Every contact but those that hold one meeting.
    const Meeting& m = pair.meetings()[pair.meetings().size() / 2];
    Contacts but_one = all;
    std::erase_if(but_one.contacts, [&](const Contact& c) {
      const auto in_a = a.facets(c.node_a), in_b = b.facets(c.node_b);
      return std::find(in_a.begin(), in_a.end(), m.facet_a) != in_a.end() &&
             std::find(in_b.begin(), in_b.end(), m.facet_b) != in_b.end();
    });
    EXPECT_EQ(faults(but_one, 0).count("missed-contact"), 1u);
  }
}

TEST(Judge, decides_lattices_exactly) {
  // Boxes side by side: they touch in a square, in facets of one plane.
  const Judged s(test::box_mesh({0, 0, 0}, {1, 1, 1})), t(test::box_mesh({1, 0, 0}, {2, 1, 1}));
  Dice dice(7);
  Collider a(s.mesh, s.body), b(t.mesh, t.body);
  const PairJudge touching(a, b, dice);
  EXPECT_TRUE(touching.exact());
  EXPECT_EQ(touching.meetings().size(), brute_force::crossings(a, b).size());
  EXPECT_GT(touching.meetings().size(), 4u);
  b.set_transform({.translation = {0x1p-16, 0, 0}});
  const PairJudge apart(a, b, dice);
  EXPECT_TRUE(apart.exact());
  EXPECT_TRUE(apart.meetings().empty());
}

TEST(Cases, are_repeated_by_their_number_alone) {
  Record once("", false), again("", false);
  Specimens kept;
  // What only new trees are asked is asked once of a tree that is kept, and each time of one that is made anew.
  for (std::uint64_t number = 0; number < 12; ++number) run_case(3, number, kept, once);
  for (std::uint64_t number = 12; number-- > 0;) {
    Specimens fresh;
    run_case(3, number, fresh, again);
  }
  EXPECT_EQ(once.counts.crossings, again.counts.crossings);
  EXPECT_EQ(once.counts.near_pairs, again.counts.near_pairs);
  EXPECT_EQ(once.counts.interruptions, again.counts.interruptions);
  EXPECT_GT(once.counts.frames, 12u);
}

}  // namespace
}  // namespace morula::properties
