// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Clumps that have to cover within a tolerance only.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/grains/clump.hpp>
#include <support/meshes.hpp>
#include <support/sampled_distance.hpp>

namespace morula::test::clump_tolerance {
namespace {

ClumpOptions within(double tolerance, std::size_t spheres = 8) {
  return {.spheres = spheres, .tolerance = tolerance, .quality = Quality::draft};
}

Mesh moved(Mesh mesh, double scale, const Vec3& by) {
  for (Vec3& p : mesh.positions) p = p * scale + by;
  return mesh;
}

TEST(ClumpTolerance, every_point_of_every_kind_of_mesh_is_near_a_sphere_also_when_numbers_are_read_as_float) {
  for (const NamedMesh& named : all_meshes()) {
    double size = 0;
    for (const Vec3& p : named.mesh.positions) size = std::max(size, max_norm(p - named.mesh.positions[0]));
    for (const double share : {1e-4, 0.05}) {
      const Clump clump = fit_clump(named.mesh, within(share * size, 4));
      EXPECT_TRUE(clump.proven) << named.name << share;
      EXPECT_LE(clump.within, share * size) << named.name;
      EXPECT_LE(clump.uncovered_distance, clump.within) << named.name;
      EXPECT_LE(clump.spheres.size(), 4u) << named.name;
      for (const bool floats : {false, true})
        EXPECT_LE(sampled_distance(named.mesh, clump.spheres, floats), clump.within) << named.name << share;
    }
  }
}

TEST(ClumpTolerance, holds_far_away_and_for_small_and_large_grains) {
  const Mesh blob = sample_body("blob", 10);
  for (const Mesh& mesh : {moved(blob, 1e-9, {}), moved(blob, 1e9, {}), moved(blob, 1, {1e4, -1e4, 1e4})}) {
    double size = 0;
    for (const Vec3& p : mesh.positions) size = std::max(size, max_norm(p - mesh.positions[0]));
    const Clump clump = fit_clump(mesh, within(0.05 * size));
    EXPECT_TRUE(clump.proven);
    EXPECT_LE(clump.within, 0.05 * size);
    for (const bool floats : {false, true})
      EXPECT_LE(sampled_distance(mesh, clump.spheres, floats), clump.within + 1e-9 * size);
  }
}

TEST(ClumpTolerance, spheres_are_thinner_and_touch_the_limit) {
  for (const std::string body : {"limb", "tool", "blob"}) {
    const Mesh mesh = sample_body(body, 16);
    double last = std::numeric_limits<double>::infinity();
    for (const double tolerance : {0.0, 0.02, 0.05, 0.1}) {
      const Clump clump = fit_clump(mesh, within(tolerance));
      ASSERT_TRUE(clump.outside_volume.has_value());
      EXPECT_LT(*clump.outside_volume, last) << body << tolerance;
      last = *clump.outside_volume;
      EXPECT_TRUE(clump.proven);
      EXPECT_EQ(clump.within > 0, tolerance > 0);
      EXPECT_EQ(clump.uncovered_distance > 0, tolerance > 0);
      EXPECT_GE(clump.uncovered_distance, 0.9 * tolerance) << "what a tolerance allows is used";
    }
  }
}

TEST(ClumpTolerance, goes_with_the_other_limits) {
  const Mesh mesh = sample_body("limb", 10);
  ClumpOptions options = within(0.05, 4);
  options.max_radius = 0.6;
  const Clump small = fit_clump(mesh, options);
  EXPECT_TRUE(small.proven);
  for (const Sphere& s : small.spheres) EXPECT_LE(s.radius, 0.6);
  EXPECT_LE(sampled_distance(mesh, small.spheres, true), 0.05);
  ClumpOptions covering = options;
  covering.tolerance = 0;
  EXPECT_LE(small.spheres.size(), fit_clump(mesh, covering).spheres.size()) << "the limit is that of the final radius";

  options = within(0.05, 0);
  options.max_protrusion = 0.1;
  const Clump close = fit_clump(mesh, options);
  EXPECT_TRUE(close.proven);
  EXPECT_LE(close.protrusion_max, 0.1 + 1e-4);

  // Enlarged to a smallest radius, spheres may cover again.
  options = within(0.05, 4);
  options.min_radius = 10;
  const Clump large = fit_clump(mesh, options);
  EXPECT_TRUE(large.proven);
  EXPECT_EQ(large.within, 0);
  EXPECT_EQ(large.uncovered_distance, 0);
}

TEST(ClumpTolerance, spheres_that_become_points_are_told) {
  const Mesh mesh = sample_body("blob", 10);
  const Clump clump = fit_clump(mesh, within(100, 4));
  EXPECT_TRUE(clump.proven) << "a tolerance may exceed the grain";
  EXPECT_LE(sampled_distance(mesh, clump.spheres, true), clump.within);
  ASSERT_FALSE(clump.notes.empty());
  EXPECT_NE(clump.notes.back().find("hardly more than"), std::string::npos) << clump.notes.back();
  ClumpOptions options = within(100, 4);
  options.min_radius = 0.1;
  EXPECT_TRUE(fit_clump(mesh, options).notes.empty());
  EXPECT_TRUE(fit_clump(mesh, within(0.01, 4)).notes.empty());
}

TEST(ClumpTolerance, refuses_what_makes_no_sense) {
  const Mesh mesh = sample_body("bar", 4);
  EXPECT_THROW(fit_clump(mesh, within(-1)), std::invalid_argument);
  EXPECT_THROW(fit_clump(mesh, within(1e31)), std::invalid_argument);
  EXPECT_THROW(fit_clump(mesh, within(std::numeric_limits<double>::quiet_NaN())), std::invalid_argument);
  EXPECT_THROW(fit_clump(mesh, within(std::numeric_limits<double>::infinity())), std::invalid_argument);
  ClumpOptions options = within(0.1);
  options.kind = ClumpKind::inner;
  EXPECT_THROW(fit_clump(mesh, options), std::invalid_argument);
  options = within(0.1);
  options.method = Method::grid;
  EXPECT_THROW(fit_clump(mesh, options), std::invalid_argument);
}

TEST(ClumpTolerance, files_say_what_is_proven) {
  const Mesh mesh = sample_body("limb", 10);
  const Clump loose = fit_clump(mesh, within(0.05)), covering = fit_clump(mesh, within(0));
  for (const ClumpFormat& format : clump_formats()) {
    const std::string some = format.text(loose, "stone"), all = format.text(covering, "stone");
    const std::string wanted = format.name == "json" ? "\"proven\": true,\n  \"within\": 0.0" : " lies within 0.0";
    EXPECT_EQ(some.find(wanted) != std::string::npos, format.name != "chrono") << format.name << "\n" << some;
    EXPECT_EQ(all.find(" lies within "), std::string::npos) << format.name;
  }
}

}  // namespace
}  // namespace morula::test::clump_tolerance
