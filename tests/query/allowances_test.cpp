// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What an index leaves out, at its limit: nothing may be missing because rounding made a bound too sharp.
// scripts/mutants takes the allowances away, one after the other.
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/geometry/reproducible.hpp>
#include <morula/query/power_diagram.hpp>
#include <morula/query/triangle_bvh.hpp>
#include <scenes/brute_force.hpp>

namespace morula {
namespace {

Vec3 random_vector(Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  return {x, y, random.uniform(-1, 1)};
}

// Triangles that are hardly more than a point: the bound of a sphere's power and what another one guarantees are the
// same number, rounded in two ways.
TEST(PowerDiagramAllowance, candidates_hold_the_owner_where_bounds_are_tight) {
  Random random(1);
  std::vector<std::uint32_t> candidates;
  for (int round = 0; round < 4000; ++round) {
    std::vector<Sphere> spheres;
    const Vec3 x = random_vector(random);
    const bool alike = round % 2 == 0;  // all as far from x as their radii, but for a little
    for (int i = 0; i < 40; ++i) {
      const Vec3 center = random_vector(random);
      spheres.push_back(
          {center, alike ? distance(center, x) * (1 + random.uniform(-4, 4) * 0x1p-52) : random.uniform(0, 1.5)});
    }
    const PowerDiagram diagram(spheres);
    const double size = round % 3 == 0 ? 0 : 0x1p-50;
    const Triangle t{x, x + size * random_vector(random), x + size * random_vector(random)};
    diagram.candidates(t, candidates);
    for (const Vec3& corner : t) {
      std::uint32_t owner = 0;
      for (std::uint32_t i = 1; i < spheres.size(); ++i)
        if (power(spheres[i], corner) < power(spheres[owner], corner)) owner = i;
      ASSERT_TRUE(std::binary_search(candidates.begin(), candidates.end(), owner)) << round;
    }
  }
}

TEST(PowerDiagramAllowance, of_equals_the_lowest_index_owns_and_grows) {
  Random random(4);
  for (int round = 0; round < 100; ++round) {
    const Sphere ball{random_vector(random), random.uniform(0, 1)};
    const std::vector<Sphere> copies(40, ball);
    const PowerDiagram diagram(copies);
    const std::vector<Vec3> points{random_vector(random), random_vector(random)};
    EXPECT_EQ(diagram.owner(points[0]), 0u);
    EXPECT_EQ(diagram.least_growth(points).sphere, 0u);
  }
}

// A facet in the bisector of two spheres, but for rounding: cutting it would only make slivers.
TEST(PowerDiagramAllowance, a_facet_in_a_bisector_stays_whole) {
  Random random(5);
  std::vector<std::uint32_t> scratch;
  CutFacet cut;
  for (int round = 0; round < 2000; ++round) {
    const Vec3 normal = normalized(random_vector(random)), middle = random_vector(random);
    const double apart = random.uniform(0.1, 1);
    const std::vector<Sphere> spheres{{middle - apart * normal, 1}, {middle + apart * normal, 1}};
    FacetGeometry facet{{}, {0, 1, 2}};
    for (Vec3& p : facet.corners) p = middle + cross(normal, random_vector(random));
    cut.clear();
    PowerDiagram(spheres).cut(facet, scratch, cut);
    ASSERT_EQ(cut.size(), 1u) << round;
  }
}

// Copies of one facet, strewn over many leaves: all are as near, so a bound that is too sharp by the last bit hides the
// first of them. From near by, where the nearest point is rounded out of the box, and from straight above and far away.
TEST(TriangleBvhAllowance, prunes_no_copy_of_the_nearest_facet) {
  Random random(3);
  for (int round = 0; round < 150; ++round) {
    Mesh mesh;
    const Vec3 about = 3.0 * random_vector(random);
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(about + random_vector(random));
    mesh.facets.assign(40, {0, 1, 2});
    const TriangleBvh bvh(mesh);
    const Triangle t = mesh.corners(0);
    const Vec3 normal = normalized(area_vector(t));
    for (int i = 0; i < 60; ++i) {
      const double a = random.uniform(0, 0.5), b = random.uniform(0, 0.5);
      const Vec3 above = at_barycentric(t, {1 - a - b, a, b}) + random.uniform(1, 1e6) * normal;
      const Vec3 p = i % 2 == 0 ? about + 4.0 * random_vector(random) : above;
      ASSERT_EQ(bvh.closest_point(p)->facet, 0u) << round;
    }
  }
}

// Leaves of the index that are flat and seen from within their plane's rounding, near and far.
TEST(TriangleBvhAllowance, prunes_no_facet_that_is_nearest_as_computed) {
  Random random(2);
  for (int round = 0; round < 300; ++round) {
    const Vec3 away = round % 2 == 0 ? Vec3{} : 1e3 * random_vector(random);
    Mesh mesh;
    const Vec3 u = random_vector(random), w = random_vector(random);
    for (std::uint32_t f = 0; f < 40; ++f) {
      // Strewn over one plane and its neighborhood of a few units in the last place.
      for (int k = 0; k < 3; ++k)
        mesh.positions.push_back(away + random.uniform(-1, 1) * u + random.uniform(-1, 1) * w);
      mesh.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    }
    const TriangleBvh bvh(mesh);
    for (int i = 0; i < 60; ++i) {
      const double height = i % 3 == 0 ? 0.0 : i % 3 == 1 ? 0x1p-40 : 3.0;
      const Vec3 p =
          away + random.uniform(-1.5, 1.5) * u + random.uniform(-1.5, 1.5) * w + height * random_vector(random);
      const ClosestFacetPoint expected = brute_force::closest_point(mesh, p);
      const auto found = bvh.closest_point(p);
      ASSERT_TRUE(found);
      ASSERT_EQ(found->facet, expected.facet) << round;
      ASSERT_EQ(found->squared_distance, expected.squared_distance) << round;
    }
  }
}

}  // namespace
}  // namespace morula
