// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Convex hulls: whole arithmetic, formulas of boxes, dense samples of facets.
#include <gtest/gtest.h>

#include <map>
#include <morula/collide/primitives.hpp>
#include <morula/geometry/reproducible.hpp>
#include <set>
#include <support/numbers.hpp>

#include "placed_bodies.hpp"

namespace morula {
namespace {

std::int64_t whole_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto w = [](double x) { return static_cast<std::int64_t>(x); };
  const std::int64_t ux = w(b.x - a.x), uy = w(b.y - a.y), uz = w(b.z - a.z), vx = w(c.x - a.x), vy = w(c.y - a.y),
                     vz = w(c.z - a.z), wx = w(d.x - a.x), wy = w(d.y - a.y), wz = w(d.z - a.z);
  return wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx);
}

TEST(ConvexHull, has_all_points_behind_its_facets_and_is_closed) {
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    // Small whole numbers: many points on one plane, on one line, and the same.
    const int reach = 1 + round % 5;
    std::vector<Vec3> points;
    for (int i = 0; i < 5 + round % 40; ++i) {
      const auto whole = [&] {
        return static_cast<double>(static_cast<int>(random.next() % (2 * static_cast<unsigned>(reach) + 1)) - reach);
      };
      points.push_back({whole(), whole(), whole()});
    }
    bool is_solid = false;
    for (std::size_t i = 1; i < points.size() && !is_solid; ++i)
      for (std::size_t j = i + 1; j < points.size() && !is_solid; ++j)
        for (std::size_t k = j + 1; k < points.size() && !is_solid; ++k)
          is_solid = whole_volume(points[0], points[i], points[j], points[k]) != 0;
    if (!is_solid) {
      EXPECT_THROW(ConvexHull{points}, std::invalid_argument);
      continue;
    }
    const ConvexHull hull(points);
    const auto v = hull.vertices();
    std::set<std::array<std::uint32_t, 2>> sides;
    for (const Facet& f : hull.facets()) {
      EXPECT_NE(max_norm(cross(v[f[1]] - v[f[0]], v[f[2]] - v[f[0]])), 0);
      for (const Vec3& p : points) EXPECT_LE(whole_volume(v[f[0]], v[f[1]], v[f[2]], p), 0);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(sides.insert({f[k], f[(k + 1) % 3]}).second);
    }
    for (const auto& side : sides) EXPECT_TRUE(sides.contains({side[1], side[0]}));
    EXPECT_EQ(v.size() + hull.facets().size(), sides.size() / 2 + 2) << "one sphere";
  }
}

TEST(ConvexHull, of_a_box_has_its_volume_and_moves_with_a_transform) {
  const Box box{{-1, 2, 3}, {1, 5, 3.5}};
  const RigidTransform transform = RigidTransform::from_axis({1, 2, 3}, 0.7, {4, 5, 6});
  const ConvexHull hull = ConvexHull::box(box, transform);
  EXPECT_EQ(hull.vertices().size(), 8u);
  EXPECT_EQ(hull.facets().size(), 12u);
  double volume = 0;
  for (const Facet& f : hull.facets())
    volume += dot(hull.vertices()[f[0]], cross(hull.vertices()[f[1]], hull.vertices()[f[2]])) / 6;
  EXPECT_NEAR(volume, 2 * 3 * 0.5, 1e-12);
  for (const ConvexHull::Plane& plane : hull.planes()) {
    EXPECT_NEAR(length(plane.normal), 1, 1e-14);
    const Vec3 middle = transform(box.center());
    EXPECT_LT(dot(plane.normal, middle), plane.offset);
  }
  EXPECT_THROW(ConvexHull::box({{0, 0, 0}, {1, 1, 0}}), std::invalid_argument);
  EXPECT_THROW(ConvexHull::box({{0, 0, 0}, {1, 1, test::infinity}}), std::invalid_argument);
  EXPECT_THROW((ConvexHull{std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}), std::invalid_argument);
  EXPECT_THROW(hull.placed(RigidTransform{{Vec3{2, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}, {}}), std::invalid_argument);
}

/// Of a box with this transform, by its formula.
double box_distance(const Vec3& half, const RigidTransform& transform, const Vec3& x) {
  const Vec3 p = transform.inverse_rotate(x - transform.translation);
  const Vec3 d{std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z};
  const double outside = length(max(d, Vec3{}));
  return outside > 0 ? outside : std::max({d.x, d.y, d.z});
}

TEST(ConvexHull, touches_bodies_where_samples_of_their_facets_say_so) {
  Random random(7);
  std::size_t inside = 0, outside = 0;
  TouchQuery query;
  for (auto& body : test::placed_bodies())
    for (int round = 0; round < 6; ++round) {
      const Box extent = bounding_box(body->mesh);
      const double size = extent.diagonal();
      const Vec3 half = Vec3{random.uniform(0.02, 0.3), random.uniform(0.02, 0.3), random.uniform(0.02, 0.3)} * size;
      const Vec3 at = body->collider.vertex(static_cast<std::uint32_t>(random.next() % body->mesh.vertex_count())) +
                      Vec3{random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)} * size;
      const RigidTransform transform = RigidTransform::from_axis(
          {random.uniform(), random.uniform(), random.uniform(-1, 1)}, 6 * random.uniform(), at);
      const ConvexHull hull = ConvexHull::box({half * -1, half}, transform);
      const Touch& touch =
          query.run(body->collider, hull, {.margin = 0.05 * size, .nearest = true, .collect_all = true});
      ASSERT_TRUE(touch.status && touch.deepest);
      const double slack = 1e-11 * (size + test::largest_coordinate(body->collider));
      double least = test::infinity;
      std::set<std::uint32_t> sampled;
      for (std::uint32_t f = 0; f < body->mesh.facet_count(); ++f) {
        const Triangle t = body->collider.triangle(f);
        double here = test::infinity;
        constexpr int parts = 8;
        for (int i = 0; i <= parts; ++i)
          for (int j = 0; i + j <= parts; ++j) {
            const double u = static_cast<double>(i) / parts, v = static_cast<double>(j) / parts;
            here = std::min(here, box_distance(half, transform, at_barycentric(t, {1 - u - v, u, v})));
          }
        if (here <= 0.05 * size - slack) sampled.insert(f);
        least = std::min(least, here);
      }
      EXPECT_LE(-touch.deepest->depth, least + slack) << body->name;
      EXPECT_LE(touch.lower, least + slack) << body->name;
      EXPECT_GE(touch.lower, -touch.deepest->depth - slack) << body->name;
      EXPECT_NEAR(box_distance(half, transform, touch.deepest->point.point), -touch.deepest->depth, slack);
      std::set<std::uint32_t> found;
      for (const TouchingFacet& f : touch.facets) found.insert(f.point.facet);
      EXPECT_TRUE(std::includes(found.begin(), found.end(), sampled.begin(), sampled.end()));
      (touch.deepest->depth > 0 ? inside : outside) += 1;
    }
  EXPECT_GT(inside, 5u);
  EXPECT_GT(outside, 2u);
}

}  // namespace
}  // namespace morula
