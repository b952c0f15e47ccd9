// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Every allowance of a pair test at its limit: spheres that touch, in real numbers or nearly, where rounding says that
// they do not. scripts/mutants takes the allowances away, one after the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/geometry/reproducible.hpp>
#include <set>
#include <string>
#include <utility>

#include "collide/pairs/pair_kernels.hpp"
#include "collide/pairs/placed_pair.hpp"
#include "collide/pairs/tree_pair.hpp"
#include "one_facet.hpp"
#include "specimens.hpp"
#include "update/points/rounding.hpp"

namespace morula {
using namespace detail;
namespace {

using Wide = Vector3<long double>;
constexpr double e = 0x1p-24;  // half a unit in the last place of a float

Vec3 random_vector(Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  return {x, y, random.uniform(-1, 1)};
}

// Between c_a and M c_b + u.
long double real_distance(const RigidTransform& relative, const Vec3f& a, const Vec3f& b) {
  const Wide c(b);
  Wide moved(relative.translation);
  for (int axis = 0; axis < 3; ++axis) moved[axis] += dot(Wide(relative.rows[static_cast<std::size_t>(axis)]), c);
  return length(Wide(a) - moved);
}
// Least float that is not below.
float radius_to(long double distance) {
  float radius = static_cast<float>(distance);
  while (static_cast<long double>(radius) < distance) radius = std::nextafter(radius, 1e30f);
  return radius;
}
// By every kernel.
bool overlap_surely(const RigidTransform& relative, const Spheref& a, const Spheref& b) {
  const NarrowPair pair = placed_pair(relative, 0, 0).narrow;
  bool all = true;
  for (const PairKernels& kernels : all_pair_kernels()) {
    std::uint64_t mask = 0;
    kernels.test(pair, {&a, 1, 1, &b, 1, 1}, &mask);
    all = all && mask == 1;
  }
  return all;
}

// Coordinates of the translation lie half a unit above 1, and so do both halves of a row's product: each of the three
// is rounded away, on every axis.
TEST(PairAllowance, pays_for_narrowing_the_translation_and_for_sums_with_it) {
  Random random(1);
  int tested = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    RigidTransform relative = test::random_transform(random, 0);
    const double half = e * (1 - 0x1p-20);
    relative.translation = {1 + half, 1 + half, 1 + half};
    const double wanted = 2 * e * random.uniform(0.8, 1);
    const Vec3f b(relative.inverse_rotate(Vec3{wanted, wanted, wanted}));
    for (const float step : {2.0f, 3.0f, 4.0f, 6.0f}) {
      const float at = 1 + step * 0x1p-23f;
      const Vec3f a{at, at, at};
      const Spheref sphere_a{a, radius_to(real_distance(relative, a, b))};
      ASSERT_TRUE(overlap_surely(relative, sphere_a, {b, 0})) << "trial " << trial;
      ++tested;
    }
  }
  EXPECT_GT(tested, 1000);
}

TEST(PairAllowance, pays_for_moving_centers) {
  Random random(2);
  for (int trial = 0; trial < 100000; ++trial) {
    const RigidTransform relative = test::random_transform(random, 0);
    const Vec3f b(random_vector(random));
    const Vec3f a(relative.rotate(Vec3(b)) + 4 * e * random_vector(random));
    ASSERT_TRUE(overlap_surely(relative, {a, radius_to(real_distance(relative, a, b))}, {b, 0})) << "trial " << trial;
  }
}

TEST(PairAllowance, pays_for_distances_and_squares) {
  Random random(3);
  const RigidTransform still;
  for (int trial = 0; trial < 50000; ++trial) {
    const Vec3f a(normalized(random_vector(random)) * random.uniform(1.4, 1.5));
    const float radius = radius_to(real_distance(still, a, {}));
    ASSERT_TRUE(overlap_surely(still, {a, radius}, {{}, 0})) << "trial " << trial;
    ASSERT_TRUE(overlap_surely(still, {a, 0}, {{}, radius})) << "trial " << trial;
  }
}

// Of the body that is moved: what is allowed for its center does not pay for its radius.
TEST(PairAllowance, pays_for_rotations_that_are_not_quite_rigid) {
  Random random(4);
  for (int trial = 0; trial < 20000; ++trial) {
    RigidTransform relative = test::random_transform(random, 0);
    const Vec3f a(random_vector(random));
    const float radius = radius_to(real_distance(relative, a, {}) * (1 - 3e-9L));
    ASSERT_TRUE(overlap_surely(relative, {a, 0}, {{}, radius})) << "trial " << trial;
  }
}

TEST(PairAllowance, pays_for_squares_that_underflow) {
  Random random(5);
  for (const double size : {0x1p-68, 0x1p-72, 0x1p-74, 0x1p-75, 0x1p-76})
    for (int trial = 0; trial < 5000; ++trial) {
      const RigidTransform relative = test::random_transform(random, size);
      const Vec3f a(random_vector(random) * size), b(random_vector(random) * size);
      ASSERT_TRUE(overlap_surely(relative, {a, radius_to(real_distance(relative, a, b))}, {b, 0})) << size;
    }
}

// Bodies of one facet and one sphere.
struct OneFacet {
  explicit OneFacet(const Triangle& corners, UpdateOptions options = {})
      : mesh{{corners.begin(), corners.end()}, {{0, 1, 2}}},
        body(mesh, test::one_facet_model(), std::move(options)),
        collider(mesh, body) {}
  Mesh mesh;
  Body body;
  Collider collider;
};

// Where a unit in the last place is as large as the bodies: vertices in the world are rounded by half of it, away from
// where the spheres are. Two of them are one point.
TEST(PairAllowance, pays_for_vertices_that_are_rounded_far_from_the_origin) {
  constexpr double away = 0x1.8p30, unit = 0x1p-22;
  const double x = 0.51 * unit;
  OneFacet a({Vec3{x, x, x}, Vec3{-x, -x, -x}, Vec3{x, -x, 0}}), b({Vec3{x, x, x}, Vec3{-x, -x, -x}, Vec3{x, -x, 0}});
  for (const double sign : {1.0, -1.0}) {
    const double near = sign * away, far = near + 2 * unit;
    a.collider.set_transform({.translation = {near, near, near}});
    b.collider.set_transform({.translation = {far, far, far}});
    ASSERT_EQ(a.collider.triangle(0)[0], b.collider.triangle(0)[1]);
    EXPECT_TRUE(overlap(a.collider, b.collider));
    EXPECT_TRUE(overlap(b.collider, a.collider));
  }
}

// Fronts.

std::set<std::pair<std::uint32_t, std::uint32_t>> pairs_of(const Contacts& contacts) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const Contact& c : contacts.contacts) pairs.insert({c.node_a, c.node_b});
  return pairs;
}

