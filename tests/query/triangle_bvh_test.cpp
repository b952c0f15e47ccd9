// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/query/triangle_bvh.hpp>
#include <scenes/brute_force.hpp>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

#include "points.hpp"

namespace morula {
namespace {

using test::all_meshes;
using test::closed_meshes;
using test::facet_soup;
using test::hard_points;
using test::icosphere;

using test::infinity;

void expect_same(const ClosestFacetPoint& found, const ClosestFacetPoint& expected) {
  EXPECT_EQ(found.facet, expected.facet);
  EXPECT_EQ(found.point, expected.point);
  EXPECT_EQ(found.barycentric, expected.barycentric);
  EXPECT_EQ(found.squared_distance, expected.squared_distance);
}

// Every question that has an exact answer, against the answer of looking at all facets.
void expect_matches_brute_force(const Mesh& mesh, std::size_t count, std::uint64_t seed) {
  const TriangleBvh bvh(mesh);
  ASSERT_EQ(bvh.facet_count(), mesh.facet_count());
  Random random(seed);
  std::vector<std::uint32_t> touching{17, 4};
  for (const Vec3& p : hard_points(mesh, count, seed)) {
    SCOPED_TRACE(testing::Message() << "point " << p.x << ' ' << p.y << ' ' << p.z);
    const ClosestFacetPoint expected = brute_force::closest_point(mesh, p);
    const std::optional<ClosestFacetPoint> found = bvh.closest_point(p);
    ASSERT_TRUE(found.has_value());
    expect_same(*found, expected);

    const double distance = std::sqrt(expected.squared_distance);
    EXPECT_FALSE(bvh.closest_point(p, distance * 0.999 - 1e-300).has_value());
    const std::optional<ClosestFacetPoint> within = bvh.closest_point(p, distance * 1.001 + 1e-300);
    ASSERT_TRUE(within.has_value());
    expect_same(*within, expected);

    for (const double radius : {0.0, distance, distance * (1 + random.uniform()), -1.0}) {
      bvh.facets_touching({p, radius}, touching);
      EXPECT_EQ(touching, brute_force::facets_touching(mesh, {p, radius}));
    }
    // Sums in another order, with solid angles up to 2π.
    const double tolerance = 1e-15 * static_cast<double>(mesh.facet_count()) + 1e-14;
    EXPECT_NEAR(bvh.winding_number(p, infinity), brute_force::winding_number(mesh, p), tolerance);
  }
}

TEST(TriangleBvh, matches_brute_force_on_every_kind_of_mesh) {
  for (const test::NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    expect_matches_brute_force(named.mesh, named.mesh.facet_count() > 1000 ? 60 : 150, 11);
  }
}

TEST(TriangleBvh, matches_brute_force_on_facet_soups) {
  for (const std::size_t count : {1u, 2u, 3u, 4u, 5u, 7u, 16u, 17u, 63u, 300u}) {
    SCOPED_TRACE(count);
    expect_matches_brute_force(facet_soup(count, count), 60, count);
  }
}

TEST(TriangleBvh, matches_brute_force_above_the_size_that_is_built_in_parts) {
  const Mesh mesh = test::joined(sample_body("torus", 60), facet_soup(900, 5));
  ASSERT_GT(mesh.facet_count(), 4096u);
  expect_matches_brute_force(mesh, 60, 3);
}

TEST(TriangleBvh, matches_brute_force_far_from_the_origin) {
  for (const double far : {1e3, 1e6, 1e9}) {
    SCOPED_TRACE(far);
    expect_matches_brute_force(test::translated(icosphere(2), {far, -2 * far, far / 3}), 150, 5);
  }
}

TEST(TriangleBvh, takes_the_lowest_facet_among_equals) {
  // More copies than one chunk of the build, so that the copies lie in many subtrees.
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::vector<Facet>(10000, Facet{0, 1, 2})};
  const TriangleBvh copies(mesh);
  for (const Vec3& p : hard_points(mesh, 60, 1)) EXPECT_EQ(copies.closest_point(p)->facet, 0u);

