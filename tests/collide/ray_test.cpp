// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rays against brute force, through edges and corners, and along surfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/collide/primitives.hpp>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

#include "placed_bodies.hpp"
#include "stale_pose.hpp"

namespace morula {
namespace {

using test::PlacedBody;

// Least t over all facets, by planes and signed areas: good away from edges.
double slow_first_hit(const Collider& body, const Ray& ray, double* nearest_edge) {
  double first = std::numeric_limits<double>::infinity();
  *nearest_edge = first;
  for (std::uint32_t f = 0; f < body.mesh_facets().size(); ++f) {
    const Triangle t = body.triangle(f);
    const Vec3 n = area_vector(t);
    const double slope = dot(n, ray.direction);
    // How near the ray passes to the facet's edges, as a share of the coordinates: near hits are not judged.
    double inside = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const Vec3 edge = t[(k + 1) % 3] - t[k], side = cross(ray.direction, edge);
      const double size = length(side);
      const double offset = size > 0 ? dot(side, t[k] - ray.origin) / size * (slope > 0 ? -1 : 1) : 0;
      inside = std::min(inside, offset);
      *nearest_edge = std::min(*nearest_edge, std::abs(offset));
    }
    const double where = slope != 0 ? dot(n, t[0] - ray.origin) / slope : -1;
    if (inside >= 0 && where >= 0 && where <= ray.t_end) first = std::min(first, where);
  }
  return first;
}

TEST(Ray, equals_brute_force_over_random_poses) {
  Random random(21);
  int hits = 0, misses = 0;
  for (int round = 0; round < 600; ++round) {
    auto& bodies = test::placed_bodies();
    PlacedBody& body = *bodies[static_cast<std::size_t>(round / 10) % bodies.size()];
    if (round % 10 == 0) body.deform(test::rippled(body.mesh.positions, 0.2, static_cast<std::uint64_t>(round)));
    const Vec3 about = round % 4 == 3 ? Vec3{-4e4, 1e5, 7e4} : Vec3{};
    body.collider.set_transform(test::random_transform(random, 0.5, about));
    Ray ray{about + test::random_point(random, 4.0), {}, std::numeric_limits<double>::infinity()};
    ray.direction = (about + test::random_point(random, 1.0) - ray.origin) * random.uniform(0.1, 3.0);
    if (round % 5 == 0) ray.t_end = random.uniform(0, 2);
    double nearest_edge = 0;
    const double expected = slow_first_hit(body.collider, ray, &nearest_edge);
    if (nearest_edge < 1e-9) continue;
    const RayHit found = first_hit(body.collider, ray);
    ASSERT_TRUE(found.status && found.certified);
    ASSERT_EQ(found.first.has_value(), expected < std::numeric_limits<double>::infinity()) << body.name << " " << round;
    ++(found.first ? hits : misses);
    if (!found.first) continue;
    EXPECT_NEAR(found.first->t, expected, 1e-8) << body.name << " " << round;
    const Triangle corners = body.collider.triangle(found.first->point.facet);
    EXPECT_LE(distance(at_barycentric(corners, found.first->point.barycentric), found.first->point.point), 1e-9);
    EXPECT_LE(distance(ray.origin + ray.direction * found.first->t, found.first->point.point), 1e-7);
    EXPECT_NEAR(length(found.first->normal), 1, 1e-12);
  }
  EXPECT_GT(hits, 150);
  EXPECT_GT(misses, 80);
}

TEST(Ray, all_hits_are_those_of_brute_force_each_facet_once) {
  Random random(22);
  std::size_t hits = 0, several = 0;
  for (int round = 0; round < 300; ++round) {
    auto& bodies = test::placed_bodies();
    PlacedBody& body = *bodies[static_cast<std::size_t>(round / 10) % bodies.size()];
    body.collider.set_transform(test::random_transform(random, 0.5));
    Ray ray{test::random_point(random, 3.0), {}};
    ray.direction = test::random_point(random, 0.7) - ray.origin;
    if (round % 5 == 0) ray.t_end = random.uniform(0, 2);
    double nearest_edge = 0;
    const double first = slow_first_hit(body.collider, ray, &nearest_edge);
    if (nearest_edge < 1e-9) continue;
    // Whoever is hit alone: a facet is a mesh of its own.
    std::vector<std::uint32_t> expected, found;
    for (std::uint32_t f = 0; f < body.collider.mesh_facets().size(); ++f) {
      const Triangle t = body.collider.triangle(f);
      const Vec3 n = area_vector(t);
      const double where = dot(n, t[0] - ray.origin) / dot(n, ray.direction);
      const Vec3 x = ray.origin + ray.direction * where;
      bool is_inside = where >= 0 && where <= ray.t_end;
      for (std::size_t k = 0; k < 3; ++k) is_inside = is_inside && dot(n, cross(t[(k + 1) % 3] - t[k], x - t[k])) > 0;
      if (is_inside) expected.push_back(f);
    }
    const std::vector<RayPoint> all = all_hits(body.collider, ray);
    double before = 0;
    for (const RayPoint& point : all) {
      EXPECT_GE(point.t, before);
      before = point.t;
      EXPECT_LE(distance(ray.origin + ray.direction * point.t, point.point.point), 1e-7);
      EXPECT_NEAR(length(point.normal), 1, 1e-12);
      found.push_back(point.point.facet);
    }
    std::sort(found.begin(), found.end());
    ASSERT_EQ(found, expected) << body.name << " " << round;
    ASSERT_EQ(all.empty(), !(first < std::numeric_limits<double>::infinity()));
    if (!all.empty()) {
      EXPECT_EQ(all[0].t, first_hit(body.collider, ray).first->t);
    }
    hits += all.size(), several += all.size() > 1;
  }
  EXPECT_GT(hits, 200u);
  EXPECT_GT(several, 80u);
}

TEST(Ray, through_every_vertex_and_edge_of_a_closed_mesh_hits) {
  // Meshes about the origin: whatever goes out from there comes through the surface, wherever it does.
  Random random(8);
  for (const Mesh& mesh : {test::box_mesh({-1, -1, -1}, {1, 1, 1}, 3), test::icosphere(2), test::uv_sphere(13, 7)}) {
    PlacedBody body(mesh);
    for (const RigidTransform& transform : {RigidTransform{}, test::random_transform(random, 0.2),
                                            test::random_transform(random, 0.2, {1e3, -500, 20})}) {
      body.collider.set_transform(transform);
      const Vec3 inside = transform({0.01, -0.02, 0.03});
      for (const Vec3& origin : {transform({0, 0, 0}), inside})
        for (std::uint32_t f = 0; f < mesh.facet_count(); ++f) {
          const Triangle t = body.collider.triangle(f);
          for (int k = 0; k < 3; ++k)
            for (const double s : {0.0, 0.5, 0.25, random.uniform()}) {
              const Vec3 target = t[k] + (t[(k + 1) % 3] - t[k]) * s;
              const RayHit out = first_hit(body.collider, {origin, target - origin});
              ASSERT_TRUE(out.first) << f << " " << k << " " << s;
              EXPECT_NEAR(out.first->t, 1, 1e-9);
              // And from outside.
              const Vec3 far = origin + (target - origin) * 7.0;
              ASSERT_TRUE(first_hit(body.collider, {far, target - far}).first) << f << " " << k << " " << s;
            }
        }
    }
  }
}

TEST(Ray, along_axes_of_a_grid_hits_on_corners_and_edges_exactly) {
  PlacedBody box(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 4));
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j) {
      const double x = 0.125 * i, y = 0.125 * j;
      for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {-1.0, 1.0}) {
          Vec3 origin, direction;
          origin[axis] = -3 * sign, origin[(axis + 1) % 3] = x, origin[(axis + 2) % 3] = y;
          direction[axis] = sign * 0.5;
          const RayHit found = first_hit(box.collider, {origin, direction});
          ASSERT_TRUE(found.first) << axis << " " << x << " " << y;
          EXPECT_EQ(found.first->t, 4) << "also where it grazes a side";
        }
    }
  for (const double beyond : {1 + 1e-12, 1.5})
    EXPECT_FALSE(first_hit(box.collider, {{beyond, 0, -3}, {0, 0, 1}}).first);
}

