// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds of distances and placed spheres at their limit, judged in extended precision without any tolerance.
// scripts/mutants takes their allowances away, one after the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <morula/collide/distance.hpp>
#include <morula/collide/primitives.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>

#include "collide/facets/world_facets.hpp"
#include "collide/pairs/placed_spheres.hpp"
#include "geometry/nearest_pair.hpp"
#include "geometry/slab.hpp"
#include "one_facet.hpp"
#include "placed_bodies.hpp"

namespace morula {
using namespace detail;
namespace {

using Wide = Vector3<long double>;

long double real_distance(const Vec3& p, const Vec3& q) {
  return length(Wide(p) - Wide(q));
}
Vec3 random_vector(Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  return {x, y, random.uniform(-1, 1)};
}
Triangle random_triangle(Random& random, double size, const Vec3& about) {
  return {about + size * random_vector(random), about + size * random_vector(random),
          about + size * random_vector(random)};
}

// The distance of two triangles that do not meet, feature by feature, in extended precision.
long double to_segment(const Wide& x, const Wide& p, const Wide& q) {
  const Wide d = q - p;
  const long double s = std::clamp(dot(x - p, d) / dot(d, d), 0.0L, 1.0L);
  return length(x - (p + d * s));
}
long double to_triangle(const Wide& x, const Wide& a, const Wide& b, const Wide& c) {
  const Wide n = cross(b - a, c - a);
  const bool above =
      dot(cross(b - a, n), x - a) <= 0 && dot(cross(c - b, n), x - b) <= 0 && dot(cross(a - c, n), x - c) <= 0;
  const long double least = std::min({to_segment(x, a, b), to_segment(x, b, c), to_segment(x, c, a)});
  return above ? std::min(least, std::abs(dot(n, x - a)) / length(n)) : least;
}
long double of_segments(const Wide& p, const Wide& q, const Wide& r, const Wide& s) {
  long double best = std::min({to_segment(p, r, s), to_segment(q, r, s), to_segment(r, p, q), to_segment(s, p, q)});
  const Wide d = q - p, f = s - r, w = r - p, n = cross(d, f);
  const long double square = dot(n, n);
  if (square > 0) {
    const long double t = dot(cross(w, f), n) / square, u = dot(cross(w, d), n) / square;
    if (t >= 0 && t <= 1 && u >= 0 && u <= 1) best = std::min(best, std::abs(dot(w, n)) / std::sqrt(square));
  }
  return best;
}
long double real_distance(const Triangle& a, const Triangle& b) {
  long double best = std::numeric_limits<long double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    best = std::min(best, to_triangle(Wide(a[i]), Wide(b[0]), Wide(b[1]), Wide(b[2])));
    best = std::min(best, to_triangle(Wide(b[i]), Wide(a[0]), Wide(a[1]), Wide(a[2])));
    for (std::size_t j = 0; j < 3; ++j)
      best = std::min(best, of_segments(Wide(a[i]), Wide(a[(i + 1) % 3]), Wide(b[j]), Wide(b[(j + 1) % 3])));
  }
  return best;
}

// Near and far from the origin, far apart and nearly touching: the extended judge is a thousandth as coarse as what
// doubles allow for.
TEST(NearestPairAllowance, bounds_hold_to_the_last_bit) {
  Random random(1);
  int apart = 0;
  for (int round = 0; round < 40000; ++round) {
    const Vec3 about = round % 3 == 2 ? 1e3 * random_vector(random) : Vec3{};
    const double gap = round % 2 == 0 ? 3 : 1e-6;
    const Triangle a = random_triangle(random, 1, about);
    Triangle b = random_triangle(random, 1, about);
    // Pushed along z until they are `uncovered_distance` apart on it.
    double top = -1e300, bottom = 1e300;
    for (int k = 0; k < 3; ++k) top = std::max(top, a[k].z), bottom = std::min(bottom, b[k].z);
    for (Vec3& p : b) p.z += top - bottom + gap;
    const long double expected = real_distance(a, b);
    const NearestPair found = nearest_pair(a, b);
    ASSERT_FALSE(found.crossing);
    ASSERT_LE(found.lower, expected) << round;
    ASSERT_GE(found.upper, expected) << round;
    ++apart;
  }
  EXPECT_GT(apart, 1000);
}

// The same answer, at every distance about the one where it changes.
TEST(NearestPairAllowance, is_within_what_its_upper_bound_is_within) {
  Random random(6);
  int within = 0, beyond = 0, crossing = 0;
  const auto whole = [&](double most) { return std::floor(random.uniform(-most, most + 1)); };
  for (int round = 0; round < 30000; ++round) {
    const double size = std::array{1.0, 0x1p-80, 0x1p-210, 0x1p70}[round / 5 % 4];
    const Vec3 about = round % 7 == 0 ? size * 0x1p40 * random_vector(random) : Vec3{};
    Triangle a = random_triangle(random, size, about), b = random_triangle(random, size, about);
    // On a grid, and needles, points and what lies in one plane.
    if (round % 5 == 1)
      for (Triangle* t : {&a, &b})
        for (Vec3& p : *t) p = size * Vec3{whole(2), whole(2), whole(1)};
    if (round % 5 == 2) b[2] = b[1] + 1e-9 * (b[1] - b[0]);
    if (round % 5 == 3) b[1] = b[2] = b[0];
    if (round % 5 == 4)
      for (Triangle* t : {&a, &b})
        for (Vec3& p : *t) p.z = about.z;
    const NearestPair nearest = nearest_pair(a, b);
    const double upper = nearest.upper;
    for (const double distance :
         {0.0, upper, std::nextafter(upper, 0.0), std::nextafter(upper, 2 * upper + 1), 0.5 * upper, 2 * upper,
          0.1 * size, size, 100 * size, upper * (1 + 0x1p-42), upper * (1 - 0x1p-42)}) {
      const bool expected = upper <= distance;
      ASSERT_EQ(are_within(a, b, distance), expected) << round << ' ' << upper << ' ' << distance;
      (expected ? within : beyond) += 1;
      crossing += nearest.crossing ? 1 : 0;
    }
  }
  EXPECT_GT(within, 10000);
  EXPECT_GT(beyond, 10000);
  EXPECT_GT(crossing, 10000);
}

// Corners alone, and directions of any length: no other allowance is in the way.
TEST(NearestPairAllowance, of_points_is_rounded_up_and_a_slab_between_them_down) {
  Random random(2);
  for (int round = 0; round < 40000; ++round) {
    const Vec3 p = random_vector(random), q = random_vector(random);
    const Triangle point{q, q, q};
    const long double expected = real_distance(p, q);
    const NearestPair found = nearest_pair(std::span(&p, 1), point);
    ASSERT_GE(found.upper, expected) << round;
    ASSERT_LE(found.lower, expected) << round;
    const Vec3 direction = q - p;
    ASSERT_LE(slab_width(std::span(&p, 1), std::span(&q, 1), p, direction), expected) << round;
    // Seen from elsewhere, where differences are large and their difference small.
    const Vec3 from = 100.0 * random_vector(random);
    const Wide d(direction);
    ASSERT_LE(slab_width(std::span(&p, 1), std::span(&q, 1), from, direction), dot(d, Wide(q) - Wide(p)) / length(d));
  }
}

TEST(SlabAllowance, ends_are_not_inside_and_what_is_as_far_is_not_farther) {
  Random random(3);
  for (int round = 0; round < 40000; ++round) {
    const Vec3 from = random_vector(random), to = random_vector(random), direction = to - from;
    const Slab slab(from, direction);
    const Vec3 along = Slab::ordinary(direction);
    const Vec3 p = random_vector(random);
    const long double reach = dot(Wide(along), Wide(p) - Wide(from));
    ASSERT_GE(slab.end({p, p, p}, 1), reach) << round;
    ASSERT_GE(slab.end({p, p, p}, -1), -reach) << round;
    // The two points that made the slab are as far apart along it as they are.
    const long double square = dot(Wide(direction), Wide(direction));
    ASSERT_GE(slab.width(static_cast<double>(std::sqrt(square)) * (1 + 0x1p-53)),
              dot(Wide(along), Wide(direction)) * (1 - 0x1p-60L))
        << round;
  }
}

TEST(GapAllowance, is_below_every_distance_of_two_spheres) {
  Random random(4);
  for (int round = 0; round < 40000; ++round) {
    const bool deep = round % 2 == 0;
    const Sphere a{random_vector(random), deep ? random.uniform(1, 2) : 0.0};
    const Sphere b{deep ? a.center : random_vector(random), deep ? random.uniform(1, 2) : 0.0};
    const long double gap =
        real_distance(a.center, b.center) - static_cast<long double>(a.radius) - static_cast<long double>(b.radius);
    ASSERT_LE(gap_below(a, b), gap) << round;
  }
}

TEST(FacetSphereAllowance, contains_its_corners) {
  Random random(5);
  for (int round = 0; round < 40000; ++round) {
    const Triangle t = random_triangle(random, 1, {});
    const Sphere s = sphere_about(t);
    for (const Vec3& p : t) ASSERT_LE(real_distance(s.center, p), static_cast<long double>(s.radius)) << round;
  }
}

// The first upper bound of a query is the distance of two corners, rounded up.
TEST(DistanceAllowance, of_the_first_witnesses_is_rounded_up) {
  test::PlacedBody a(sample_body("limb", 8)), b(sample_body("torus", 8));
  Random random(6);
  for (int round = 0; round < 2000; ++round) {
    a.collider.set_transform(test::random_transform(random, 3));
    b.collider.set_transform(test::random_transform(random, 3));
    const DistanceBounds found = distance(a.collider, b.collider, {.budget = 0});
    const long double apart = real_distance(found.a.point, found.b.point);
    ASSERT_GE(found.upper, apart) << round;
    ASSERT_LE(found.upper, apart * (1 + 0x1p-48L)) << round;
    EXPECT_EQ(found.a.point, a.collider.triangle(found.a.facet)[0]);
    EXPECT_EQ(found.b.point, b.collider.triangle(found.b.facet)[0]);
  }
}

// A modal body, whose radii are as good as double allows, of a triangle that reaches its sphere but for a little.
struct OneFacet {
  explicit OneFacet(const Triangle& corners, bool modal)
      : mesh{{corners.begin(), corners.end()}, {{0, 1, 2}}},
        body(mesh, test::one_facet_model(), options(modal)),
        collider(mesh, body) {}
  static UpdateOptions options(bool modal) {
    if (!modal) return {};
    return {.rules = {Rule::modal},
            .modes = {.vertex_count = 3, .mode_count = 1, .displacements = std::vector<Vec3>(3)}};
  }
  void expect_inside() const {
    const Sphere sphere = PlacedSpheres(collider)(0);
    for (const Vec3& p : collider.triangle(0))
      EXPECT_LE(real_distance(sphere.center, p), static_cast<long double>(sphere.radius));
  }
  Mesh mesh;
  Body body;
  Collider collider;
};

TEST(PlacedSphereAllowance, pays_for_rotations_that_stretch) {
  const double r = 1 - 0x1p-36;
  OneFacet body({Vec3{r, 0, 0}, Vec3{-r, 0, 0}, Vec3{0, r, 0}}, true);
  ASSERT_EQ(body.body.spheres()[0].radius, 1) << "nothing else pays";
  Random random(7);
  for (int round = 0; round < 100; ++round) {
    RigidTransform place = test::random_transform(random, 1);
    for (Vec3& row : place.rows) row = row * (1 + 4.9e-10);
    body.collider.set_transform(place);
    body.expect_inside();
  }
}

TEST(PlacedSphereAllowance, pays_for_vertices_that_are_rounded_far_from_the_origin) {
  Random random(8);
  constexpr double unit = 0x1p-22;  // of 2^30
  for (int round = 0; round < 2000; ++round) {
    const bool far_body = round % 2 == 0;
    const Vec3 about = far_body ? Vec3{0x1p29, -0x1p29, 0x1p29} : Vec3{};
    const Triangle t = random_triangle(random, 2 * unit, about);
    OneFacet body(t, false);
    body.collider.set_transform(test::random_transform(random, far_body ? 1 : 0x1p30));
    body.expect_inside();
  }
}

// Rays from so far away that a unit in the last place there is a hundredth of the body: the tree misses none of what
// hits the facets, which a body without a tree tells.
TEST(RayAllowance, finds_from_far_away_what_a_body_of_one_sphere_finds) {
  const Mesh mesh = sample_body("torus", 12);
  const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 3});
  CoveredTree whole = model;
  whole.tree = {};
  whole.tree.append_level({}, std::vector<Sphere>{{model.tree.spheres[0].center, 1e15}});
  whole.cover.region_begin = {0};
  whole.cover.region_end = {static_cast<std::uint32_t>(whole.cover.patch_count())};
  const Body body(mesh, model), plain(mesh, whole, {.rules = {Rule::approach2}});
  ASSERT_GT(plain.spheres()[0].radius, 1e14f);
  const Collider collider(mesh, body), slow(mesh, plain);
  Random random(9);
  int hits = 0;
  for (int round = 0; round < 1500; ++round) {
    const Vec3 from = (round % 2 == 0 ? 1e14 : 1e15) * normalized(random_vector(random));
    const std::size_t vertex = random.next() % mesh.vertex_count();
    const Vec3 target = mesh.positions[vertex] + 0.05 * random_vector(random);
    const Ray ray{from, target - from, std::numeric_limits<double>::infinity()};
    const RayHit expected = first_hit(slow, ray), found = first_hit(collider, ray);
    ASSERT_EQ(found.first.has_value(), expected.first.has_value()) << round;
    if (!found.first) continue;
    ++hits;
    EXPECT_EQ(found.first->t, expected.first->t) << round;
  }
  EXPECT_GT(hits, 100);
}

}  // namespace
}  // namespace morula
