// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trees that have to cover within a tolerance only.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <generators/driver/union_volume.hpp>
#include <generators/fit/outside_grid.hpp>
#include <limits>
#include <morula/accuracy/looseness.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/query/signed_distance.hpp>
#include <support/meshes.hpp>
#include <support/sampled_distance.hpp>

namespace morula {
namespace {

using test::sampled_distance;

std::vector<Sphere> leaves(const SphereTree& tree) {
  return level_set_spheres(tree, tree.level_count() - 1);
}

double extent(const Mesh& mesh) {
  double largest = 0;
  for (const Vec3& p : mesh.positions) largest = std::max(largest, max_norm(p - mesh.positions[0]));
  return largest;
}

Mesh moved(Mesh mesh, double scale, const Vec3& by) {
  for (Vec3& p : mesh.positions) p = p * scale + by;
  return mesh;
}

double outside(const Mesh& mesh, std::vector<Sphere> spheres) {
  std::erase_if(spheres, [](const Sphere& s) { return !(s.radius > 0); });
  return spheres.empty() ? 0 : looseness(mesh, spheres, {.resolution = 96}).looseness.value();
}

TEST(Tolerance, reduced_spheres_of_every_level_are_near_every_point) {
  const Mesh limb = sample_body("limb");
  for (const Mesh& mesh : {limb, moved(limb, 1e-9, {}), moved(limb, 1e9, {}), moved(limb, 1, {1e6, -1e6, 1e6})}) {
    const double size = extent(mesh), rounding = 1e-15 * largest_coordinate(mesh) + 1e-14 * size;
    for (const double share : {0.001, 0.03, 0.3, 3.0}) {
      const double tolerance = share * size;
      for (const BuildOptions& options :
           {BuildOptions{.depth = 2, .tolerance = tolerance, .quality = Quality::fast},
            BuildOptions{.spheres = 12, .tolerance = tolerance, .quality = Quality::fast}}) {
        const CoveredTree model = build(mesh, options);
        EXPECT_TRUE(certify(model.cover, mesh.positions, model.tree.spheres).covered);
        const SphereTree tree = reduced(model.tree, tolerance);
        for (std::size_t level = 0; level < tree.level_count(); ++level)
          EXPECT_LE(sampled_distance(mesh, level_set_spheres(tree, level)), tolerance + rounding) << level << share;
      }
    }
  }
}

TEST(Tolerance, covers_what_has_no_volume) {
  Mesh plate;
  plate.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {5, 5, 5}};
  plate.facets = {{0, 1, 2}, {0, 2, 3}, {4, 4, 4}};
  const CoveredTree model = build(plate, {.spheres = 6, .tolerance = 0.1, .quality = Quality::fast});
  EXPECT_LE(sampled_distance(plate, leaves(reduced(model.tree, 0.1))), 0.1 + 1e-12);
}

TEST(Tolerance, the_fit_is_not_looser_than_a_covering_one_that_is_reduced) {
  for (const char* body : {"limb", "two"}) {
    const Mesh mesh = sample_body(body);
    for (const double share : {0.01, 0.03, 0.06}) {
      const double tolerance = share * extent(mesh);
      for (const std::size_t spheres : {3, 8, 16}) {
        const CoveredTree covering = build(mesh, {.spheres = spheres, .quality = Quality::fast});
        const CoveredTree fitted = build(mesh, {.spheres = spheres, .tolerance = tolerance, .quality = Quality::fast});
        EXPECT_LE(fitted.tree.leaf_count(), spheres);
        EXPECT_LE(outside(mesh, leaves(reduced(fitted.tree, tolerance))),
                  1.02 * outside(mesh, leaves(reduced(covering.tree, tolerance))) + 0.002)
            << body << " " << share << " " << spheres;
      }
    }
  }
}

TEST(Tolerance, bounds_the_protrusion_of_reduced_spheres) {
  const Mesh mesh = sample_body("limb");
  const double tolerance = 0.02 * extent(mesh), most = 0.03 * extent(mesh);
  const CoveredTree model = build(mesh, {.max_protrusion = most, .tolerance = tolerance, .quality = Quality::fast});
  const CoveredTree covering = build(mesh, {.max_protrusion = most, .quality = Quality::fast});
  ASSERT_TRUE(model.report.protrusion_bound);
  EXPECT_LE(*model.report.protrusion_bound, most);
  EXPECT_LT(model.tree.leaf_count(), covering.tree.leaf_count());
  const SignedDistance object(mesh);
  for (const Sphere& s : leaves(reduced(model.tree, tolerance)))
    EXPECT_LE(s.radius + object(s.center), most * (1 + 1e-9));
}

TEST(Tolerance, zero_changes_no_bit) {
  const Mesh mesh = sample_body("limb");
  const CoveredTree plain = build(mesh, {.spheres = 8, .quality = Quality::fast});
  const CoveredTree zero = build(mesh, {.spheres = 8, .tolerance = 0, .quality = Quality::fast});
  EXPECT_EQ(plain.tree.spheres, zero.tree.spheres);
  EXPECT_EQ(reduced(plain.tree, 0).spheres, plain.tree.spheres);
}

// A sphere that is reduced by the tolerance of the lines measures like the smaller sphere.
TEST(Tolerance, reduced_volume_is_what_fits_measure) {
  using namespace detail;
  const Mesh mesh = sample_body("limb");
  const ObjectShape shape(mesh);
  const double size = extent(mesh), tolerance = 0.05 * size;
  const Box box = shape.bounding_box();
  const ObjectLines exact(mesh, shape, 96, serial_workers());
  ObjectLines tolerant(mesh, shape, 96, serial_workers());
  tolerant.set_tolerance(tolerance);
  const Sphere large{box.center() + Vec3{0.1 * size, 0, 0}, 0.3 * size}, small{large.center, 0.25 * size};
  const double expected = UnionVolume(exact).outside({&small, 1});
  ASSERT_GT(expected, 0);
  EXPECT_NEAR(UnionVolume(tolerant).outside({&large, 1}), expected, 1e-9 * expected);
  Box room;
  room.add(large.center - Vec3{size, size, size});
  room.add(large.center + Vec3{size, size, size});
  const auto volume = [&](const ObjectLines& lines, const Sphere& s) {
    OutsideGrid grid(lines, room, 0.05 * size);
    const Spheref ball{grid.to_grid(s.center), static_cast<float>(s.radius / grid.cell())};
    grid.prepare(ball.center, ball.radius, 0);
    const double one = static_cast<double>(grid.new_outside(ball)),
                 cost = static_cast<double>(grid.cost(ball.center, ball.radius));
    EXPECT_NEAR(cost, one, 0.05 * one);
    return one;
  };
  EXPECT_NEAR(volume(tolerant, large), volume(exact, small), 1e-3 * volume(exact, small));
}

TEST(Tolerance, refuses_what_it_cannot_keep) {
  const Mesh mesh = sample_body("limb");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW((void)build(mesh, {.tolerance = bad}), std::invalid_argument);
  }
  EXPECT_THROW((void)build(mesh, {.method = Method::octree, .tolerance = 0.1}), std::invalid_argument);
  EXPECT_THROW((void)reduced(Sphere{{}, 1}, -1), std::invalid_argument);
  EXPECT_THROW((void)reduced(Sphere{{}, 1}, nan), std::invalid_argument);
}

// Sums in long double: exact for these numbers.
TEST(Tolerance, a_reduced_radius_and_the_length_are_not_less_than_the_radius) {
  double radius = 1, length = 0.1;
  for (int i = 0; i < 2000; ++i) {
    radius = std::fmod(radius * 1.37 + 0.113, 3.0);
    length = std::fmod(length * 1.71 + 0.0171, 1.5);
    const Sphere s = reduced({{1, 2, 3}, radius}, length);
    EXPECT_GE(static_cast<long double>(s.radius) + static_cast<long double>(length), static_cast<long double>(radius));
    EXPECT_GE(s.radius, 0);
    EXPECT_LE(s.radius, std::max(0.0, radius - length) + 1e-15);
  }
}

}  // namespace
}  // namespace morula