  // Around a vertex of a fine cube many facets are equally near.
  const Mesh cube = test::box_mesh({0, 0, 0}, {1, 1, 1}, 8);
  const TriangleBvh bvh(cube);
  for (const Vec3& vertex : cube.positions) {
    const Vec3 above = vertex + (vertex - Vec3{0.5, 0.5, 0.5});
    expect_same(*bvh.closest_point(above), brute_force::closest_point(cube, above));
    expect_same(*bvh.closest_point(vertex), brute_force::closest_point(cube, vertex));
  }
}

TEST(TriangleBvh, distance_limit_includes_its_own_distance) {
  const TriangleBvh bvh(test::box_mesh({0, 0, 0}, {1, 1, 1}, 3));
  const Vec3 p{0.3, 0.4, 3};
  EXPECT_TRUE(bvh.closest_point(p, 2).has_value());
  EXPECT_FALSE(bvh.closest_point(p, std::nextafter(2.0, 0.0)).has_value());
  EXPECT_TRUE(bvh.closest_point({0, 0, 0}, 0).has_value());
  EXPECT_FALSE(bvh.closest_point({0, 0, 0}, -0.1).has_value());
  EXPECT_FALSE(bvh.closest_point({std::nan(""), 0, 0}).has_value());
}

TEST(TriangleBvh, keeps_the_facets_as_they_were_given) {
  const Mesh mesh = sample_body("blob", 40);
  TriangleBvh first(mesh);
  const TriangleBvh bvh(std::move(first));
  EXPECT_EQ(bvh.bounding_box().lower, bounding_box(mesh).lower);
  EXPECT_EQ(bvh.bounding_box().upper, bounding_box(mesh).upper);
  for (std::uint32_t f = 0; f < mesh.facet_count(); ++f) EXPECT_EQ(bvh.triangle(f), mesh.corners(f));
}

TEST(TriangleBvh, facets_without_area_are_segments_and_points) {
  Mesh mesh = test::joined(icosphere(1), Mesh{{{2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {5, 5, 5}, {5, 5, 5}, {5, 5, 5}},
                                              {{0, 1, 2}, {2, 1, 0}, {3, 4, 5}, {3, 3, 3}}});
  expect_matches_brute_force(mesh, 150, 9);
  const TriangleBvh bvh(mesh);
  EXPECT_EQ(bvh.closest_point({3.3, 1, 0})->squared_distance, 1.0);
  EXPECT_EQ(bvh.closest_point({6, 5, 5})->squared_distance, 1.0);
}

TEST(TriangleBvh, survives_meshes_whose_facets_shrink_without_end) {
  // Each facet half the size of the one before, down to the smallest numbers: binned splits peel off a few at a time.
  Mesh mesh;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const double s = std::ldexp(1.0, -static_cast<int>(i));
    mesh.positions.insert(mesh.positions.end(), {Vec3{s, 0, 0}, Vec3{s, s, 0}, Vec3{s * 0.75, 0, s}});
    mesh.facets.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  expect_matches_brute_force(mesh, 60, 2);
  // The same, many times over, so that the tree must go deep as well.
  const Mesh once = mesh;
  for (int copy = 0; copy < 9; ++copy) mesh = test::joined(mesh, once);
  expect_matches_brute_force(mesh, 12, 4);
}

TEST(TriangleBvh, has_the_same_bits_for_any_number_of_workers) {
  const Mesh mesh = icosphere(5);
  const TriangleBvh alone(mesh);
  const std::vector<Vec3> points = hard_points(mesh, 300, 8);
  for (const unsigned count : {2u, 3u, 8u}) {
    Workers workers(count);
    const TriangleBvh shared(mesh, workers);
    // The approximation depends on the tree's every node.
    for (const Vec3& p : points) EXPECT_EQ(shared.winding_number(p), alone.winding_number(p));
  }
}

TEST(TriangleBvh, winding_number_is_near_the_exact_one) {
  for (const test::NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    const TriangleBvh bvh(named.mesh);
    double worst = 0, worst_at_4 = 0;
    for (const Vec3& p : hard_points(named.mesh, 90, 21)) {
      const double exact = brute_force::winding_number(named.mesh, p);
      worst = std::max(worst, std::abs(bvh.winding_number(p) - exact));
      worst_at_4 = std::max(worst_at_4, std::abs(bvh.winding_number(p, 4) - exact));
    }
    EXPECT_LT(worst, 0.05);
    EXPECT_LT(worst_at_4, 0.005);
  }
}

TEST(TriangleBvh, winding_number_counts_layers) {
  // Shells turned in and out by turns: large areas whose far fields cancel.
  Mesh onion = icosphere(2);
  for (int layer = 1; layer < 30; ++layer) {
    const Mesh shell = icosphere(2, 1 - 0.02 * layer);
    onion = test::joined(onion, layer % 2 == 1 ? test::inverted(shell) : shell);
  }
  const TriangleBvh bvh(onion);
  Random random(6);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = test::random_direction(random) * random.uniform(0, 1.5);
    EXPECT_NEAR(bvh.winding_number(p), brute_force::winding_number(onion, p), 0.15);
  }
  const TriangleBvh three_shells(test::joined(test::joined(icosphere(2), icosphere(2, 0.5)), icosphere(2, 0.25)));
  EXPECT_NEAR(three_shells.winding_number({0, 0, 0}), 3, 0.25);
  EXPECT_NEAR(three_shells.winding_number({0, 0, 0}, 8), 3, 0.005);
}

}  // namespace
}  // namespace morula
