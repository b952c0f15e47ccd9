// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <geometry/enclosing/sphere_support.hpp>
#include <limits>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sampling.hpp>
#include <vector>

namespace morula {
namespace {

std::vector<Vec3> random_points(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back({random.uniform(-1, 1), random.uniform(-2, 2), random.uniform(-0.5, 0.5)});
  return points;
}

// Bădoiu and Clarkson: stepping towards the farthest point by 1/(k+1) converges to the smallest sphere's center; the
// radius is within 1/√k of it. Slow and obvious.
double radius_by_stepping(std::span<const Vec3> points, int steps) {
  Vec3 center = points[0];
  double best = farthest_distance(center, points);
  for (int k = 1; k <= steps; ++k) {
    Vec3 far = points[0];
    for (const Vec3& p : points)
      if (squared_distance(p, center) > squared_distance(far, center)) far = p;
    center += (far - center) / static_cast<double>(k + 1);
    best = std::min(best, farthest_distance(center, points));
  }
  return best;
}

TEST(EnclosingSphere, contains_all_points_and_is_as_small_as_stepping_finds) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const std::vector<Vec3> points = random_points(3 + seed * 7, seed);
    const Sphere s = enclosing_sphere(points);
    EXPECT_EQ(s.radius, farthest_distance(s.center, points));
    const double other = radius_by_stepping(points, 20000);
    EXPECT_LE(s.radius, other * (1 + 1e-9));
    EXPECT_GE(s.radius, other * (1 - 1e-3));
  }
}

TEST(EnclosingSphere, is_the_known_one_for_exact_shapes) {
  const std::vector<Vec3> two{{1, 2, 3}, {1, 2, 7}};
  EXPECT_EQ(enclosing_sphere(two), (Sphere{{1, 2, 5}, 2}));
  std::vector<Vec3> cube;
  for (int i = 0; i < 8; ++i) cube.push_back({i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0});
  const Sphere around_cube = enclosing_sphere(cube);
  EXPECT_NEAR(around_cube.radius, std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(length(around_cube.center), 0, 1e-14);
  // An obtuse triangle is spanned by its longest side.
  const std::vector<Vec3> obtuse{{0, 0, 0}, {4, 0, 0}, {1, 0.5, 0}};
  EXPECT_NEAR(enclosing_sphere(obtuse).radius, 2, 1e-14);
}

TEST(EnclosingSphere, finds_a_unit_sphere_from_points_on_it_anywhere_and_at_any_scale) {
  for (const double scale : {1e-6, 1.0, 1e6})
    for (const double offset : {0.0, 1e6}) {
      std::vector<Vec3> points;
      const Vec3 center{offset * scale, -offset * scale, 0.5 * scale};
      for (const Vec3& d : fibonacci_directions(500)) points.push_back(center + d * scale);
      const Sphere s = enclosing_sphere(points);
      // Any closed hemisphere of samples misses the poles by about one spacing, hence the loose center.
      EXPECT_NEAR(s.radius / scale, 1, 1e-4);
      EXPECT_LT(distance(s.center, center) / scale, 1e-2);
    }
}

// The smallest of the circumspheres of all sets of one to four points that contains them all, each found by Gaussian
// elimination on the equations of its center.
double radius_by_all_subsets(std::span<const Vec3> points) {
  double least = std::numeric_limits<double>::infinity();
  const std::size_t n = points.size();
  for (unsigned subset = 1; subset < 1u << n; ++subset) {
    std::vector<Vec3> on;
    for (std::size_t i = 0; i < n; ++i)
      if (subset >> i & 1u) on.push_back(points[i]);
    if (on.size() > 4) continue;
    // The center is on[0] + Σ weight_j edge_j, as far from on[0] as from each: Σ 2 edge_i·edge_j weight_j = edge_i².
    const std::size_t m = on.size() - 1;
    std::vector<std::vector<long double>> rows(m, std::vector<long double>(m + 1));
    const auto edge = [&](std::size_t i) { return on[i + 1] - on[0]; };
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t j = 0; j < m; ++j) rows[i][j] = 2 * static_cast<long double>(dot(edge(i), edge(j)));
      rows[i][m] = static_cast<long double>(dot(edge(i), edge(i)));
    }
    bool is_independent = true;
    for (std::size_t column = 0; column < m && is_independent; ++column) {
      std::size_t pivot = column;
      for (std::size_t i = column; i < m; ++i)
        if (std::abs(rows[i][column]) > std::abs(rows[pivot][column])) pivot = i;
      std::swap(rows[pivot], rows[column]);
      is_independent = std::abs(rows[column][column]) > 1e-9L;
      for (std::size_t i = 0; i < m && is_independent; ++i) {
        if (i == column) continue;
        const long double share = rows[i][column] / rows[column][column];
        for (std::size_t j = 0; j <= m; ++j) rows[i][j] -= share * rows[column][j];
      }
    }
    if (!is_independent) continue;
    Vec3 center = on[0];
    for (std::size_t i = 0; i < m; ++i) center += edge(i) * static_cast<double>(rows[i][m] / rows[i][i]);
    double radius = 0;
    for (const Vec3& p : points) radius = std::max(radius, distance(center, p));
    if (radius <= distance(center, on[0]) * (1 + 1e-9)) least = std::min(least, radius);
  }
  return least;
}

