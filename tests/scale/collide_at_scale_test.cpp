// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Distances, rays, contacts and crossings of bodies as small as double has them, and as large as a Body may be.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/collide/contacts.hpp>
#include <morula/collide/containment.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/collide/distance.hpp>
#include <morula/collide/primitives.hpp>
#include <morula/generators/build.hpp>
#include <support/meshes.hpp>

#include "bodies_at_scale.hpp"

namespace morula {
namespace {

constexpr std::array<double, 13> body_sizes{1e-307, 1e-300, 1e-250, 1e-200, 1e-170, 1e-160, 1e-155,
                                            1e-150, 1e-100, 1e-50,  1e-18,  1,      1e15};

// The cube from −1 to 1, of some size, beside a place.
struct Cube {
  Mesh mesh;
  CoveredTree model;
  Body body;
  Collider collider;

  Cube(double size, const Vec3& middle)
      : mesh(at(size, middle)), model(tree(mesh, size, middle)), body(mesh, model), collider(mesh, body) {}
  Cube(const Cube&) = delete;
  Cube& operator=(const Cube&) = delete;

 private:
  static Mesh at(double size, const Vec3& middle) {
    Mesh made = test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2);
    for (Vec3& p : made.positions) p = (p + middle) * size;
    return made;
  }
  static CoveredTree tree(const Mesh& mesh, double size, const Vec3& middle) {
    CoveredTree made =
        build(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2), {.method = Method::octree, .branching = 4, .depth = 2});
    for (Sphere& s : made.tree.spheres) s = {(s.center + middle) * size, s.radius * size * 1.001};
    made.report.mesh_hash = mesh_hash(mesh);
    return made;
  }
};

TEST(CollideAtScale, distances_are_bounded_from_both_sides) {
  for (const double size : body_sizes)
    for (const double gap : {0x1p-30, 0.5, 3.0, 100.0}) {
      const Cube a(size, {0, 0, 0}), b(size, {2 + gap, 0.25, 0});
      // In the numbers that the vertices have.
      double right = -std::numeric_limits<double>::infinity(), left = -right;
      for (const Vec3& p : a.mesh.positions) right = std::max(right, p.x);
      for (const Vec3& p : b.mesh.positions) left = std::min(left, p.x);
      const double expected = left - right;
      const DistanceBounds found = distance(a.collider, b.collider);
      EXPECT_LE(found.lower, expected) << size << ' ' << gap;
      EXPECT_GE(found.upper, expected) << size << ' ' << gap;
      EXPECT_NEAR(found.upper / size, expected / size, 1e-10) << size << ' ' << gap;
      EXPECT_FALSE(found.crossing);
      EXPECT_TRUE(is_finite(found.a.point) && is_finite(found.b.point));
      // Thresholds on both sides.
      EXPECT_FALSE(distance(a.collider, b.collider, {.stop_above = 2 * expected}).farther) << size << ' ' << gap;
    }
}

TEST(CollideAtScale, crossings_contacts_and_insides_are_found) {
  for (const double size : body_sizes) {
    const Cube a(size, {0, 0, 0}), b(size, {1, 0.75, 0.5});
    EXPECT_EQ(distance(a.collider, b.collider).upper, 0) << size;
    EXPECT_TRUE(distance(a.collider, b.collider).crossing) << size;
    EXPECT_TRUE(overlap(a.collider, b.collider)) << size;
    CrossingQuery pairs;
    ASSERT_TRUE(pairs.run(a.collider, b.collider));
    EXPECT_EQ(pairs.pairs().size(), brute_force::crossings(a.collider, b.collider).size()) << size;
    EXPECT_FALSE(pairs.pairs().empty()) << size;
    const Contacts found = collide(a.collider, b.collider, {.surfaces = true});
    EXPECT_FALSE(found.contacts.empty()) << size;
    for (const Contact& contact : found.contacts) {
      EXPECT_TRUE(is_finite(contact.point) && is_finite(contact.normal)) << size;
      EXPECT_FALSE(std::isnan(contact.depth) || std::isnan(contact.error_bound) || std::isnan(contact.lens_volume));
    }
  }
}

TEST(CollideAtScale, no_ray_slips_through) {
  for (const double size : body_sizes) {
    const Cube a(size, {0, 0, 0});
    for (const Vec3& target : {Vec3{0, 0, 0}, Vec3{0.5, 0.25, 0}, Vec3{-1, 0.125, 0}, Vec3{0.99, -0.99, 0}}) {
      const Vec3 start = Vec3{target.x, target.y, 3} * size;
      const RayHit hit = first_hit(a.collider, {start, {0, 0, -1}});
      ASSERT_TRUE(hit.first) << size << ' ' << target.x;
      EXPECT_NEAR(hit.first->t / size, 2, 1e-10) << size;
      EXPECT_NEAR(hit.first->point.point.z / size, 1, 1e-10) << size;
    }
    EXPECT_FALSE(first_hit(a.collider, {Vec3{1.5, 0, 3} * size, {0, 0, -1}}).first) << size;
  }
}

TEST(CollideAtScale, shapes_beside_bodies) {
  for (const double size : body_sizes) {
    const Cube a(size, {0, 0, 0});
    const Touch below = touch(a.collider, HalfSpace{{0, 0, 1}, -0.5 * size});
    EXPECT_TRUE(below.touches) << size;
    EXPECT_NEAR(below.deepest->depth / size, 0.5, 1e-6) << size;
    const Touch ball = touch(a.collider, Sphere{Vec3{0, 0, 3} * size, 2.5 * size});
    EXPECT_TRUE(ball.touches) << size;
    EXPECT_NEAR(ball.deepest->depth / size, 0.5, 1e-6) << size;
    const Touch beside = touch(a.collider, Sphere{Vec3{0, 0, 3} * size, 1.5 * size}, {.nearest = true});
    EXPECT_FALSE(beside.touches) << size;
    EXPECT_LE(beside.lower, 0.5 * size) << size;
    EXPECT_NEAR(beside.deepest->depth / size, -0.5, 1e-6) << size;
  }
}

TEST(CollideAtScale, bodies_as_far_apart_as_double_goes_give_numbers) {
  Cube a(1, {0, 0, 0}), b(1, {0, 0, 0});
  for (const double far : {1e20, 1e60, 1e150, 1e160, 1e200, 1e300, 1e307}) {
    a.collider.set_transform({{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}, {far, -far, 0}});
    for (const Contact& contact : collide(a.collider, b.collider).contacts) {
      EXPECT_TRUE(is_finite(contact.point)) << far;
      EXPECT_FALSE(std::isnan(contact.normal.x) || std::isnan(contact.depth) || std::isnan(contact.lens_volume)) << far;
    }
    // Both there: as far as digits tell, they may be anywhere in it.
    b.collider.set_transform(a.collider.transform());
    const Contacts there = collide(a.collider, b.collider);
    EXPECT_FALSE(there.contacts.empty()) << far;
    for (const Contact& contact : there.contacts) EXPECT_GE(contact.error_bound, 0x1p-48 * far) << far;
    b.collider.set_transform({});
  }
}

}  // namespace
}  // namespace morula