// Contacts of two bodies carried from frame to frame, beside those found anew in each.
struct CarriedAndFresh {
  CarriedAndFresh(const test::Specimen& a, const test::Specimen& b) {
    for (ContactQuery* query : {&carried, &fresh}) query->add(*a.collider, *b.collider);
    EXPECT_TRUE(carried.start());
    at_first = pairs_of(carried.contacts());
  }
  // After the bodies have moved.
  void expect_the_same() {
    ASSERT_TRUE(carried.carry());
    ASSERT_TRUE(fresh.start());
    ASSERT_EQ(pairs_of(carried.contacts()), pairs_of(fresh.contacts()));
  }
  bool have_changed() const { return at_first != pairs_of(fresh.contacts()); }

  ContactQuery carried, fresh;
  std::set<std::pair<std::uint32_t, std::uint32_t>> at_first;
};

// How far along a direction two spheres still touch, or a little more: between `in`, where they do, and `out`. What
// `place_at` gets is that way.
template <class PlaceAt>
double way_to_separation(const test::Specimen& a, const test::Specimen& b, std::uint32_t node_a, std::uint32_t node_b,
                         double in, double out, const PlaceAt& place_at) {
  for (int step = 0; step < 50; ++step) {
    const double middle = 0.5 * (in + out);
    place_at(middle);
    (TreePair(*a.collider, *b.collider, 0, leaf_level).overlaps(node_a, node_b) ? in : out) = middle;
  }
  return out;
}

