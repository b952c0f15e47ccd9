// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Moving shapes against one body, beside distances and separating axes by brute force at many times.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <morula/collide/collider.hpp>
#include <morula/collide/sweep.hpp>
#include <morula/generators/build.hpp>
#include <support/meshes.hpp>
#include <support/transforms.hpp>

namespace morula {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double to_segment(const Vec3& x, const Vec3& p, const Vec3& q) {
  const double size = dot(q - p, q - p);
  const double s = size > 0 ? std::clamp(dot(x - p, q - p) / size, 0.0, 1.0) : 0.0;
  return length(x - (p + (q - p) * s));
}

double to_triangle(const Vec3& x, const Triangle& t) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  double least = infinity;
  bool is_above = dot(n, n) > 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &p = t[k], &q = t[(k + 1) % 3];
    least = std::min(least, to_segment(x, p, q));
    is_above = is_above && dot(cross(q - p, x - p), n) >= 0;
  }
  return is_above ? std::abs(dot(n, x - t[0])) / length(n) : least;
}

/// The distance to a triangle is convex along a segment: golden sections find the least.
double to_triangle(const Vec3& p, const Vec3& q, const Triangle& t) {
  double from = 0, to = 1;
  const auto at = [&](double s) { return to_triangle(p + (q - p) * s, t); };
  for (int i = 0; i < 70; ++i) {
    const double a = from + (to - from) * 0.382, b = from + (to - from) * 0.618;
    (at(a) < at(b) ? to : from) = at(a) < at(b) ? b : a;
  }
  return std::min({at(from), at(to), at(0), at(1)});
}

/// Whether two convex bodies of these points overlap, by their sides and the products of their edges. grown: both are
/// grown by this along each axis.
bool overlap(std::span<const Vec3> a, std::span<const Vec3> sides, std::span<const Vec3> edges, const Triangle& t,
             double grown) {
  const auto parts = [&](Vec3 axis) {
    const double size = length(axis);
    if (!(size > 1e-12)) return false;
    axis = axis / size;
    double a_low = infinity, a_high = -infinity, t_low = infinity, t_high = -infinity;
    for (const Vec3& p : a) a_low = std::min(a_low, dot(axis, p)), a_high = std::max(a_high, dot(axis, p));
    for (const Vec3& p : t) t_low = std::min(t_low, dot(axis, p)), t_high = std::max(t_high, dot(axis, p));
    return a_low > t_high + grown || t_low > a_high + grown;
  };
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  if (parts(normal)) return false;
  for (const Vec3& side : sides)
    if (parts(side)) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = t[(k + 1) % 3] - t[k];
    if (parts(cross(normal, edge))) return false;
    for (const Vec3& other : edges)
      if (parts(cross(edge, other))) return false;
  }
  return true;
}

/// A box as points, normals and edges, and the library's hull of it.
struct TestBox {
  std::vector<Vec3> points, axes;
  ConvexHull hull;
  TestBox(const Vec3& half, const RigidTransform& where) : hull(ConvexHull::box({-half, half}, where)) {
    for (int i = 0; i < 8; ++i)
      points.push_back(where({i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z}));
    axes = {where.rotate({1, 0, 0}), where.rotate({0, 1, 0}), where.rotate({0, 0, 1})};
  }
};

struct Placed {
  explicit Placed(Mesh m) : mesh(std::move(m)), body(mesh, build(mesh, {.method = Method::octree, .depth = 2})) {}
  std::size_t facet_count() const { return mesh.facets.size(); }
  Mesh mesh;
  Body body;
  Collider collider{mesh, body};
};

/// Compares a hit with the distance of the moved shape from all facets, and from each facet: gap(t, facet).
/// Returns whether the shape touches.
bool compare(const Placed& placed, const SweepHit& hit, const std::function<double(double, std::uint32_t)>& gap) {
  constexpr int samples = 200;
  constexpr double allowed = 1e-9;
  const auto least = [&](double t) {
    double found = infinity;
    for (std::uint32_t f = 0; f < placed.facet_count(); ++f) found = std::min(found, gap(t, f));
    return found;
  };
  EXPECT_TRUE(hit.status) << message(hit.status);
  EXPECT_TRUE(hit.certified);
  const double end = hit.first ? hit.first->t : 1.0;
  EXPECT_GE(end, 0);
  EXPECT_LE(end, 1);
  for (int i = 0; i < samples && end > 0; ++i) {
    const double t = end * i / samples;
    EXPECT_GT(least(t), -allowed) << "a touch before the first one, at " << t << " of " << end;
  }
  if (!hit.first) {
    EXPECT_GT(least(1), -allowed);
    return false;
  }
  EXPECT_LT(gap(end, hit.first->point.facet), allowed) << "no touch at " << end;
  const Triangle corners = placed.collider.triangle(hit.first->point.facet);
  EXPECT_LT(to_triangle(hit.first->point.point, corners), allowed);
  EXPECT_NEAR(length(hit.first->normal), 1, 1e-12);
  return true;
}

