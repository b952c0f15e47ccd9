// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// overlap() and collide() against brute force over spheres and over facets.
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <numbers>
#include <set>

#include "specimens.hpp"
#include "stale_pose.hpp"

namespace morula {
namespace {

using test::Specimen;

std::pair<std::uint32_t, std::uint32_t> nodes_of(const Contact& c) {
  return {c.node_a, c.node_b};
}

// In double, in the world: how far spheres of two nodes are apart; negative where they overlap.
double gap(const Collider& a, const Collider& b, std::uint32_t node_a, std::uint32_t node_b) {
  const Sphere s = a.sphere_state().sphere(node_a), t = b.sphere_state().sphere(node_b);
  return distance(a.transform()(s.center), b.transform()(t.center)) - s.radius - t.radius;
}

// A pair is to be found when it and all pairs above it overlap: by this much at the least.
bool reached(const Collider& a, const Collider& b, std::uint32_t node_a, std::uint32_t node_b, double margin) {
  const SphereTree &tree_a = a.tree(), &tree_b = b.tree();
  while (gap(a, b, node_a, node_b) <= margin) {
    if (node_a == 0 && node_b == 0) return true;
    const std::uint32_t level_a = tree_a.level_of(node_a), level_b = tree_b.level_of(node_b);
    if (level_a >= level_b) node_a = tree_a.parent[node_a];
    if (level_b >= level_a) node_b = tree_b.parent[node_b];
  }
  return false;
}

TEST(Collide, finds_the_pairs_of_brute_force_at_every_level_and_margin) {
  Random random(1);
  Specimen a("limb", 10, test::quick), b("torus", 9, {.method = Method::octree, .branching = 5, .depth = 4});
  std::size_t found = 0;
  for (int round = 0; round < 12; ++round) {
    a.deform(random, round == 0 ? 0 : 0.1);
    b.deform(random, round == 0 ? 0 : 0.1);
    a.set_transform(test::random_transform(random, 1));
    b.set_transform(test::random_transform(random, 1));
    const double margin = round % 3 == 2 ? 0.2 : 0;
    const std::optional<std::uint32_t> level =
        round % 4 == 3 ? std::optional(static_cast<std::uint32_t>(round / 4 + 1)) : std::nullopt;
    const Contacts contacts = collide(*a.collider, *b.collider, {.level = level, .margin = margin});
    EXPECT_TRUE(contacts.finished);
    EXPECT_EQ(contacts.finished_count, contacts.contacts.size());
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const Contact& c : contacts.contacts) EXPECT_TRUE(pairs.insert(nodes_of(c)).second) << "twice";

    const SphereTree &tree_a = a.body->rest_tree(), &tree_b = b.body->rest_tree();
    const auto set_of = [&](const SphereTree& tree) {
      const std::size_t deepest = tree.level_count() - 1;
      return level_set(tree, level ? std::min<std::size_t>(*level, deepest) : deepest);
    };
    const double pads = 1e-5 * (a.size + b.size);
    std::size_t unsure = 0, expected = 0;
    for (const std::uint32_t i : set_of(tree_a))
      for (const std::uint32_t j : set_of(tree_b)) {
        const bool surely = reached(*a.collider, *b.collider, i, j, margin);
        const bool perhaps = reached(*a.collider, *b.collider, i, j, margin + pads);
        const bool is_found = pairs.count({i, j}) > 0;
        expected += surely;
        unsure += surely != perhaps;
        if (surely) {
          EXPECT_TRUE(is_found) << i << ' ' << j;
        }
        if (!perhaps) {
          EXPECT_FALSE(is_found) << i << ' ' << j;
        }
      }
    EXPECT_LE(pairs.size(), expected + unsure);
    EXPECT_LE(unsure, 5 + expected / 100) << "the comparison says something";
    if (!level && margin == 0) {
      EXPECT_EQ(overlap(*a.collider, *b.collider), !pairs.empty());
    }
    found += pairs.size();
  }
  EXPECT_GT(found, 500u);
}

// Every crossing of facets lies in a contact's regions and within its error bound.
TEST(Collide, misses_no_crossing_of_deformed_bodies) {
  struct Case {
    double scale, away;
  };
  std::size_t crossings_seen = 0, poses_apart = 0;
  for (const Case& c : {Case{1, 0}, Case{1, 1e6}, Case{1e-9, 0}, Case{1e9, 0}}) {
    Random random(7);
    const Vec3 far = c.scale * c.away * Vec3{1, -0.5, 0.25};
    Specimen a("limb", 9, test::quick, c.scale, far), b("torus", 8, test::quick, c.scale);
    for (int pose = 0; pose < 25; ++pose) {
      a.deform(random, 0.1);
      b.deform(random, 0.1);
      RigidTransform place_a = test::random_transform(random, 1.8 * c.scale);
      place_a.translation += far - place_a.rotate(far);  // the mesh is far away, and so is the world
      a.set_transform(place_a);
      b.set_transform(test::random_transform(random, 0.1 * c.scale, 2.0 * far));
      const auto crossings = test::crossings_by_brute_force(*a.collider, *b.collider);
      crossings_seen += crossings.size();
      const Contacts contacts = collide(*a.collider, *b.collider);
      EXPECT_EQ(test::crossings_missed(crossings, *a.collider, *b.collider, contacts.contacts), 0u);
      const bool overlapping = overlap(*a.collider, *b.collider);
      EXPECT_EQ(overlapping, !contacts.contacts.empty());
      poses_apart += !overlapping;
      if (!crossings.empty()) {
        EXPECT_TRUE(overlapping);
      }
      const Contacts coarse = collide(*a.collider, *b.collider, {.level = 1});
      EXPECT_EQ(test::crossings_missed(crossings, *a.collider, *b.collider, coarse.contacts), 0u);
    }
  }
  EXPECT_GT(crossings_seen, 2000u);
  EXPECT_GT(poses_apart, 5u);
}

// With a margin, near facets without a crossing count: corners of one body as samples.
TEST(Collide, margin_reports_surfaces_that_are_near) {
  Random random(11);
  Specimen a("blob", 8, test::quick), b("bar", 6, test::quick);
  const double margin = 0.3;
  std::size_t near = 0;
  for (int pose = 0; pose < 20; ++pose) {
    a.deform(random, 0.03);
    a.set_transform(test::random_transform(random, 2));
    b.set_transform(test::random_transform(random, 2));
    const Contacts contacts = collide(*a.collider, *b.collider, {.margin = margin});
    for (std::uint32_t v = 0; v < a.mesh.vertex_count(); ++v)
      for (std::uint32_t w = 0; w < b.mesh.vertex_count(); ++w) {
        const Vec3 p = a.collider->vertex(v), q = b.collider->vertex(w);
        if (distance(p, q) > margin) continue;
        ++near;
        const Vec3 middle = 0.5 * (p + q);
        const auto has = [](const Specimen& s, std::uint32_t node, std::uint32_t vertex) {
          for (const std::uint32_t f : s.collider->facets(node))
            for (const std::uint32_t corner : s.mesh.facets[f])
              if (corner == vertex) return true;
          return false;
        };
        EXPECT_TRUE(std::any_of(contacts.contacts.begin(), contacts.contacts.end(), [&](const Contact& c) {
          return distance(middle, c.point) <= c.error_bound && has(a, c.node_a, v) && has(b, c.node_b, w);
        }));
      }
  }
  EXPECT_GT(near, 30u);
}

// Of hand-made spheres: bodies whose root is their only sphere.
struct Balls : ::testing::Test {
  Balls()
      : a("blob", 6, {.method = Method::octree, .depth = 0}),
        b("blob", 6, {.method = Method::octree, .depth = 0}, 0.5) {
    radius_a = a.body->sphere(0).radius;
    radius_b = b.body->sphere(0).radius;
  }
  // b's center at p from a's; a turned, too.
  Contact at(const Vec3& p, double margin = 0) {
    const RigidTransform turn = RigidTransform::from_axis({1, 1, 0}, 0.5, {5, 6, 7});
    a.set_transform(turn);
    RigidTransform place = RigidTransform::from_axis({0, 1, 1}, 2);
    const Vec3 wanted = turn(a.body->sphere(0).center) + p;
    place.translation = wanted - place(b.body->sphere(0).center);
    b.set_transform(place);
    center_a = turn(a.body->sphere(0).center);
    const Contacts contacts = collide(*a.collider, *b.collider, {.margin = margin});
    count = contacts.contacts.size();
    return count == 0 ? Contact{} : contacts.contacts.front();
  }
  Specimen a, b;
  double radius_a, radius_b;
  Vec3 center_a;
  std::size_t count = 0;
};

TEST_F(Balls, contact_is_the_middle_of_the_overlap) {
  const Vec3 direction = normalized(Vec3{1, -2, 0.5});
  const double apart = 0.8 * (radius_a + radius_b);
  const Contact c = at(apart * direction);
  ASSERT_EQ(count, 1u);
  EXPECT_TRUE(c.finished);
  EXPECT_LT(distance(c.normal, -direction), 1e-6) << "from b to a";
  EXPECT_NEAR(c.depth, radius_a + radius_b - apart, 1e-6);
  EXPECT_LT(distance(c.point, center_a + (radius_a - 0.5 * c.depth) * direction), 1e-6);

  // The lens by slices, and the farthest point of its rim.
  double volume = 0;
  const int slices = 20000;
  for (int i = 0; i < slices; ++i) {
    const double x = apart - radius_b + (i + 0.5) * c.depth / slices;
    volume += std::numbers::pi * c.depth / slices *
              std::min(radius_a * radius_a - x * x, radius_b * radius_b - (x - apart) * (x - apart));
  }
  EXPECT_NEAR(c.lens_volume, volume, 1e-5 * volume);
  const double rim = (apart * apart + radius_a * radius_a - radius_b * radius_b) / (2 * apart);
  const double bound = std::hypot(std::sqrt(radius_a * radius_a - rim * rim), rim - (radius_a - 0.5 * c.depth));
  EXPECT_NEAR(c.error_bound, bound, 1e-4 * bound);
  EXPECT_GE(c.error_bound, bound);
}

TEST_F(Balls, one_inside_the_other_counts_as_deep_as_the_smaller_is_wide) {
  const Vec3 p = 0.3 * (radius_a - radius_b) * Vec3{0, 0, 1};
  const Contact c = at(p);
  ASSERT_EQ(count, 1u);
  EXPECT_DOUBLE_EQ(c.depth, 2 * radius_b);
  EXPECT_LT(distance(c.point, center_a + p), 1e-12);
  EXPECT_LT(distance(c.normal, Vec3{0, 0, -1}), 1e-5);
  EXPECT_NEAR(c.error_bound, radius_b, 1e-4 * radius_b);
  EXPECT_NEAR(c.lens_volume, volume(Sphere{{}, radius_b}), 1e-12);
}

TEST_F(Balls, centers_that_coincide_have_a_normal) {
  const Contact c = at({});
  ASSERT_EQ(count, 1u);
  EXPECT_EQ(c.normal, (Vec3{1, 0, 0}));
  EXPECT_DOUBLE_EQ(c.depth, 2 * radius_b);
}

TEST_F(Balls, a_gap_within_the_margin_is_a_negative_depth) {
  const double apart = radius_a + radius_b + 0.1;
  EXPECT_EQ((at({apart, 0, 0}), count), 0u);
  EXPECT_EQ((at({apart, 0, 0}, 0.09), count), 0u);
  const Contact c = at({apart, 0, 0}, 0.11);
  ASSERT_EQ(count, 1u);
  EXPECT_NEAR(c.depth, -0.1, 1e-6);
  EXPECT_EQ(c.lens_volume, 0);
  EXPECT_LT(distance(c.point, center_a + Vec3{radius_a + 0.05, 0, 0}), 1e-6);
}

TEST(Collide, facets_are_the_nearest_of_the_nodes) {
  Random random(5);
  Specimen a("limb", 8, test::quick), b("torus", 8, test::quick);
  a.deform(random, 0.05);
  a.set_transform(RigidTransform::from_axis({1, 2, 3}, 1, {0.2, 0.3, 0}));
  const Contacts contacts = collide(*a.collider, *b.collider, {.surfaces = true});
  ASSERT_EQ(contacts.surfaces.size(), contacts.contacts.size());
  ASSERT_GT(contacts.contacts.size(), 10u);
  const auto check = [](const Collider& c, std::uint32_t node, const Vec3& point, const SurfacePoint& found) {
    double least = std::numeric_limits<double>::infinity();
    bool owned = false;
    for (const std::uint32_t f : c.facets(node)) {
      least = std::min(least, closest_point(c.triangle(f), point).squared_distance);
      owned = owned || f == found.facet;
    }
    EXPECT_TRUE(owned);
    EXPECT_NEAR(distance(found.point, point), std::sqrt(least), 1e-9);
    EXPECT_LT(distance(found.point, at_barycentric(c.triangle(found.facet), found.barycentric)), 1e-9);
  };
  for (std::size_t i = 0; i < contacts.contacts.size(); ++i) {
    const Contact& c = contacts.contacts[i];
    check(*a.collider, c.node_a, c.point, contacts.surfaces[i].on_a);
    check(*b.collider, c.node_b, c.point, contacts.surfaces[i].on_b);
  }
}

TEST(Collide, refuses_bad_options_and_bodies_and_changes_nothing) {
  Specimen a("blob", 6, test::quick), b("blob", 6, test::quick);
  ContactQuery query;
  query.add(*a.collider, *b.collider);
  ASSERT_TRUE(query.run());
  const Contacts& contacts = query.contacts();
  ASSERT_FALSE(contacts.contacts.empty());
  const std::size_t count = contacts.contacts.size(), tests = contacts.pair_tests;
  const auto refused = [&](const CollideOptions& options) {
    EXPECT_THROW(static_cast<void>(collide(*a.collider, *b.collider, options)), std::invalid_argument);
    try {
      query.set_options(options);
      EXPECT_FALSE(query.run());
    } catch (const std::invalid_argument&) {
    }
    EXPECT_EQ(contacts.contacts.size(), count);
    EXPECT_EQ(contacts.pair_tests, tests);
  };
  refused({.margin = -1});
  refused({.margin = std::numeric_limits<double>::quiet_NaN()});
  refused({.margin = std::numeric_limits<double>::infinity()});
  refused({.level = 4});
  refused({.budget = -1});
  refused({.budget = std::chrono::microseconds(-5)});
  std::vector<Vec3> bad = a.positions;
  bad[a.mesh.facets[0][0]].x = std::numeric_limits<double>::infinity();
  EXPECT_NO_THROW(static_cast<void>(collide(*a.collider, *b.collider, {.surfaces = true})));
  test::StalePose late(a.mesh, a.model.cover, a.body->sphere_state());
  EXPECT_NO_THROW(static_cast<void>(collide(late.collider, *b.collider)));
  EXPECT_THROW(static_cast<void>(collide(late.collider, *b.collider, {.surfaces = true})), std::invalid_argument);
  ASSERT_FALSE(a.body->update(bad));
  refused({});
  EXPECT_THROW(overlap(*a.collider, *b.collider), std::invalid_argument);
  EXPECT_THROW(overlap(*b.collider, *a.collider), std::invalid_argument);
}

// Numbers at the end of the range: an answer that is right, not a trap.
TEST(Collide, answers_far_beyond_the_range_of_float) {
  Specimen a("blob", 6, test::quick), b("blob", 6, test::quick);
  for (const double far : {1e18, 1e30, 1e60, 1e300}) {
    a.set_transform({{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}, {far, -far, far}});
    b.set_transform({});
    if (far < 1e30) {
      EXPECT_FALSE(overlap(*a.collider, *b.collider)) << far;
    }
    b.set_transform(a.collider->transform());
    EXPECT_TRUE(overlap(*a.collider, *b.collider)) << far;
    EXPECT_FALSE(collide(*a.collider, *b.collider).contacts.empty());
  }
}

}  // namespace
}  // namespace morula
