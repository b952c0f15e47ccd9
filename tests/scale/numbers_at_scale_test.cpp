// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Lengths, smallest spheres, areas, volumes, turns, motions and files at every size.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/deform/deformation.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/scale.hpp>

#include "bodies_at_scale.hpp"

namespace morula {
namespace {

long double exact_distance(const Vec3& a, const Vec3& b) {
  return test::exact_distance(a, {b.x, b.y, b.z});
}

TEST(NumbersAtScale, lengths_are_right_to_a_few_ulps) {
  for (const double size : test::sizes())
    for (const Vec3& v : {Vec3{3, 4, 12}, Vec3{-1, 1e-5, 0}, Vec3{0, 0, 7}, Vec3{1, 1, 1}})
      EXPECT_NEAR(static_cast<double>(scaled_length(v * size) / exact_distance({0, 0, 0}, v * size)), 1, 1e-15) << size;
  EXPECT_EQ(scaled_length({0, 0, 0}), 0);
  EXPECT_EQ(scaled_length({0, std::numeric_limits<double>::denorm_min(), 0}),
            std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(scaled_length({std::numeric_limits<double>::max(), std::numeric_limits<double>::max(), 0}),
            std::numeric_limits<double>::infinity());
  // The same bits whether squares need scaling or not, also beside components that are nearly nothing.
  Random random(4);
  for (int trial = 0; trial < 20000; ++trial) {
    Vec3 v{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const int exponent = static_cast<int>(random.next() % 780) - 390, lower = static_cast<int>(random.next() % 700);
    v[static_cast<int>(random.next() % 3)] *= std::exp2(-lower);
    const double expected = std::ldexp(length(v), exponent);
    ASSERT_EQ(scaled_length(v * std::exp2(exponent)), expected) << trial;
  }
}

TEST(NumbersAtScale, smallest_spheres_contain_and_are_small) {
  for (const test::BodyAtScale& body : test::unit_bodies()) {
    const Sphere unit = enclosing_sphere(body.mesh.positions);
    for (const double size : test::sizes())
      for (const double offset : test::offsets()) {
        const Mesh mesh = test::placed(body.mesh, size, offset);
        const std::string what = test::told(body.name, size, offset);
        const Sphere sphere = enclosing_sphere(mesh.positions);
        long double farthest = 0;
        for (const Vec3& p : mesh.positions) farthest = std::max(farthest, exact_distance(sphere.center, p));
        ASSERT_TRUE(is_finite(sphere.center)) << what;
        EXPECT_NEAR(static_cast<double>(farthest / static_cast<long double>(sphere.radius)), 1, 1e-14) << what;
        EXPECT_NEAR(sphere.radius / size, unit.radius, 1e-10) << what;
      }
  }
  // A facet that is minute beside its coordinates, and one point.
  const std::vector<Vec3> minute{{0, 0, 1}, {3e-200, 0, 1}, {0, 4e-200, 1}};
  EXPECT_NEAR(enclosing_sphere(minute).radius / 2.5e-200, 1, 1e-12);
  const std::vector<Vec3> same{{1e200, 1, 1e-300}, {1e200, 1, 1e-300}};
  EXPECT_EQ(enclosing_sphere(same), (Sphere{{1e200, 1, 1e-300}, 0}));
  EXPECT_EQ(farthest_distance({0, 0, 0}, std::vector<Vec3>{{1e-170, 0, 0}, {0, -3e-170, 0}}), 3e-170);
}

TEST(NumbersAtScale, areas_and_volumes_are_those_of_a_unit_body_times_powers_of_the_size) {
  for (const test::BodyAtScale& body : test::unit_bodies()) {
    const MeshReport unit = inspect(body.mesh);
    for (const int power : {-1000, -600, -340, -300, -120, -90, 0, 90, 120, 300, 330, 500, 1000}) {
      const double size = std::ldexp(1.0, power);
      const MeshReport report = inspect(test::placed(body.mesh, size, 0));
      // Infinite where the area itself is beyond double.
      EXPECT_EQ(report.area, std::ldexp(unit.area, 2 * power)) << body.name << power;
      EXPECT_EQ(report.volume, std::ldexp(unit.volume, 3 * power)) << body.name << power;
      EXPECT_EQ(report.degenerate_facets, 0u) << body.name << power;
      EXPECT_EQ(surface_area(test::placed(body.mesh, size, 0)), report.area);
    }
  }
}

TEST(NumbersAtScale, turns_do_not_depend_on_the_length_of_their_axis) {
  for (const double size : test::sizes())
    for (const Vec3& axis : {Vec3{0, 0, 1}, Vec3{1, -2, 0.5}}) {
      const RigidTransform expected = RigidTransform::from_axis(axis, 0.7);
      const RigidTransform turn = RigidTransform::from_axis(axis * size, 0.7);
      const RigidTransform same =
          RigidTransform::from_quaternion(0.9 * size, axis.x * size, axis.y * size, axis.z * size);
      const RigidTransform other = RigidTransform::from_quaternion(0.9, axis.x, axis.y, axis.z);
      for (std::size_t row = 0; row < 3; ++row) {
        EXPECT_LT(max_norm(turn.rows[row] - expected.rows[row]), 1e-14) << size;
        EXPECT_LT(max_norm(same.rows[row] - other.rows[row]), 1e-14) << size;
      }
    }
}

TEST(NumbersAtScale, motions_are_those_of_a_unit_body_or_refused) {
  const Deformations motions{Stretch{}, Twist{}, Bend{.degrees = 20, .axis = Axis::x}, Poke{}, Noise{}, Rotate{}};
  for (const test::BodyAtScale& body : test::unit_bodies()) {
    const std::vector<Vec3> unit = deform(body.mesh, motions, 0.6);
    for (const double size : test::sizes()) {
      const Mesh mesh = test::placed(body.mesh, size, 0);
      if (test::is_out_of_range(mesh)) {
        EXPECT_TRUE(test::is_refused([&] { deform(mesh, motions, 0.6); })) << test::told(body.name, size, 0);
        EXPECT_TRUE(test::is_refused([&] { sample_surface(mesh, 5); })) << test::told(body.name, size, 0);
        continue;
      }
      const std::vector<Vec3> moved = deform(mesh, motions, 0.6);
      for (std::size_t v = 0; v < moved.size(); ++v)
        EXPECT_LT(max_norm(moved[v] / size - unit[v]), 1e-9) << test::told(body.name, size, 0);
    }
  }
  // Each of them in range, all together not.
  const Deformations many(200, Stretch{.factor = 1000, .shrink = -1});
  EXPECT_THROW(deform(test::unit_bodies()[0].mesh, many, 1), std::invalid_argument);
}

TEST(NumbersAtScale, the_range_ends_where_it_says) {
  const Mesh& cube = test::unit_bodies()[0].mesh;
  const auto refused = [&](double size) {
    return test::is_refused([&] { require_usable_scale(test::placed(cube, size, 0)); });
  };
  EXPECT_FALSE(refused(least_usable_scale));
  EXPECT_TRUE(refused(std::nextafter(least_usable_scale, 0.0)));
  EXPECT_FALSE(refused(greatest_usable_scale));
  EXPECT_TRUE(refused(std::nextafter(greatest_usable_scale, 2 * greatest_usable_scale)));
  EXPECT_FALSE(refused(0));  // one point
  // Vertices that no facet uses may be anywhere.
  Mesh more = cube;
  more.positions.push_back({1e300, std::numeric_limits<double>::quiet_NaN(), 0});
  EXPECT_NO_THROW(require_usable_scale(more));
}

TEST(NumbersAtScale, spheres_are_usable_up_to_the_end_of_the_range_and_with_no_negative_radius) {
  const double most = greatest_usable_scale, too_much = std::nextafter(most, 2 * most);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double radius : {0.0, -0.0, std::numeric_limits<double>::denorm_min(), 1.0, most})
    EXPECT_TRUE(has_usable_scale({{most, -most, 0}, radius})) << radius;
  for (const double radius : {-std::numeric_limits<double>::denorm_min(), -1.0, -most, too_much, nan})
    EXPECT_FALSE(has_usable_scale({{0, 0, 0}, radius})) << radius;
  for (const double coordinate : {too_much, -too_much, nan})
    for (const Vec3& center : {Vec3{coordinate, 0, 0}, Vec3{0, coordinate, 0}, Vec3{0, 0, coordinate}})
      EXPECT_FALSE(has_usable_scale({center, 1})) << coordinate;
}

}  // namespace
}  // namespace morula