// Two leaves within a little of touching, the bodies moved by as little in a few steps, the first of which change
// nothing: a carried front says what a fresh one says.
void expect_the_contacts_of_a_fresh_front(double little, int rounds, std::uint64_t seed) {
  const BuildOptions options{.method = Method::octree, .depth = 1};
  test::Specimen a("blob", 5, options), b("limb", 5, options);
  Random random(seed);
  const auto count_a = a.body->spheres().size(), count_b = b.body->spheres().size();
  std::size_t changed = 0;
  for (int round = 0; round < rounds; ++round) {
    const auto node_a = static_cast<std::uint32_t>(1 + random.next() % (count_a - 1));
    const auto node_b = static_cast<std::uint32_t>(1 + random.next() % (count_b - 1));
    RigidTransform place = test::random_transform(random, 0);
    const Vec3 direction = normalized(random_vector(random));
    const Sphere sphere_a = a.body->sphere(node_a), sphere_b = b.body->sphere(node_b);
    const Vec3 start = sphere_a.center - place.rotate(sphere_b.center);
    const auto place_at = [&](double way) {
      place.translation = start + direction * way;
      b.set_transform(place);
    };
    const double radii = sphere_a.radius + sphere_b.radius;
    const double far = way_to_separation(a, b, node_a, node_b, 0.9 * radii, 1.1 * radii, place_at);
    const double unit = little * a.size;
    double way = far + random.uniform(0, 6) * unit;
    place_at(way);
    CarriedAndFresh contacts(a, b);
    const int steps = 1 + round % 3;
    const double step = random.uniform(0, 1.2) * (way - far + unit) / steps;
    for (int k = 0; k < steps; ++k) {
      SCOPED_TRACE("round " + std::to_string(round) + ", step " + std::to_string(k));
      place_at(way -= step);
      contacts.expect_the_same();
      if (testing::Test::HasFatalFailure()) return;
    }
    changed += contacts.have_changed();
  }
  EXPECT_GT(changed, 50u);
}

// Whether a verdict changes hangs on rounding alone.
TEST(FrontAllowance, pays_for_verdicts_that_rounding_alone_decides) {
  expect_the_contacts_of_a_fresh_front(e, 1500, 6);
}

