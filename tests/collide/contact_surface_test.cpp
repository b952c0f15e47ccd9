// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/facets/contact_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <morula/collide/crossings.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <support/meshes.hpp>
#include <support/transforms.hpp>

#include "simd/processors.hpp"

namespace morula {
using namespace detail;
namespace {

/// A mesh that was bent out of shape, with its collider somewhere in the world.
struct Subject {
  Mesh mesh;
  CoveredTree model;
  Body body;
  std::vector<Vec3> positions;
  Collider collider;

  explicit Subject(Mesh of, double noise = 0.05, double reach = 3)
      : mesh(std::move(of)),
        model(build(mesh, {.method = Method::octree, .branching = 8, .depth = 2})),
        body(mesh, model),
        positions(deform(mesh, {Noise{noise, 0.4}}, 1)),
        collider(mesh, body) {
    Random random(mesh.facet_count());
    EXPECT_TRUE(body.update(positions));
    collider.set_positions(positions);
    collider.set_transform(test::random_transform(random, reach));
  }
  Subject(const Subject&) = delete;
};

void expect_same(const SurfacePoint& found, const SurfacePoint& expected) {
  ASSERT_EQ(found.facet, expected.facet);
  ASSERT_EQ(found.barycentric, expected.barycentric);
  ASSERT_EQ(found.point, expected.point);
}

/// All facets of the node, looked at one by one in the body's own coordinates.
SurfacePoint by_brute_force(const Collider& collider, std::uint32_t node, const Vec3& point) {
  const RigidTransform& transform = collider.transform();
  const Vec3 p = transform.inverse_rotate(point - transform.translation);
  TrianglePoint nearest{{}, {}, std::numeric_limits<double>::infinity()};
  std::uint32_t nearest_one = 0;
  for (const std::uint32_t facet : collider.facets(node)) {
    const TrianglePoint found = closest_point(collider.surface().corners(facet), p);
    if (found.squared_distance > nearest.squared_distance) continue;
    if (found.squared_distance == nearest.squared_distance && facet > nearest_one) continue;
    nearest = found, nearest_one = facet;
  }
  return {nearest_one, nearest.barycentric, transform(nearest.point)};
}

TEST(NearestFacet, equals_brute_force_bit_for_bit_on_all_nodes) {
  SurfaceScratch scratch;
  for (const test::NamedMesh& named : test::all_meshes()) {
    if (named.mesh.facet_count() > 1500) continue;
    for (const double reach : {1.0, 1e6}) {
      const Subject one(named.mesh, 0.05, reach);
      scratch.start(one.collider, one.collider);
      const std::size_t nodes = one.model.tree.node_count();
      Random random(1);
      for (int round = 0; round < 150; ++round) {
        const auto node = round == 0 ? 0 : static_cast<std::uint32_t>(random.next() % nodes);
        const Sphere s = one.body.sphere(node);
        // Inside the sphere, commonly; on the surface; far away.
        Vec3 p = one.collider.transform()(s.center + test::random_transform(random, s.radius).translation);
        const Triangle t = one.collider.triangle(one.collider.facets(node)[0]);
        if (round % 5 == 1) p = t[0] * 0.25 + t[1] * 0.75;
        if (round % 5 == 2) p = t[2];
        if (round % 10 == 3) p = p + (p - t[0]) * std::pow(10.0, random.uniform(0, 12));
        ASSERT_NO_FATAL_FAILURE(
            expect_same(nearest_facet(one.collider, node, p, scratch), by_brute_force(one.collider, node, p)))
            << named.name << " node " << node;
      }
    }
  }
}

// Every facet of a ball is as far from the center, to a few bits, and all those at a pole meet in one point.
TEST(NearestFacet, of_equals_is_the_lowest) {
  const Mesh ball = test::uv_sphere(24, 12);
  const Body body(ball, build(ball, {.method = Method::octree, .branching = 8, .depth = 2}));
  const Collider collider(ball, body);
  SurfaceScratch scratch;
  scratch.start(collider, collider);
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{0, 0, 2}, Vec3{0, 0, -1}, Vec3{1e9, 0, 0}}) {
    const SurfacePoint found = nearest_facet(collider, 0, p, scratch);
    ASSERT_NO_FATAL_FAILURE(expect_same(found, by_brute_force(collider, 0, p)));
    for (std::uint32_t f = 0; f < found.facet; ++f)
      ASSERT_GT(closest_point(ball.corners(f), p).squared_distance,
                closest_point(ball.corners(found.facet), p).squared_distance);
  }
}

