// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The earliest touch of two moving bodies, beside the gaps of all pairs of leaves in more digits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/collide/moving_spheres.hpp>
#include <support/meshes.hpp>
#include <vector>

#include "placed_bodies.hpp"

namespace morula {
namespace {

using Wide = Vector3<long double>;
using test::PlacedBody;

struct Ends {
  Sphere start, end;
};
/// |x(t)| - R(t) in long double.
long double gap_at(const Ends& a, const Ends& b, long double t, long double distance = 0) {
  const Wide x0 = Wide(b.start.center) - Wide(a.start.center), x1 = Wide(b.end.center) - Wide(a.end.center);
  const long double r0 = static_cast<long double>(a.start.radius) + b.start.radius;
  const long double r1 = static_cast<long double>(a.end.radius) + b.end.radius;
  return length(x0 * (1 - t) + x1 * t) - (r0 * (1 - t) + r1 * t) - distance;
}
/// The first time at which the gap is 0 or less, 2 for none: the gap is convex in t, so golden sections find its least,
/// and bisection before it the zero.
long double first_zero(const Ends& a, const Ends& b, long double distance = 0) {
  const auto gap = [&](long double t) { return gap_at(a, b, t, distance); };
  if (gap(0) <= 0) return 0;
  long double from = 0, to = 1;
  for (int i = 0; i < 90; ++i) {
    const long double p = from + (to - from) * 0.382L, q = from + (to - from) * 0.618L;
    (gap(p) < gap(q) ? to : from) = gap(p) < gap(q) ? q : p;
  }
  long double below = gap(1) < gap(to) ? 1.0L : to;
  if (gap(below) > 0) return 2;
  long double above = 0;
  for (int i = 0; i < 70; ++i) (gap((above + below) / 2) > 0 ? above : below) = (above + below) / 2;
  return below;
}
/// Whether the gap stays above 0: between samples it falls no faster than the spheres move and grow.
bool surely_apart(const Ends& a, const Ends& b, double allowed) {
  const Vec3 x0 = b.start.center - a.start.center, x1 = b.end.center - a.end.center;
  const double r0 = a.start.radius + b.start.radius, r1 = a.end.radius + b.end.radius;
  const double speed = distance(x0, x1) + std::abs(r1 - r0);
  constexpr int steps = 8;
  for (int k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) / steps;
    if (length(x0 * (1 - t) + x1 * t) - (r0 * (1 - t) + r1 * t) - allowed < speed / steps + 1e-3) return false;
  }
  return true;
}
std::vector<Ends> leaves_of(const MovingSpheres& motion) {
  std::vector<Ends> leaves;
  for (std::uint32_t node = 0; node < motion.size(); ++node)
    if (motion.tree().is_leaf(node)) leaves.push_back({motion.sphere(node, 0), motion.sphere(node, 1)});
  return leaves;
}

/// A step of two bodies at random: apart, meeting, or through each other.
void random_step(PlacedBody& a, PlacedBody& b, Random& random, double far, MovingSpheres& motion_a,
                 MovingSpheres& motion_b) {
  const Vec3 place = test::random_point(random, far);
  const auto to = [&](PlacedBody& body, double reach) {
    body.deform(test::rippled(body.mesh.positions, 0.2, random.next()));
    body.collider.set_transform(test::random_transform(random, reach, place));
  };
  to(a, 4), to(b, 4);
  ASSERT_TRUE(motion_a.set_start(a.collider) && motion_b.set_start(b.collider));
  to(a, 4), to(b, 4);
  ASSERT_TRUE(motion_a.set_end(a.collider) && motion_b.set_end(b.collider));
}

TEST(EarliestTouch, is_that_of_all_pairs_of_leaves) {
  Random random(5211);
  MovingSpheres a, b;
  EarliestTouchQuery query;
  int apart = 0, meeting = 0, touching = 0;
  const auto& bodies = test::placed_bodies();
  for (int run = 0; run < 40; ++run) {
    PlacedBody &first = *bodies[random.next() % bodies.size()], &second = *bodies[random.next() % bodies.size()];
    const double far = run % 3 == 0 ? 1e8 : 0, distance = run % 2 == 0 ? 0 : 0.3;
    random_step(first, second, random, far, a, b);
    const EarliestTouch touch = query.run(a, b, {.distance = distance});
    ASSERT_TRUE(touch.status);
    EXPECT_TRUE(touch.complete && touch.certified);
    long double earliest = 2;
    const std::vector<Ends> leaves_b = leaves_of(b);
    for (const Ends& leaf_a : leaves_of(a))
      for (const Ends& leaf_b : leaves_b) {
        if (surely_apart(leaf_a, leaf_b, distance)) continue;
        earliest = std::min(earliest, first_zero(leaf_a, leaf_b, distance));
        if (earliest == 0) break;
      }
    const double slack = 1e-6 + far * 1e-12;
    if (earliest > 1) {
      EXPECT_TRUE(touch.apart || touch.time > 1 - slack) << "run " << run;
      apart += touch.apart;
    } else {
      EXPECT_FALSE(touch.apart) << "run " << run;
      EXPECT_LE(touch.time, earliest) << "run " << run;
      EXPECT_GE(touch.time, earliest - slack) << "run " << run;
      ++(earliest > 0 ? meeting : touching);
      EXPECT_TRUE(a.tree().is_leaf(touch.nodes.a) && b.tree().is_leaf(touch.nodes.b));
      const Ends pair_a{a.sphere(touch.nodes.a, 0), a.sphere(touch.nodes.a, 1)};
      const Ends pair_b{b.sphere(touch.nodes.b, 0), b.sphere(touch.nodes.b, 1)};
      EXPECT_NEAR(static_cast<double>(first_zero(pair_a, pair_b, distance)), touch.time, slack);
    }
  }
  EXPECT_GT(apart, 4);
  EXPECT_GT(meeting, 5);
  EXPECT_GT(touching, 4);
}

/// Two trees of a sphere each, with these ends.
EarliestTouch touch_of(const Ends& a, const Ends& b, const EarliestTouchOptions& options = {}) {
  const auto motion_of = [](const Ends& ends) {
    PosedSpheres spheres(tree_from_spheres(std::vector<Sphere>{{{}, 1}}), true);
    const Collider collider(spheres.sphere_state());
    MovingSpheres motion;
    spheres.set(std::vector<Sphere>{ends.start});
    EXPECT_TRUE(motion.set_start(collider));
    spheres.set(std::vector<Sphere>{ends.end});
    EXPECT_TRUE(motion.set_end(collider));
    return motion;
  };
  return earliest_touch(motion_of(a), motion_of(b), options);
}

// Centers are whole multiples of a power of two, so that no sphere is widened on its way to float, and gaps are exact.
TEST(EarliestTouch, is_never_late_where_spheres_graze_or_meet_at_the_end) {
  Random random(5212);
  int grazing = 0, ends = 0;
  for (int run = 0; run < 20000; ++run) {
    const double scale = std::ldexp(1.0, static_cast<int>(random.next() % 80) - 40);
    const double far = run % 2 == 0 ? 0 : std::ldexp(scale, 20);
    const auto whole = [&](int reach) {
      return scale * static_cast<double>(static_cast<int>(random.next() % (2 * reach + 1)) - reach);
    };
    const Vec3 base{far, far, 0};
    // b passes a along x at a height of exactly the sum of the radii, or of a little more or less.
    const double radius_a = std::abs(whole(8)), radius_b = std::abs(whole(8));
    const double height = radius_a + radius_b;
    const Ends a{{base, radius_a}, {base, radius_a}};
    const double from = whole(64), to = run % 4 < 2 ? 0 : whole(64);
    const Ends b{{base + Vec3{from, 0, height}, radius_b}, {base + Vec3{to, 0, height}, radius_b}};
    const EarliestTouch touch = touch_of(a, b);
    const long double exact = first_zero(a, b);
    if (from == 0 || (from < 0) != (to < 0) || to == 0) {
      // It does touch, at the foot of the height.
      const double foot = from == to ? 0 : from / (from - to);
      EXPECT_FALSE(touch.apart) << run;
      EXPECT_LE(touch.time, foot * (1 + 1e-15)) << run;
      ++(to == 0 ? ends : grazing);
    } else if (exact <= 1) {
      EXPECT_FALSE(touch.apart) << run;
    }
  }
  EXPECT_GT(grazing, 1000);
  EXPECT_GT(ends, 1000);
}

// The start is far away, and a program computes the point at time 1 as v0 + 1 (v1 - v0), off by the rounding out there.
TEST(EarliestTouch, is_never_late_for_points_computed_after_a_long_way) {
  Random random(5213);
  int inside = 0;
  for (int run = 0; run < 20000; ++run) {
    const double away = std::ldexp(1.0, 20 + static_cast<int>(random.next() % 30));
    const Vec3 from = away * normalized(test::random_point(random, 1));
    const Vec3 to = (1 + random.uniform() * away * 0x1p-54) * normalized(test::random_point(random, 1));
    const Vec3 computed = from + 1.0 * (to - from);
    if (length(Wide(computed)) > 1) continue;
    ++inside;
    const Ends ball{{{}, 1}, {{}, 1}}, point{{from, 0}, {to, 0}};
    EXPECT_FALSE(touch_of(ball, point).apart) << "away " << away;
  }
  EXPECT_GT(inside, 1000);
}

TEST(EarliestTouch, takes_points_equal_centers_and_bodies_that_stand_still) {
  const Ends ball{{{}, 1}, {{}, 1}}, point{{{}, 0}, {{}, 0}};
  EXPECT_EQ(touch_of(ball, ball).time, 0);
  EXPECT_EQ(touch_of(point, point).time, 0);
  EXPECT_FALSE(touch_of(point, point).apart);
  // Two points that meet in the middle, and that miss.
  const Ends left{{{-1, 0, 0}, 0}, {{1, 0, 0}, 0}}, right{{{1, 0, 0}, 0}, {{-1, 0, 0}, 0}};
  EXPECT_NEAR(touch_of(left, right).time, 0.5, 1e-9);
  EXPECT_LE(touch_of(left, right).time, 0.5);
  const Ends above{{{1, 0, 0.001}, 0}, {{-1, 0, 0.001}, 0}};
  EXPECT_TRUE(touch_of(left, above).apart);
  EXPECT_NEAR(touch_of(left, above, {.distance = 0.5}).time, 0.375, 1e-6);
  // A sphere that grows, one that shrinks out of reach.
  const Ends grows{{{3, 0, 0}, 0}, {{3, 0, 0}, 4}};
  EXPECT_NEAR(touch_of(ball, grows).time, 0.5, 1e-9);
  const Ends flees{{{2, 0, 0}, 0.5}, {{5, 0, 0}, 0}};
  EXPECT_TRUE(touch_of(ball, flees).apart);
  EXPECT_EQ(touch_of(ball, {{{1.5, 0, 0}, 1}, {{9, 0, 0}, 1}}).time, 0) << "touches only at the start";
}

TEST(EarliestTouch, refuses_bad_options_and_missing_spheres) {
  PlacedBody body(test::icosphere(2));
  MovingSpheres motion, none;
  ASSERT_TRUE(motion.set_start(body.collider));
  EarliestTouchQuery query;
  EXPECT_EQ(query.run(motion, none).status.code, Status::Code::body_not_current);
  EXPECT_EQ(query.run(motion, none).status.body, 1);
  EXPECT_EQ(query.run(none, motion).status.body, 0);
  EXPECT_EQ(query.run(motion, motion, {.distance = -1}).status.code, Status::Code::bad_option);
  EXPECT_EQ(query.run(motion, motion, {.distance = std::numeric_limits<double>::quiet_NaN()}).status.code,
            Status::Code::bad_option);
  EXPECT_EQ(query.run(motion, motion, {.budget = -1}).status.code, Status::Code::bad_option);
  EXPECT_EQ(query.run(motion, motion, {.budget = std::chrono::seconds(1)}).status.code, Status::Code::bad_option);
  EXPECT_THROW((void)earliest_touch(motion, none), std::invalid_argument);
}

TEST(EarliestTouch, stays_a_bound_when_a_budget_ends_it) {
  Random random(5214);
  MovingSpheres a, b;
  const auto& bodies = test::placed_bodies();
  int cut_short = 0;
  for (int run = 0; run < 40; ++run) {
    random_step(*bodies[0], *bodies[1], random, 0, a, b);
    const EarliestTouch whole = earliest_touch(a, b);
    double last = 0;
    for (const int budget : {0, 1, 10, 100, 1000, 100000}) {
      const EarliestTouch part = earliest_touch(a, b, {.budget = budget});
      EXPECT_LE(part.time, whole.time);
      EXPECT_GE(part.time, last) << "more work never gives an earlier time";
      EXPECT_LE(part.sphere_tests, std::max(static_cast<std::size_t>(budget), std::size_t{1}) + 8);
      EXPECT_TRUE(!part.complete || part.time == whole.time);
      cut_short += !part.complete;
      last = part.time;
    }
  }
  EXPECT_GT(cut_short, 40);
}

}  // namespace
}  // namespace morula