std::vector<Mesh> bodies() {
  return {test::icosphere(1, 1.0), test::box_mesh({-0.8, -0.5, -0.6}, {0.8, 0.5, 0.6}, 2),
          test::grid_plate(4, 2.0, 1.5)};
}

struct Way {
  Vec3 from, motion;
};
Way random_way(Random& random) {
  const Vec3 from = normalized(test::random_point(random, 1)) * random.uniform(2.0, 4.0);
  return {from, (test::random_point(random, 1) - from) * random.uniform(0.4, 2.5)};
}

TEST(Sweep, balls_and_capsules_touch_first_where_distances_at_many_times_say_so) {
  Random random(1);
  std::size_t touched = 0, passed = 0;
  for (Mesh& mesh : bodies()) {
    Placed placed(std::move(mesh));
    for (int i = 0; i < 40; ++i) {
      placed.collider.set_transform(test::random_transform(random, 0.3));
      const auto way = random_way(random);
      const Vec3 p = way.from, motion = way.motion;
      const Vec3 q = i % 2 == 0 ? p : p + test::random_point(random, 0.8);
      const double radius = i % 5 == 0 ? 0 : random.uniform(0.01, 0.6);
      const SweepHit hit = i % 2 == 0 ? SweepQuery().run(placed.collider, Sphere{p, radius}, motion)
                                      : SweepQuery().run(placed.collider, Capsule{p, q, radius}, motion);
      const bool touches = compare(placed, hit, [&](double t, std::uint32_t f) {
        const Triangle corners = placed.collider.triangle(f);
        if (i % 2 == 0) return to_triangle(p + motion * t, corners) - radius;
        // A sphere about the capsule and one about the facet are apart by less than both are.
        const double rough = length((p + q) * 0.5 + motion * t - corners[0]) - 0.5 * length(q - p) -
                             std::max(length(corners[1] - corners[0]), length(corners[2] - corners[0])) - radius;
        return rough > 0.1 ? rough : to_triangle(p + motion * t, q + motion * t, corners) - radius;
      });
      (touches ? touched : passed) += 1;
    }
  }
  EXPECT_GT(touched, 40u);
  EXPECT_GT(passed, 20u);
}

TEST(Sweep, boxes_touch_first_where_separating_axes_at_many_times_say_so) {
  Random random(2);
  std::size_t touched = 0, passed = 0;
  for (Mesh& mesh : bodies()) {
    Placed placed(std::move(mesh));
    for (int i = 0; i < 40; ++i) {
      placed.collider.set_transform(i % 4 == 0 ? RigidTransform{} : test::random_transform(random, 0.3));
      auto [from, motion] = random_way(random);
      RigidTransform where = test::random_transform(random, 0, from);
      // Side on side, along an axis.
      if (i % 4 == 0) {
        where = {.translation = from};
        motion = i % 8 == 0 ? Vec3{0, 0, -2 * from.z} : Vec3{-2 * from.x, 0, 0};
      }
      const TestBox box({random.uniform(0.05, 0.6), random.uniform(0.05, 0.6), random.uniform(0.05, 0.6)}, where);
      const SweepHit hit = SweepQuery().run(placed.collider, box.hull, motion);
      // The sign of the gap, with a tolerance on either side.
      const bool touches = compare(placed, hit, [&, &way = motion](double t, std::uint32_t f) {
        std::vector<Vec3> there = box.points;
        for (Vec3& p : there) p = p + way * t;
        const Triangle corners = placed.collider.triangle(f);
        if (!overlap(there, box.axes, box.axes, corners, 1e-9)) return 1.0;
        return overlap(there, box.axes, box.axes, corners, -1e-9) ? -1.0 : 0.0;
      });
      (touches ? touched : passed) += 1;
    }
  }
  EXPECT_GT(touched, 40u);
  EXPECT_GT(passed, 20u);
}

TEST(Sweep, a_ball_on_a_plate_has_the_time_of_the_formula) {
  const Placed plate(test::grid_plate(8, 4, 4));
  const double height = plate.collider.vertex(0).z;
  double middle_x = 0, middle_y = 0;
  for (std::uint32_t v = 0; v < plate.collider.vertex_count(); ++v)
    middle_x += plate.collider.vertex(v).x, middle_y += plate.collider.vertex(v).y;
  middle_x /= static_cast<double>(plate.collider.vertex_count());
  middle_y /= static_cast<double>(plate.collider.vertex_count());
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const double radius = random.uniform(0, 0.5), from = random.uniform(0.6, 3), down = random.uniform(0.1, 6);
    const Vec3 center{middle_x + random.uniform(-0.5, 0.5), middle_y + random.uniform(-0.5, 0.5), height + from};
    const Vec3 motion{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), -down};
    const SweepHit hit = sweep(plate.collider, Sphere{center, radius}, motion);
    const double time = (from - radius) / down;
    ASSERT_EQ(hit.first.has_value(), time <= 1) << time;
    if (!hit.first) continue;
    EXPECT_NEAR(hit.first->t, time, 1e-11 / down);
    EXPECT_LE(hit.first->t, time + 1e-15);
    EXPECT_LT(distance(hit.first->normal, Vec3{0, 0, -1}), 1e-9);
    EXPECT_LT(distance(hit.first->point.point, center + motion * time - Vec3{0, 0, radius}), 1e-9);
  }
}

