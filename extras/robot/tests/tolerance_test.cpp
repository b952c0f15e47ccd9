// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres of robots that cover within a tolerance only.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/robot/output.hpp>

namespace morula::test::tolerance {
namespace {

const robot::Robot arm = robot::read_robot(MORULA_ROBOTS "/arm_description/urdf/arm.urdf");

/// The largest distance of many points of a link's shapes from its spheres, whose numbers are read as Scalar.
template <class Scalar>
double sampled_distance(const robot::LinkSpheres& link) {
  Random random(7);
  double largest = 0;
  const auto look_at = [&](const Vec3& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const Sphere& s : link.spheres) {
      const auto x = static_cast<double>(static_cast<Scalar>(s.center.x)),
                 y = static_cast<double>(static_cast<Scalar>(s.center.y)),
                 z = static_cast<double>(static_cast<Scalar>(s.center.z)),
                 r = static_cast<double>(static_cast<Scalar>(s.radius));
      least = std::min(least, std::hypot(p.x - x, p.y - y, p.z - z) - r);
    }
    largest = std::max(largest, least);
  };
  const Mesh& mesh = link.surface.mesh;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const auto [a, b, c] = mesh.corners(f);
    for (int k = 0; k < 40; ++k) {
      double u = k < 3 ? (k == 1) : random.uniform(), v = k < 3 ? (k == 2) : random.uniform();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      look_at(a + u * (b - a) + v * (c - a));
    }
  }
  for (const Sphere& own : link.surface.spheres)
    for (int k = 0; k < 200; ++k)
      look_at(own.center +
              own.radius * normalized(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}));
  return largest;
}

double outside(const robot::RobotSpheres& fitted) {
  double sum = 0;
  for (const robot::LinkSpheres& link : fitted.links) sum += link.figures.outside_volume.value_or(0);
  return sum;
}

TEST(FitTolerance, is_kept_by_every_link_also_when_numbers_are_read_as_float) {
  for (const double tolerance : {1e-4, 0.005, 0.03, 1.0}) {
    const robot::RobotSpheres fitted = robot::fit_spheres(arm, {.spheres = 6, .tolerance = tolerance});
    EXPECT_LE(fitted.within(), tolerance);
    for (const robot::LinkSpheres& link : fitted.links) {
      EXPECT_LE(sampled_distance<double>(link), link.figures.within) << tolerance << " " << link.link;
      EXPECT_LE(sampled_distance<float>(link), link.figures.within) << tolerance << " " << link.link;
      for (const Sphere& s : link.spheres) EXPECT_GT(s.radius, 0) << "files hold no other spheres";
    }
  }
}

TEST(FitTolerance, takes_less_space_the_larger_it_is) {
  double last = std::numeric_limits<double>::infinity();
  for (const double tolerance : {0.0, 0.002, 0.005, 0.01}) {
    const double now = outside(robot::fit_spheres(arm, {.spheres = 8, .tolerance = tolerance}));
    EXPECT_LT(now, last) << tolerance;
    last = now;
  }
}

TEST(FitTolerance, goes_with_a_total) {
  for (const double tolerance : {0.01, 10.0}) {
    const robot::RobotSpheres fitted = robot::fit_spheres(arm, {.max_total = 20, .tolerance = tolerance});
    EXPECT_LE(fitted.sphere_count(), 20u);
    EXPECT_LE(fitted.within(), tolerance);
    for (const robot::LinkSpheres& link : fitted.links) EXPECT_LE(sampled_distance<float>(link), link.figures.within);
  }
}

TEST(FitTolerance, zero_is_a_cover_and_others_are_none) {
  const robot::RobotSpheres zero = robot::fit_spheres(arm, {.spheres = 6, .tolerance = 0});
  EXPECT_TRUE(zero.covered());
  EXPECT_EQ(zero.within(), 0);
  const robot::RobotSpheres fitted = robot::fit_spheres(arm, {.spheres = 6, .tolerance = 0.005});
  EXPECT_FALSE(fitted.covered());
  EXPECT_GT(fitted.within(), 0);
}

TEST(FitTolerance, within_of_kept_spheres_is_measured) {
  const robot::RobotSpheres fitted = robot::fit_spheres(arm, {.spheres = 6, .tolerance = 0.01});
  robot::FitOptions kept;
  for (const robot::LinkSpheres& link : fitted.links) kept.fixed_spheres[arm.links[link.link].name] = link.spheres;
  const robot::RobotSpheres again = robot::fit_spheres(arm, kept);
  for (const robot::LinkSpheres& link : again.links) {
    EXPECT_LE(sampled_distance<double>(link), link.figures.within);
    EXPECT_LE(link.figures.within, 0.01 * (1 + 1e-5));
  }
}

TEST(FitTolerance, is_said_by_files) {
  const robot::RobotSpheres fitted = robot::fit_spheres(arm, {.spheres = 3, .tolerance = 0.01});
  const robot::RobotSpheres covering = robot::fit_spheres(arm, {.spheres = 3});
  const robot::SelfCollision pairs = robot::find_ignored(arm, fitted, {.samples = 10});
  robot::OutputOptions output;
  output.folder = "out";
  for (const char* format : {"curobo", "urdf"}) {
    const auto text = [&](const robot::RobotSpheres& spheres) {
      return robot::output_format(format)->write({arm, spheres, pairs, output}).at(0).bytes;
    };
    EXPECT_NE(text(fitted).find("leave surface uncovered"), std::string::npos) << format;
    EXPECT_EQ(text(covering).find("leave surface uncovered"), std::string::npos) << format;
  }
}

TEST(FitTolerance, equal_spheres_are_written_once) {
  for (const double tolerance : {0.0, 0.05}) {
    for (const robot::LinkSpheres& link : robot::fit_spheres(arm, {.spheres = 24, .tolerance = tolerance}).links)
      for (std::size_t i = 0; i < link.spheres.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(link.spheres[i] == link.spheres[j]);
  }
}

TEST(FitTolerance, refuses_what_is_none) {
  EXPECT_THROW((void)robot::fit_spheres(arm, {.tolerance = -1}), std::invalid_argument);
  EXPECT_THROW((void)robot::fit_spheres(arm, {.tolerance = std::numeric_limits<double>::quiet_NaN()}),
               std::invalid_argument);
  EXPECT_THROW((void)robot::fit_spheres(arm, {.tolerance = 0.01, .method = Method::grid}), std::invalid_argument);
}

}  // namespace
}  // namespace morula::test::tolerance