TEST(Ray, ends_where_it_ends) {
  PlacedBody box(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2));
  const Vec3 origin{0.3, 0.1, -3}, up{0, 0, 2};
  EXPECT_EQ(first_hit(box.collider, {origin, up}).first->t, 1);
  EXPECT_EQ(first_hit(box.collider, {origin, up}).first->normal, (Vec3{0, 0, -1}));
  EXPECT_TRUE(first_hit(box.collider, {origin, up, 1}).first) << "the end belongs to it";
  EXPECT_FALSE(first_hit(box.collider, {origin, up, 0.999}).first);
  EXPECT_FALSE(first_hit(box.collider, {origin, -up}).first);
  EXPECT_EQ(first_hit(box.collider, {{0.3, 0.1, 0}, up}).first->t, 0.5) << "from inside";
  EXPECT_EQ(first_hit(box.collider, {{0.3, 0.1, -1}, up}).first->t, 0) << "from the surface";
  EXPECT_EQ(first_hit(box.collider, {{0.3, 0.1, 4}, up}).sphere_tests, 1u);
  // Directions of any length.
  EXPECT_EQ(first_hit(box.collider, {origin, {0, 0, 0x1p-180}}).first->t, 0x1p181);
  EXPECT_EQ(first_hit(box.collider, {origin, {0, 0, 0x1p180}}).first->t, 0x1p-179);
}