TEST(Sweep, starts_with_a_touch_where_the_shape_reaches_the_surface) {
  const Placed ball(test::icosphere(2, 1));
  const SweepHit hit = sweep(ball.collider, Sphere{{1, 0, 0}, 0.2}, {5, 0, 0});
  ASSERT_TRUE(hit.first);
  EXPECT_EQ(hit.first->t, 0);
  // Wholly inside, and so away from the surface, it touches the other side.
  const SweepHit out = sweep(ball.collider, Sphere{{0, 0, 0}, 0.2}, {0, 0, 5});
  ASSERT_TRUE(out.first);
  EXPECT_NEAR(out.first->t, 0.16, 0.01);
  EXPECT_FALSE(sweep(ball.collider, Sphere{{0, 0, 0}, 0.2}, {0, 0, 0}).first) << "it rests";
  EXPECT_FALSE(sweep(ball.collider, Sphere{{0, 0, 3}, 0.2}, {0, 0, 1}).first) << "it goes away";
}

TEST(Sweep, is_the_same_where_all_coordinates_are_far_or_small_or_large) {
  Random random(4);
  for (const double scale : {0x1p-30, 1.0, 0x1p40})
    for (const double far : {0.0, 1000.0}) {
      Mesh mesh = test::icosphere(1, 1.0);
      const Placed near(mesh);
      const Vec3 shift = Vec3{1, -2, 3} * (far * scale);
      for (Vec3& p : mesh.positions) p = p * scale + shift;
      const Placed placed(std::move(mesh));
      for (int i = 0; i < 40; ++i) {
        const auto [p, motion] = random_way(random);
        const Sphere small{p, 0.2};
        const SweepHit expected = sweep(near.collider, small, motion);
        const SweepHit hit = sweep(placed.collider, Sphere{p * scale + shift, 0.2 * scale}, motion * scale);
        const double head_on = expected.first ? std::abs(dot(expected.first->normal, motion)) : 0;
        if (expected.first && head_on < 0.1) continue;
        ASSERT_EQ(hit.first.has_value(), expected.first.has_value());
        if (hit.first) {
          EXPECT_NEAR(hit.first->t, expected.first->t, 1e-8);
        }
      }
    }
}

TEST(Sweep, rejects_what_has_no_place_or_way) {
  const Placed ball(test::icosphere(1, 1));
  const SweepQuery query;
  using Code = Status::Code;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(query.run(ball.collider, Sphere{{}, -1}, {1, 0, 0}).status.code, Code::bad_shape);
  EXPECT_EQ(query.run(ball.collider, Sphere{{nan, 0, 0}, 1}, {1, 0, 0}).status.code, Code::bad_shape);
  EXPECT_EQ(query.run(ball.collider, Sphere{{}, 1}, {0, infinity, 0}).status.code, Code::bad_shape);
  EXPECT_EQ(query.run(ball.collider, Capsule{{}, {0, nan, 0}, 1}, {1, 0, 0}).status.code, Code::bad_shape);
  for (const double end : {-0.1, 1.1, nan})
    EXPECT_EQ(query.run(ball.collider, Sphere{{}, 1}, {1, 0, 0}, end).status.code, Code::bad_option);
  const Collider spheres(ball.body.sphere_state());
  EXPECT_EQ(query.run(spheres, Sphere{{}, 1}, {1, 0, 0}).status.code, Code::no_surface);
  EXPECT_THROW(static_cast<void>(sweep(spheres, Sphere{{}, 1}, {1, 0, 0})), std::invalid_argument);
}

// A point in the plane of a facet that passes along its edge, at a known distance.
TEST(Sweep, passes_an_edge_in_the_plane_of_its_facet) {
  const Vec3 a{0.1, 0.2, 0.3}, b{1.1, 0.7, 0.5}, c{0.4, 1.3, 0.9};
  Mesh mesh;
  mesh.positions = {a, b, c};
  mesh.facets = {Facet{0, 1, 2}};
  const CoveredTree built = build(mesh);
  const Body body(mesh, built);
  const Collider collider(mesh, body);
  Vec3 out = normalized(cross(b - a, cross(b - a, c - a)));
  if (dot(out, c - a) > 0) out = -out;
  for (const double away : {1e-8, 1e-9, 1e-10, 1e-11})
    for (int k = 0; k < 20; ++k)
      EXPECT_FALSE(
          sweep(collider, Sphere{a - (b - a) * (0.3 + 0.01 * k) + out * away, 0}, (b - a) * 1.9).first.has_value())
          << away;
}

}  // namespace
}  // namespace morula
