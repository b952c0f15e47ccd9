// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Two convex sets meet if and only if 0 is a difference of their points: the oracle looks for 0 in the hull of the nine
// differences of corners, which is in it exactly when it is in a point, segment, triangle or tetrahedron of them that
// is not flat. In integers; it shares nothing with what it judges.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/triangle_intersection.hpp>
#include <support/transforms.hpp>
#include <vector>

#include "query/triangle_pairs.hpp"
#include "simd/processors.hpp"

namespace morula {
namespace {

__extension__ typedef __int128 Integer;
using Point = std::array<Integer, 3>;

Point difference(const Vec3& a, const Vec3& b) {
  Point p;
  for (int axis = 0; axis < 3; ++axis)
    p[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(a[axis]) - static_cast<std::int64_t>(b[axis]);
  return p;
}
Point cross_of(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Integer dot_of(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
bool is_zero(const Point& p) {
  return p[0] == 0 && p[1] == 0 && p[2] == 0;
}

bool segment_has_zero(const Point& p, const Point& q) {
  return is_zero(cross_of(p, q)) && dot_of(p, q) <= 0;
}
// p x q, q x r and r x p are along one normal when 0 is in the plane, and point the same way when 0 is in between.
bool triangle_has_zero(const Point& p, const Point& q, const Point& r) {
  const Point pq = cross_of(p, q), qr = cross_of(q, r), rp = cross_of(r, p);
  if (dot_of(p, qr) != 0) return false;
  Point normal;
  for (std::size_t k = 0; k < 3; ++k) normal[k] = pq[k] + qr[k] + rp[k];
  if (is_zero(normal)) return false;  // flat: its edges are looked at themselves
  bool inside = true;
  for (const Point& each : {pq, qr, rp})
    for (std::size_t k = 0; k < 3; ++k)
      inside = inside && (normal[k] > 0 ? each[k] >= 0 : normal[k] < 0 ? each[k] <= 0 : true);
  return inside;
}
bool tetrahedron_has_zero(const Point& p, const Point& q, const Point& r, const Point& s) {
  const Integer qrs = dot_of(q, cross_of(r, s)), prs = dot_of(p, cross_of(r, s)), pqs = dot_of(p, cross_of(q, s)),
                pqr = dot_of(p, cross_of(q, r));
  const Integer weights[4] = {qrs, -prs, pqs, -pqr};
  const Integer volume = weights[0] + weights[1] + weights[2] + weights[3];
  if (volume == 0) return false;
  for (const Integer w : weights)
    if (volume > 0 ? w < 0 : w > 0) return false;
  return true;
}

bool oracle(const Triangle& a, const Triangle& b) {
  std::vector<Point> d;
  for (const Vec3& p : a)
    for (const Vec3& q : b) d.push_back(difference(p, q));
  for (std::size_t i = 0; i < 9; ++i) {
    if (is_zero(d[i])) return true;
    for (std::size_t j = 0; j < i; ++j) {
      if (segment_has_zero(d[i], d[j])) return true;
      for (std::size_t k = 0; k < j; ++k) {
        if (triangle_has_zero(d[i], d[j], d[k])) return true;
        for (std::size_t l = 0; l < k; ++l)
          if (tetrahedron_has_zero(d[i], d[j], d[k], d[l])) return true;
      }
    }
  }
  return false;
}

Triangle scaled(const Triangle& t, double factor) {
  return {t[0] * factor, t[1] * factor, t[2] * factor};
}

// Both answers, any order of arguments and corners; ends of the segment close to both triangles.
void expect_verdict(const Triangle& a, const Triangle& b, bool expected) {
  ASSERT_EQ(intersect(a, b), expected);
  ASSERT_EQ(intersect(b, a), expected);
  ASSERT_EQ(intersect({a[2], a[1], a[0]}, {b[1], b[2], b[0]}), expected);
  const std::optional<Segment> common = intersection(a, b);
  ASSERT_EQ(common.has_value(), expected);
  if (!common) return;
  double size = 0;
  for (const Triangle* const t : {&a, &b})
    for (const Vec3& p : *t) size = std::max(size, max_norm(p));
  for (const Vec3& end : {common->from, common->to})
    for (const Triangle* const t : {&a, &b}) ASSERT_LE(std::sqrt(closest_point(*t, end).squared_distance), 1e-9 * size);
}

struct Pair {
  Triangle a, b;
};

Pair on_a_small_grid(Random& random, int round) {
  const double most = 1 + round % 3;
  Pair pair;
  for (Triangle* const t : {&pair.a, &pair.b})
    for (Vec3& p : *t) p = test::random_whole(random, most);
  // One in four in one plane; one in eight flat, in sixteen a point.
  if (round % 4 == 1)
    for (Triangle* const t : {&pair.a, &pair.b})
      for (Vec3& p : *t) p[round / 4 % 3] = 1;
  if (round % 8 == 2) pair.a[2] = pair.a[0];
  if (round % 16 == 2) pair.a[1] = pair.a[0];
  return pair;
}

Pair that_hardly_touch(Random& random, int round) {
  constexpr double most = 0x1p36;
  Triangle a, b;
  for (Vec3& p : a) p = test::random_whole(random, most);
  for (Vec3& p : b) p = test::random_whole(random, most);
  // A corner of b comes to a's inside, to an edge or to a corner, but for a unit.
  double v = random.uniform(), w = random.uniform() * (1 - v);
  if (round % 3 == 1) w = 0;
  if (round % 3 == 2) v = 1, w = 0;
  const Vec3 near = a[0] + (a[1] - a[0]) * v + (a[2] - a[0]) * w;
  b[0] = {std::round(near.x), std::round(near.y), std::round(near.z)};
  if (round % 5 == 0) b[0] += test::random_whole(random, 1);
  if (round % 7 == 0)
    b[1] = near + (a[1] - a[0]) * 0.25, b[1] = {std::round(b[1].x), std::round(b[1].y), std::round(b[1].z)};
  return {a, b};
}
/// By which such a pair can be scaled with the same verdict.
double scale_of(int round) {
  constexpr double scales[] = {1, 0x1p-60, 0x1p400, 0x1p900, 0x1p-500};
  return scales[static_cast<std::size_t>(round) % std::size(scales)];
}

TEST(TriangleIntersection, equals_the_oracle_on_small_grids) {
  Random random(1);
  std::size_t meetings = 0;
  constexpr int rounds = 60000;
  for (int round = 0; round < rounds; ++round) {
    const auto [a, b] = on_a_small_grid(random, round);
    const bool expected = oracle(a, b);
    meetings += expected;
    ASSERT_NO_FATAL_FAILURE(expect_verdict(a, b, expected)) << round;
  }
  EXPECT_GT(meetings, rounds / 10u);
  EXPECT_LT(meetings, rounds * 9u / 10);
}

TEST(TriangleIntersection, equals_the_oracle_where_triangles_hardly_touch) {
  Random random(2);
  std::size_t meetings = 0;
  constexpr int rounds = 12000;
  for (int round = 0; round < rounds; ++round) {
    const auto [a, b] = that_hardly_touch(random, round);
    const bool expected = oracle(a, b);
    meetings += expected;
    const double s = scale_of(round);
    ASSERT_EQ(intersect(scaled(a, s), scaled(b, s)), expected) << round;
    ASSERT_NO_FATAL_FAILURE(expect_verdict(a, b, expected)) << round;
  }
  EXPECT_GT(meetings, rounds / 10u);
  EXPECT_LT(meetings, rounds * 9u / 10);
}

TEST(TrianglePairs, all_processors_find_the_same_verdicts_and_they_are_right) {
  Random random(3);
  std::size_t apart = 0, met = 0, in_one_plane = 0;
  for (int round = 0; round < 40000; round += 8) {
    const bool is_on_grid = round % 16 == 0;
    const double scale = is_on_grid ? 1 : scale_of(round / 16);
    detail::TrianglePairs pairs;
    unsigned meeting = 0, flat = 0;
    for (int k = 0; k < 8; ++k) {
      const auto [a, b] = is_on_grid ? on_a_small_grid(random, round + k) : that_hardly_touch(random, round + k);
      pairs.put(static_cast<std::size_t>(k), scaled(a, scale), scaled(b, scale));
      meeting |= (oracle(a, b) ? 1u : 0u) << k;
      flat |= (is_on_grid && k % 4 == 1 ? 1u : 0u) << k;
    }
    const detail::TriangleVerdicts found = detail::all_look_at_triangles().front()(pairs);
    ASSERT_EQ(found.apart & meeting, 0u) << round;
    ASSERT_EQ(found.meeting & ~meeting, 0u) << round;
    for (std::size_t kind = 0; kind < detail::all_look_at_triangles().size(); ++kind) {
      const detail::TriangleVerdicts of_kind = detail::all_look_at_triangles()[kind](pairs);
      ASSERT_EQ(of_kind.apart, found.apart) << round << ' ' << detail::kind_name(kind);
      ASSERT_EQ(of_kind.meeting, found.meeting) << round << ' ' << detail::kind_name(kind);
    }
    apart += static_cast<std::size_t>(std::popcount(found.apart));
    met += static_cast<std::size_t>(std::popcount(found.meeting));
    in_one_plane += static_cast<std::size_t>(std::popcount(found.apart & flat));
  }
  EXPECT_GT(apart, 8000u);
  EXPECT_GT(met, 2000u);
  EXPECT_GT(in_one_plane, 500u);
}

TEST(TrianglePairs, far_from_each_others_planes_and_edges_are_never_in_doubt) {
  Random random(5);
  std::size_t met = 0;
  for (int round = 0; round < 2000; ++round) {
    detail::TrianglePairs pairs;
    unsigned meeting = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      Pair pair;
      for (Triangle* const t : {&pair.a, &pair.b})
        for (Vec3& p : *t) p = test::random_whole(random, 0x1p30);
      pairs.put(k, pair.a, pair.b);
      meeting |= (oracle(pair.a, pair.b) ? 1u : 0u) << k;
    }
    const detail::TriangleVerdicts found = detail::look_at_triangles()(pairs);
    ASSERT_EQ(found.meeting, meeting) << round;
    ASSERT_EQ(found.apart, ~meeting & 0xffu) << round;
    met += static_cast<std::size_t>(std::popcount(meeting));
  }
  EXPECT_GT(met, 1000u);
}

TEST(TrianglePairs, with_numbers_that_are_none_or_overflow_are_the_same_for_all_processors) {
  constexpr double inf = std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::max();
  for (const double odd : {inf, -inf, std::nan(""), most, -most}) {
    detail::TrianglePairs pairs;
    for (std::size_t k = 0; k < 8; ++k) {
      Triangle a{Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}};
      pairs.put(k, a, a);
      for (int corner = 0; corner < 3; ++corner) pairs.a[corner][k % 3][k] = odd;
    }
    const detail::TriangleVerdicts found = detail::all_look_at_triangles().front()(pairs);
    for (const detail::LookAtTriangles look : detail::all_look_at_triangles()) {
      EXPECT_EQ(look(pairs).apart, found.apart) << odd;
      EXPECT_EQ(look(pairs).meeting, found.meeting) << odd;
    }
    if (std::isnan(odd)) {
      EXPECT_EQ(found.apart | found.meeting, 0u);
    }
  }
}

TEST(TrianglePairs, meet_where_single_ones_do) {
  Random random(4);
  for (std::size_t count = 0; count < 40; ++count) {
    std::vector<Pair> pairs;
    std::vector<std::size_t> expected, found;
    for (std::size_t i = 0; i < count; ++i) {
      pairs.push_back(on_a_small_grid(random, static_cast<int>(7 * count + i)));
      if (oracle(pairs[i].a, pairs[i].b)) expected.push_back(i);
    }
    detail::find_meeting(
        count, [&](std::size_t i, const auto& put) { put(pairs[i].a, pairs[i].b); },
        [&](std::size_t i) { found.push_back(i); });
    EXPECT_EQ(found, expected) << count;
  }
}

TEST(TriangleIntersection, finds_the_segment_of_a_worked_example) {
  const Triangle flat{Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}};
  const Triangle upright{Vec3{1, 1, -1}, Vec3{1, 1, 1}, Vec3{9, 1, 0}};
  const auto common = intersection(flat, upright);
  ASSERT_TRUE(common);
  // From (1, 1, 0), where the upright one begins, to (3, 1, 0), where the flat one ends.
  EXPECT_LE(std::min(distance(common->from, {1, 1, 0}), distance(common->to, {1, 1, 0})), 1e-15);
  EXPECT_LE(std::min(distance(common->from, {3, 1, 0}), distance(common->to, {3, 1, 0})), 1e-15);
}

TEST(TriangleIntersection, of_coplanar_triangles_is_the_longest_diagonal) {
  const Triangle a{Vec3{0, 0, 2}, Vec3{4, 0, 2}, Vec3{0, 4, 2}};
  const Triangle b{Vec3{1, 1, 2}, Vec3{5, 1, 2}, Vec3{1, 5, 2}};
  const auto common = intersection(a, b);  // the triangle (1, 1), (3, 1), (1, 3)
  ASSERT_TRUE(common);
  EXPECT_DOUBLE_EQ(distance(common->from, common->to), std::sqrt(8.0));
  const auto whole = intersection(a, a);
  ASSERT_TRUE(whole);
  EXPECT_DOUBLE_EQ(distance(whole->from, whole->to), std::sqrt(32.0));
}

TEST(TriangleIntersection, tells_touching_from_a_gap_of_the_last_bit) {
  const Triangle floor{Vec3{-1, -1, 0}, Vec3{1, -1, 0}, Vec3{0, 1, 0}};
  constexpr double tiny = std::numeric_limits<double>::denorm_min();
  for (const double height : {0.0, tiny, 0x1p-600, 1e-18}) {
    const Triangle tent{Vec3{0, 0, height}, Vec3{0.3, 1e300, 1e300}, Vec3{-0.3, 0, 1}};
    EXPECT_EQ(intersect(floor, tent), height == 0) << height;
    EXPECT_EQ(intersect(tent, floor), height == 0) << height;
  }
}

}  // namespace
}  // namespace morula