TEST(Ray, directions_have_the_range_that_the_message_says) {
  PlacedBody box(test::box_mesh({-1, -1, -1}, {1, 1, 1}));
  const auto status = [&](double length) {
    return RayQuery().run(box.collider, {{0.3, 0.1, -3}, {0, 0, length}}).status;
  };
  EXPECT_TRUE(status(std::nextafter(0x1p-200, 1)));
  EXPECT_TRUE(status(std::nextafter(0x1p200, 1)));
  EXPECT_EQ(status(0x1p-200).code, Status::Code::bad_shape);
  EXPECT_EQ(status(-0x1p200).code, Status::Code::bad_shape);
  EXPECT_NE(message(status(0x1p-200)).find("not longer than 2^-200 and shorter than 2^200: scale the direction"),
            std::string::npos);
}

TEST(Ray, refuses_what_is_no_ray) {
  PlacedBody box(test::box_mesh({-1, -1, -1}, {1, 1, 1}));
  using test::nan;
  for (const Ray& bad : {Ray{{nan, 0, 0}, {0, 0, 1}}, Ray{{0, 0, 0}, {0, 0, 0}}, Ray{{0, 0, 0}, {0, nan, 1}},
                         Ray{{0, 0, 0}, {0, 0, 1}, -1}, Ray{{0, 0, 0}, {0, 0, 1}, nan}}) {
    EXPECT_THROW(static_cast<void>(first_hit(box.collider, bad)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(all_hits(box.collider, bad)), std::invalid_argument);
    const RayHit found = RayQuery().run(box.collider, bad);
    EXPECT_EQ(found.status.code, Status::Code::bad_shape);
    EXPECT_FALSE(found.first || found.certified);
  }
  const test::StalePose late(box.mesh, box.model.cover, box.body.sphere_state());
  EXPECT_EQ(RayQuery().run(late.collider, {}).status.code, Status::Code::positions_not_current);
}

}  // namespace
}  // namespace morula