// A body's origin goes with one of its vertices. Where that one leaves, the coordinates of all others grow, and with
// them what a test allows for moving them: verdicts change that no travel accounts for.
TEST(FrontAllowance, pays_for_coordinates_that_grow_since) {
  const BuildOptions options{.method = Method::octree, .depth = 2};
  test::Specimen a("blob", 5, options), b("limb", 5, options);
  Random random(8);
  const std::vector<Vec3> near = b.positions;
  std::vector<Vec3> away = near;
  const auto pose = [&](const std::vector<Vec3>& positions) {
    ASSERT_TRUE(b.body->update(positions));
    b.collider->set_positions(positions);
  };
  for (std::size_t guide = 0; guide < near.size(); ++guide) {
    away = near;
    away[guide] += Vec3{2000 * b.size, 1000 * b.size, 500 * b.size};
    pose(near);
    const Vec3 origin = b.collider->sphere_state().origin;
    pose(away);
    if (length(b.collider->sphere_state().origin - origin) > 100 * b.size) break;
  }
  const auto leaves = [](const test::Specimen& s) {
    const SphereTree& tree = s.model.tree;
    return std::pair{tree.level_begin[2], tree.level_begin[3]};
  };
  const auto [first_a, end_a] = leaves(a);
  const auto [first_b, end_b] = leaves(b);
  std::size_t changed = 0;
  for (int round = 0; round < 400; ++round) {
    const auto node_a = static_cast<std::uint32_t>(first_a + random.next() % (end_a - first_a));
    const auto node_b = static_cast<std::uint32_t>(first_b + random.next() % (end_b - first_b));
    RigidTransform place = test::random_transform(random, 0);
    const Vec3 direction = normalized(random_vector(random));
    pose(near);
    const Vec3 start = a.body->sphere(node_a).center - place.rotate(b.body->sphere(node_b).center);
    const auto place_at = [&](double way) {
      place.translation = start + direction * way;
      b.set_transform(place);
    };
    const double before = way_to_separation(a, b, node_a, node_b, 0, 3 * a.size, place_at);
    pose(away);
    const double after = way_to_separation(a, b, node_a, node_b, 0, 3 * a.size, place_at);
    if (!(before < after)) continue;
    place_at(before + (after - before) * random.uniform(0.5, 1));
    pose(near);
    SCOPED_TRACE("round " + std::to_string(round));
    CarriedAndFresh contacts(a, b);
    pose(away);
    contacts.expect_the_same();
    if (testing::Test::HasFatalFailure()) return;
    changed += contacts.have_changed();
  }
  EXPECT_GT(changed, 100u);
}

// What has come back from far away has traveled so far that a short way is nothing beside it; and yet contacts change
// on short ways. Either body may be the one that was away.
TEST(FrontAllowance, counts_short_ways_after_long_ones) {
  const BuildOptions options{.method = Method::octree, .depth = 1};
  test::Specimen a("blob", 5, options), b("limb", 5, options);
  Random random(9);
  const auto moved_by = [](const std::vector<Vec3>& positions, double far) {
    std::vector<Vec3> moved = positions;
    for (Vec3& p : moved) p += Vec3{far, 0, 0};
    return moved;
  };
  std::size_t changed = 0;
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    test::Specimen& traveler = round % 2 == 0 ? a : b;
    RigidTransform place = test::random_transform(random, 0);
    const auto node_a = static_cast<std::uint32_t>(1 + random.next() % (a.body->spheres().size() - 1));
    const auto node_b = static_cast<std::uint32_t>(1 + random.next() % (b.body->spheres().size() - 1));
    const Vec3 start = a.body->sphere(node_a).center - place.rotate(b.body->sphere(node_b).center);
    const Vec3 direction = normalized(random_vector(random));
    const double radii = a.body->sphere(node_a).radius + b.body->sphere(node_b).radius;
    const auto place_at = [&](double way) {
      place.translation = start + direction * way;
      b.set_transform(place);
    };
    const auto pose = [](test::Specimen& s, const std::vector<Vec3>& positions) {
      ASSERT_TRUE(s.body->update(positions));
      s.collider->set_positions(positions);
    };
    place_at(1.2 * radii);
    CarriedAndFresh contacts(a, b);
    const std::vector<Vec3> far = moved_by(traveler.positions, traveler.size * std::exp2(random.uniform(20, 50)));
    pose(traveler, far);
    contacts.expect_the_same();
    pose(traveler, traveler.positions);
    contacts.expect_the_same();
    for (double way = 1.2; way > 0.8; way -= 0.02) {
      place_at(way * radii);
      contacts.expect_the_same();
      if (testing::Test::HasFatalFailure()) return;
    }
    changed += contacts.have_changed();
  }
  EXPECT_GT(changed, 100u);
}

TEST(FrontAllowance, a_clearance_is_no_longer_than_the_way_to_the_next_contact) {
  expect_the_contacts_of_a_fresh_front(1e-3, 600, 7);
}

}  // namespace
}  // namespace morula