TEST(NearestFacet, point_is_where_its_barycentric_coordinates_say) {
  const Subject one(sample_body("limb", 14));
  SurfaceScratch scratch;
  scratch.start(one.collider, one.collider);
  const SurfacePoint found = nearest_facet(one.collider, 0, {0.1, 0.2, 0.3}, scratch);
  EXPECT_LE(distance(found.point, at_barycentric(one.collider.triangle(found.facet), found.barycentric)), 1e-12);
}

TEST(RegionMeanNormal, is_that_of_owned_patches) {
  const Subject one(sample_body("torus", 14));
  SurfaceScratch scratch;
  scratch.start(one.collider, one.collider);
  const Cover& cover = one.model.cover;
  for (std::uint32_t node = 0; node < one.model.tree.node_count(); ++node) {
    // Patches cut into triangles where they are now.
    Vec3 area_vectors{};
    double area_sum = 0;
    for (std::uint32_t patch = cover.region_begin[node]; patch < cover.region_end[node]; ++patch) {
      const auto corners = cover.patch(patch);
      const auto at = [&](std::size_t k) {
        return one.collider.transform()(corner_position(cover, corners[k], one.positions));
      };
      for (std::size_t k = 2; k < corners.size(); ++k) {
        const Triangle t{at(0), at(k - 1), at(k)};
        area_vectors += area_vector(t) * 0.5;
        area_sum += area(t);
      }
    }
    EXPECT_LE(distance(mean_normal(one.collider, node, scratch), area_vectors / area_sum), 1e-5);
  }
}

// What "apart" and "depth" promise: along the direction asked for, every corner of the region is within reach.
TEST(RegionReach, contains_the_region_and_no_more_than_the_sphere) {
  const Subject one(sample_body("limb", 14), 0.05, 100);
  SurfaceScratch scratch;
  scratch.start(one.collider, one.collider);
  Random random(7);
  for (std::uint32_t node = 0; node < one.model.tree.node_count(); ++node) {
    const Vec3 direction = normalized(test::random_transform(random, 1).translation);
    const double reach = region_reach(one.collider, node, direction, scratch);
    double farthest = -1e300;
    for (const std::uint32_t corner : one.model.cover.region_corners(node))
      farthest = std::max(
          farthest, dot(one.collider.transform()(corner_position(one.model.cover, corner, one.positions)), direction));
    EXPECT_GE(reach, farthest);
    const Sphere s = one.body.sphere(node);
    EXPECT_LE(reach, dot(one.collider.transform()(s.center), direction) + s.radius * (1 + 1e-8) + 1e-11);
  }
}

struct SphereContact {
  Vec3 point, normal;
  double depth;
};
SphereContact contact_of(const Collider& a, std::uint32_t node_a, const Collider& b, std::uint32_t node_b) {
  const Sphere sa = a.sphere_state().sphere(node_a), sb = b.sphere_state().sphere(node_b);
  const Vec3 ca = a.transform()(sa.center), cb = b.transform()(sb.center);
  const double apart = distance(ca, cb);
  const Vec3 n = normalized(ca - cb);
  return {cb + n * ((apart + sb.radius - sa.radius) / 2), n, sa.radius + sb.radius - apart};
}

// Leaf pairs whose corrected depth is 0 are apart: none of them owns a true crossing alone.
TEST(ContactSurface, depth_lies_between_nothing_and_that_of_the_spheres_and_is_0_only_apart) {
  Subject one(sample_body("limb", 14)), two(sample_body("torus", 14));
  SurfaceScratch scratch;
  Random random(3);
  std::size_t contacts = 0, apart = 0;
  for (int pose = 0; pose < 6; ++pose) {
    one.collider.set_transform(test::random_transform(random, 0.3));
    two.collider.set_transform(test::random_transform(random, 0.3));
    scratch.start(one.collider, two.collider);
    std::vector<NodePair> close;
    for (std::uint32_t i = 0; i < one.model.tree.node_count(); ++i)
      for (std::uint32_t j = 0; j < two.model.tree.node_count(); ++j) {
        if (!one.model.tree.is_leaf(i) || !two.model.tree.is_leaf(j)) continue;
        const SphereContact c = contact_of(one.collider, i, two.collider, j);
        if (c.depth <= 0) continue;
        ++contacts;
        const ContactSurface s = contact_surface(one.collider, i, two.collider, j, c.point, c.normal, c.depth, scratch);
        ASSERT_GE(s.depth, 0);
        ASSERT_LE(s.depth, c.depth);
        ASSERT_NEAR(length(s.normal), 1, 1e-12);
        expect_same(s.on_a, by_brute_force(one.collider, i, c.point));
        expect_same(s.on_b, by_brute_force(two.collider, j, c.point));
        if (s.depth > 0)
          close.push_back({i, j});
        else
          ++apart;
      }
    // Pairs of depth 0 can be left out, and nothing is lost.
    CrossingQuery all, kept;
    ASSERT_TRUE(all.run(one.collider, two.collider));
    ASSERT_TRUE(kept.run(one.collider, two.collider, close));
    ASSERT_EQ(kept.pairs().size(), all.pairs().size());
  }
  EXPECT_GT(contacts, 100u);
  EXPECT_GT(apart, 20u);
}

