// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres between two frames, beside corners on straight lines and gaps of spheres in more digits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/collide/moving_spheres.hpp>
#include <support/allocations.hpp>
#include <support/meshes.hpp>
#include <vector>

#include "placed_bodies.hpp"

namespace morula {
namespace {

using Wide = Vector3<long double>;
using test::PlacedBody;

/// The corners that a node owns, in the world of a frame: means of the collider's vertices, in long double.
std::vector<Wide> corners_of(const PlacedBody& body, std::uint32_t node) {
  std::vector<Wide> corners;
  const Cover& cover = body.model.cover;
  for (const std::uint32_t c : cover.region_corners(node)) {
    if (c < cover.vertex_count) {
      corners.emplace_back(body.collider.vertex(c));
      continue;
    }
    const CutPoint& cut = cover.cut_points[c - cover.vertex_count];
    const auto at = [&](std::size_t k) {
      return Wide(body.collider.vertex(cut.vertex[k])) * static_cast<long double>(cut.weight[k]);
    };
    corners.push_back(at(0) + at(1) + at(2));
  }
  return corners;
}
/// The largest |x - center| - radius, in long double.
long double excess(const Sphere& s, const std::vector<Wide>& points) {
  long double worst = -std::numeric_limits<long double>::infinity();
  for (const Wide& x : points) worst = std::max(worst, length(x - Wide(s.center)) - s.radius);
  return worst;
}
std::vector<Wide> between(const std::vector<Wide>& a, const std::vector<Wide>& b, double t) {
  std::vector<Wide> result;
  for (std::size_t i = 0; i < a.size(); ++i) result.push_back(a[i] + (b[i] - a[i]) * static_cast<long double>(t));
  return result;
}
/// As a program computes them: v0 + t (v1 - v0) in double.
std::vector<Wide> between_in_double(const std::vector<Wide>& a, const std::vector<Wide>& b, double t) {
  std::vector<Wide> result;
  for (std::size_t i = 0; i < a.size(); ++i) result.emplace_back(Vec3(a[i]) + t * (Vec3(b[i]) - Vec3(a[i])));
  return result;
}

/// Deforms and places a body at random for one end of a step. far: the translation's size.
void pose(PlacedBody& body, Random& random, double amount, double far) {
  body.deform(test::rippled(body.mesh.positions, amount, random.next()));
  body.collider.set_transform(test::random_transform(random, far));
}

TEST(MovingSpheres, contain_their_surface_at_every_time) {
  Random random(5201);
  long double worst = -1;
  for (const auto& body : test::placed_bodies())
    for (const double far : {0.0, 3.0, 1e6, 1e12}) {
      MovingSpheres motion;
      pose(*body, random, 0.3, far);
      ASSERT_TRUE(motion.set_start(body->collider));
      std::vector<std::vector<Wide>> starts;
      const auto count = static_cast<std::uint32_t>(motion.size());
      for (std::uint32_t node = 0; node < count; ++node) starts.push_back(corners_of(*body, node));
      // From far away to the origin or the other way: the ends have pads of very different size.
      pose(*body, random, 0.3, random.uniform() < 0.5 ? 0 : far);
      ASSERT_TRUE(motion.set_end(body->collider));
      EXPECT_TRUE(motion.covers());
      for (std::uint32_t node = 0; node < count; ++node) {
        const std::vector<Wide> end = corners_of(*body, node);
        const Sphere swept = motion.swept_sphere(node);
        const Box box = motion.swept_box(node);
        for (const double t : {0.0, random.uniform(), random.uniform(), 1 - 0x1p-30 * random.uniform(), 1.0}) {
          const Sphere s = motion.sphere(node, t);
          const std::vector<Wide> points = between(starts[node], end, t);
          worst = std::max({worst, excess(s, points), excess(swept, points)});
          EXPECT_LE(excess(s, points), 0) << body->name << " node " << node << " t " << t << " far " << far;
          EXPECT_LE(excess(s, between_in_double(starts[node], end, t)), 0) << body->name << " t " << t;
          EXPECT_LE(excess(swept, points), 0) << body->name << " node " << node << " t " << t << " far " << far;
          // So does what is swept: spheres as a whole.
          EXPECT_LE(length(Wide(s.center) - Wide(swept.center)) + s.radius, static_cast<long double>(swept.radius));
          for (int axis = 0; axis < 3; ++axis) {
            EXPECT_LE(box.lower[axis], static_cast<long double>(s.center[axis]) - s.radius);
            EXPECT_GE(box.upper[axis], static_cast<long double>(s.center[axis]) + s.radius);
          }
        }
      }
    }
  // Tight: some corner lies on its sphere up to what is padded at 1e12.
  EXPECT_GT(worst, -0.1L);
}

TEST(MovingSpheres, are_no_larger_than_the_spheres_of_the_ends) {
  PlacedBody& body = *test::placed_bodies()[0];
  Random random(5202);
  MovingSpheres motion;
  pose(body, random, 0.3, 2);
  ASSERT_TRUE(motion.set_start(body.collider));
  const std::vector<Spheref> start(body.body.spheres().begin(), body.body.spheres().end());
  pose(body, random, 0.3, 2);
  ASSERT_TRUE(motion.set_end(body.collider));
  for (std::uint32_t node = 0; node < start.size(); ++node) {
    const double r0 = start[node].radius, r1 = body.body.spheres()[node].radius;
    EXPECT_NEAR(motion.sphere(node, 0.25).radius, 0.75 * r0 + 0.25 * r1, 1e-12);
    EXPECT_NEAR(motion.sphere(node, -1).radius, r0, 1e-12) << "as at 0";
    EXPECT_NEAR(motion.sphere(node, 7).radius, r1, 1e-12) << "as at 1";
    const Sphere a = motion.sphere(node, 0), b = motion.sphere(node, 1);
    const double smallest = std::max({a.radius, b.radius, (distance(a.center, b.center) + a.radius + b.radius) / 2});
    EXPECT_NEAR(motion.swept_sphere(node).radius, smallest, 1e-12);
  }
}

TEST(MovingSpheres, refuse_what_queries_refuse_in_any_order) {
  PlacedBody body(test::icosphere(2)), other(test::uv_sphere(9, 7, 0.5));
  MovingSpheres motion;
  EXPECT_EQ(motion.size(), 0u);
  EXPECT_FALSE(motion.covers());
  EXPECT_EQ(motion.set_end(body.collider).code, Status::Code::other_bodies) << "an end without a start";
  ASSERT_TRUE(motion.set_start(body.collider));
  EXPECT_EQ(motion.sphere(0, 1).radius, motion.sphere(0, 0).radius) << "stands still";
  EXPECT_EQ(motion.set_end(other.collider).code, Status::Code::other_bodies);
  std::vector<Vec3> bad = body.mesh.positions;
  bad[0].x = std::numeric_limits<double>::quiet_NaN();
  ASSERT_FALSE(body.body.update(bad));
  const Sphere before = motion.sphere(0, 0.5);
  EXPECT_EQ(motion.set_end(body.collider).code, Status::Code::body_not_current);
  EXPECT_EQ(motion.set_start(body.collider).code, Status::Code::body_not_current);
  EXPECT_EQ(motion.sphere(0, 0.5), before);
  ASSERT_TRUE(body.body.update_lazily(body.mesh.positions, 0));
  EXPECT_EQ(motion.set_end(body.collider).code, Status::Code::body_not_complete);
  body.deform(test::rippled(body.mesh.positions, 0.2, 1));
  ASSERT_TRUE(motion.set_end(body.collider));
  const Sphere end = motion.sphere(0, 1);
  motion.widen(0.5);
  motion.widen(0.25);
  EXPECT_EQ(motion.sphere(0, 1).radius, end.radius + 0.75);
  for (const double length : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(motion.widen(length), std::invalid_argument);
  motion.advance();
  EXPECT_EQ(motion.sphere(0, 0), end) << "the end is the start, and no wider";
  EXPECT_EQ(motion.sphere(0, 1), end);
  // Spheres alone, of which nobody says that they cover.
  PosedSpheres spheres(body.model.tree);
  ASSERT_TRUE(motion.set_start(Collider(spheres.sphere_state())));
  EXPECT_FALSE(motion.covers());
}

TEST(MovingSpheres, outlive_their_body) {
  MovingSpheres motion;
  Sphere before;
  {
    PlacedBody body(test::icosphere(2));
    ASSERT_TRUE(motion.set_start(body.collider));
    body.deform(test::rippled(body.mesh.positions, 0.2, 1));
    ASSERT_TRUE(motion.set_end(body.collider));
    before = motion.sphere(3, 0.5);
  }
  EXPECT_EQ(motion.sphere(3, 0.5), before);
  EXPECT_EQ(motion.tree().node_count(), motion.size());
  EXPECT_EQ(earliest_touch(motion, motion).time, 0) << "the structure of the tree is still there";
}

/// A point of a chain of joints that turn evenly: joint i about a random axis by angle i.
Wide chain_point(const std::vector<Vec3>& axes, const std::vector<double>& angles, const std::vector<Vec3>& offsets,
                 double t, std::size_t from = 0) {
  Wide x(0, 0, 0);
  for (std::size_t i = axes.size(); i-- > from;) {
    x = x + Wide(offsets[i]);
    const Wide k = Wide(axes[i]) / length(Wide(axes[i]));
    const long double angle = static_cast<long double>(angles[i]) * t;
    x = x * std::cos(angle) + cross(k, x) * std::sin(angle) + k * (dot(k, x) * (1 - std::cos(angle)));
  }
  return x;
}

TEST(ArcDeviation, bounds_points_of_turning_chains) {
  Random random(5203);
  double tightest = 0;
  for (int run = 0; run < 2000; ++run) {
    const std::size_t joints = 1 + random.next() % 4;
    std::vector<Vec3> axes, offsets;
    std::vector<double> angles, reaches(joints);
    for (std::size_t i = 0; i < joints; ++i) {
      axes.push_back(test::random_point(random, 1));
      offsets.push_back(test::random_point(random, 2));
      angles.push_back(random.uniform(0, run % 2 == 0 ? 0.1 : 3));
    }
    constexpr int steps = 40;
    double largest = 0;
    const Wide start = chain_point(axes, angles, offsets, 0), end = chain_point(axes, angles, offsets, 1);
    for (int k = 0; k <= steps; ++k) {
      const double t = static_cast<double>(k) / steps;
      const Wide x = chain_point(axes, angles, offsets, t);
      largest =
          std::max(largest, static_cast<double>(length(x - (start + (end - start) * static_cast<long double>(t)))));
      // What lies below joint i keeps its distance from it but for the turns below.
      for (std::size_t i = 0; i < joints; ++i)
        reaches[i] = std::max(reaches[i], static_cast<double>(length(chain_point(axes, angles, offsets, t, i))));
    }
    for (double& reach : reaches) reach *= joints > 1 ? 1.01 : 1;  // they were sampled
    const double bound = arc_deviation(angles, reaches);
    EXPECT_LE(largest, bound * (1 + 1e-12)) << "run " << run;
    if (joints == 1) tightest = std::max(tightest, largest / bound);
  }
  EXPECT_GT(tightest, 0.95);
  EXPECT_EQ(arc_deviation({}, {}), 0);
  const std::vector<double> one{1}, two{1, 2}, negative{-1};
  EXPECT_THROW((void)arc_deviation(one, two), std::invalid_argument);
  EXPECT_THROW((void)arc_deviation(negative, one), std::invalid_argument);
  EXPECT_THROW((void)arc_deviation(one, negative), std::invalid_argument);
}

TEST(MovingSpheres, widened_by_the_deviation_contain_a_turning_body) {
  PlacedBody& body = *test::placed_bodies()[1];
  body.deform(body.mesh.positions);
  const Vec3 axis{1, 2, 3};
  const double angle = 0.9;
  double reach = 0;
  for (const Vec3& p : body.mesh.positions) reach = std::max(reach, length(p));
  MovingSpheres motion;
  body.collider.set_transform({});
  ASSERT_TRUE(motion.set_start(body.collider));
  body.collider.set_transform(RigidTransform::from_axis(axis, angle));
  ASSERT_TRUE(motion.set_end(body.collider));
  const auto worst = [&] {
    long double most = -1;
    for (const double t : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      body.collider.set_transform(RigidTransform::from_axis(axis, t * angle));
      for (std::uint32_t node = 0; node < motion.size(); ++node)
        most = std::max(most, excess(motion.sphere(node, t), corners_of(body, node)));
    }
    return most;
  };
  EXPECT_GT(worst(), 0) << "an arc leaves the chord";
  motion.widen(arc_deviation(std::vector<double>{angle}, std::vector<double>{reach}));
  EXPECT_LE(worst(), 0);
}

TEST(MovingSpheres, allocate_nothing_in_later_steps) {
  PlacedBody a(test::icosphere(3)), b(test::uv_sphere(15, 9, 0.7));
  b.collider.set_transform({.translation = {1.2, 0.1, 0.4}});
  MovingSpheres motion_a, motion_b;
  EarliestTouchQuery query;
  const auto step = [&] {
    bool good = motion_a.set_start(a.collider) && motion_b.set_start(b.collider);
    b.collider.set_transform({.translation = {0.9, 0.1, 0.4}});
    good = good && motion_a.set_end(a.collider) && motion_b.set_end(b.collider);
    good = good && query.run(motion_a, motion_b).status;
    motion_a.advance(), motion_b.advance();
    return good;
  };
  ASSERT_TRUE(step());
  ASSERT_TRUE(step());
  const std::size_t before = test::allocations;
  const bool good = step();
  const std::size_t after = test::allocations;
  EXPECT_TRUE(good);
  EXPECT_EQ(after - before, 0u);
}

}  // namespace
}  // namespace morula