TEST(EnclosingSphere, is_the_smallest_of_few_points_on_a_coarse_lattice) {
  // Points that repeat, lie on lines, in planes and on spheres together.
  Random random(7);
  for (int i = 0; i < 3000; ++i) {
    const std::size_t count = 2 + random.next() % 9;
    const int side = 1 + static_cast<int>(random.next() % 3), flat = static_cast<int>(random.next() % 3);
    std::vector<Vec3> points;
    for (std::size_t k = 0; k < count; ++k) {
      Vec3 p;
      for (int axis = 0; axis < 3 - flat; ++axis)
        p[axis] = static_cast<double>(random.next() % (static_cast<std::uint64_t>(side) + 1));
      points.push_back(p);
    }
    const double smallest = radius_by_all_subsets(points);
    EXPECT_NEAR(enclosing_sphere(points).radius, smallest, 1e-9 * (1 + smallest)) << i;
  }
}

struct PointLists {
  std::vector<double> x, y, z;
  explicit PointLists(std::span<const Vec3> points) {
    for (const Vec3& p : points) x.push_back(p.x), y.push_back(p.y), z.push_back(p.z);
  }
  detail::DoublePointColumns columns() const { return {x.data(), y.data(), z.data(), x.size()}; }
};

TEST(EnclosingSphere, of_a_set_that_grows_is_as_small_as_that_found_at_once) {
  // Sets that are doubled again and again, on a lattice so coarse that points repeat and lie on lines and spheres
  // together; every fourth point of some sets is so far away that squares overflow, or vanish beside the others.
  Random random(8);
  for (int i = 0; i < 2000; ++i) {
    const int side = 1 + static_cast<int>(random.next() % 9);
    const double unit = i % 4 == 0 ? 1e-170 : 1, far = i % 4 == 1 ? 1e200 : 1;
    detail::SupportedSphere grown;
    std::vector<Vec3> points;
    for (const std::size_t count : {2, 4, 8, 16, 32}) {
      while (points.size() < count) {
        Vec3 p;
        for (int axis = 0; axis < 3; ++axis)
          p[axis] = unit * static_cast<double>(random.next() % (static_cast<std::uint64_t>(side) + 1));
        points.push_back(points.size() % 4 == 3 ? p * far : p);
      }
      grown = detail::enclosing_sphere_from(grown, PointLists(points).columns());
      const Sphere at_once = enclosing_sphere(points);
      ASSERT_NEAR(grown.sphere.radius / unit, at_once.radius / unit, 1e-9 * at_once.radius / unit) << i << ' ' << count;
      ASSERT_NEAR(grown.sphere.radius, farthest_distance(grown.sphere.center, points), 1e-15 * at_once.radius);
      ASSERT_LE(grown.count, 4u);
      for (std::size_t k = 0; k < grown.count; ++k)
        ASSERT_NEAR(distance(grown.points[k], grown.sphere.center), grown.sphere.radius, 1e-9 * at_once.radius);
    }
  }
}

TEST(EnclosingSphere, survives_degenerate_sets) {
  EXPECT_EQ(enclosing_sphere({}), (Sphere{}));
  const std::vector<Vec3> one{{3, 4, 5}};
  EXPECT_EQ(enclosing_sphere(one), (Sphere{{3, 4, 5}, 0}));
  const std::vector<Vec3> same(100, Vec3{1, 1, 1});
  EXPECT_EQ(enclosing_sphere(same).radius, 0);
  std::vector<Vec3> line;
  for (int i = 0; i <= 100; ++i) line.push_back({0.1 * i, 0.2 * i, -0.3 * i});
  EXPECT_NEAR(enclosing_sphere(line).radius, 0.5 * length(line.back()), 1e-12);
  std::vector<Vec3> circle;  // cospherical and coplanar: every triple supports the same sphere
  for (const Vec3& d : fibonacci_directions(64)) circle.push_back(normalized(Vec3{d.x, d.y, 0}));
  EXPECT_NEAR(enclosing_sphere(circle).radius, 1, 1e-3);
}

}  // namespace
}  // namespace morula