TEST(ContactSurface, of_two_boxes_has_their_normal_and_depth) {
  // One on the other and 0.01 into it: the centers of their spheres lie in the sides that touch.
  const Mesh lower = test::box_mesh({-1, -1, -2}, {1, 1, 0}, 8), upper = test::box_mesh({-1, -1, 0}, {1, 1, 2}, 8);
  const BuildOptions options{.method = Method::octree, .branching = 8, .depth = 3};
  const Body body_b(lower, build(lower, options)), body_a(upper, build(upper, options));
  const Collider b(lower, body_b);
  Collider a(upper, body_a);
  a.set_transform({.translation = {0.05, 0.03, -0.01}});
  SurfaceScratch scratch;
  scratch.start(a, b);
  std::size_t flat = 0;
  for (std::uint32_t i = 0; i < body_a.spheres().size(); ++i)
    for (std::uint32_t j = 0; j < body_b.spheres().size(); ++j) {
      if (!body_a.rest_tree().is_leaf(i) || !body_b.rest_tree().is_leaf(j)) continue;
      const Vec3 normal_a = mean_normal(a, i, scratch), normal_b = mean_normal(b, j, scratch);
      const SphereContact c = contact_of(a, i, b, j);
      // Leaves in the middle of the sides that touch.
      if (c.depth <= 0 || normal_a.z > -0.999999 || normal_b.z < 0.999999) continue;
      ++flat;
      const ContactSurface s = contact_surface(a, i, b, j, c.point, c.normal, c.depth, scratch);
      EXPECT_NEAR(s.normal.z, 1, 1e-6);
      EXPECT_LE(s.depth, 0.01 + 1e-5);
      EXPECT_NEAR(s.on_b.point.z, 0, 1e-12);
      EXPECT_NEAR(s.on_a.point.z, -0.01, 1e-12);
    }
  EXPECT_GT(flat, 10u);
}

TEST(FacetKernels, give_the_bits_of_plain_loops) {
  Random random(3);
  std::vector<float> columns[9];
  FacetColumns list{{}, 64};
  for (std::size_t k = 0; k < 9; ++k) {
    for (std::size_t i = 0; i < 64; ++i) columns[k].push_back(static_cast<float>(random.uniform(-1, 1)));
    list.column[k] = columns[k].data();
  }
  for (int round = 0; round < 50; ++round) {
    const Vec3f p(test::random_transform(random, 2).translation);
    std::vector<float> expected(64), other(64);
    const float least = all_facet_kernels().front().squared_gaps(list, p, expected.data());
    const float reach = all_facet_kernels().front().reach(list, p);
    for (std::size_t kind = 0; kind < all_facet_kernels().size(); ++kind) {
      const FacetKernels& kernels = all_facet_kernels()[kind];
      ASSERT_EQ(kernels.squared_gaps(list, p, other.data()), least) << kind_name(kind);
      ASSERT_EQ(other, expected) << kind_name(kind);
      ASSERT_EQ(kernels.reach(list, p), reach) << kind_name(kind);
      for (std::size_t i = 0; i < facet_columns_step; ++i)
        for (const float limit : {expected[i], std::nextafter(expected[i], 0.0f)}) {
          const unsigned bits = kernels.at_most(expected.data(), limit);
          for (std::size_t j = 0; j < facet_columns_step; ++j)
            ASSERT_EQ((bits >> j & 1u) != 0, expected[j] <= limit) << kind_name(kind);
          ASSERT_EQ(bits >> facet_columns_step, 0u) << kind_name(kind);
        }
    }
  }
}

}  // namespace
}  // namespace morula
