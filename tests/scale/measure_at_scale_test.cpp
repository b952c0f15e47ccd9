// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What is measured does not depend on the size, and is refused where it would.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/accuracy/measure.hpp>
#include <morula/generators/build.hpp>

#include "bodies_at_scale.hpp"

namespace morula {
namespace {

TEST(MeasureAtScale, figures_are_those_of_a_unit_body_or_refused) {
  const MeasureOptions options{.grid = {.resolution = 32}};
  for (const test::BodyAtScale& body : test::unit_bodies()) {
    SphereTree tree = build(body.mesh, {.method = Method::octree, .branching = 4, .depth = 1}).tree;
    // Too small: some surface is bare.
    for (std::uint32_t node = tree.level_begin[1]; node < tree.level_begin[2]; ++node) tree.spheres[node].radius *= 0.6;
    const std::vector<LevelMeasure> unit = measure(body.mesh, tree, options);
    ASSERT_TRUE(unit[0].coverage.covered);
    ASSERT_FALSE(unit[1].coverage.covered);
    for (const double size : test::sizes())
      for (const double offset : test::offsets()) {
        const Mesh mesh = test::placed(body.mesh, size, offset);
        SphereTree scaled = tree;
        for (Sphere& s : scaled.spheres) s = {test::placed(s.center, size, offset), s.radius * size};
        const std::string what = test::told(body.name, size, offset);
        if (test::is_out_of_range(mesh)) {
          EXPECT_TRUE(test::is_refused([&] { measure(mesh, scaled, options); })) << what;
          EXPECT_TRUE(test::is_refused([&] { static_cast<void>(coverage(mesh, scaled.spheres)); })) << what;
          EXPECT_TRUE(test::is_refused([&] { looseness(mesh, scaled.spheres); })) << what;
          continue;
        }
        const std::vector<LevelMeasure> measured = measure(mesh, scaled, options);
        for (std::size_t level = 0; level < 2; ++level) {
          const LevelMeasure &m = measured[level], &u = unit[level];
          EXPECT_EQ(m.coverage.covered, u.coverage.covered) << what;
          EXPECT_NEAR(m.coverage.uncovered_distance / size, u.coverage.uncovered_distance, 1e-6) << what;
          EXPECT_NEAR(m.coverage.uncovered_area, u.coverage.uncovered_area, 1e-6) << what;
          ASSERT_TRUE(m.looseness.looseness.has_value());
          EXPECT_NEAR(*m.looseness.looseness, *u.looseness.looseness, 0.02 * (1 + *u.looseness.looseness)) << what;
          ASSERT_TRUE(m.protrusion.has_value());
          EXPECT_NEAR(m.protrusion->worst / size, u.protrusion->worst, 0.02 * u.protrusion->worst + 1e-6) << what;
        }
        // Frames and spheres far beyond the body's own size.
        const LoosenessMeter meter(mesh);
        const std::vector<Vec3> far(mesh.vertex_count(), Vec3{1e200, 0, 0});
        EXPECT_TRUE(test::is_refused([&] { meter.measure(far, scaled.spheres, {}); }));
        const std::vector<Sphere> huge{{{0, 0, 0}, 1e200}};
        EXPECT_TRUE(test::is_refused([&] { static_cast<void>(coverage(mesh, huge)); }));
        EXPECT_TRUE(test::is_refused([&] { looseness(mesh, huge); }));
        EXPECT_TRUE(test::is_refused([&] { protrusion(SignedDistance(mesh), huge); }));
      }
  }
}

// A sphere that is nothing beside the body covers nothing, whatever its squares are.
TEST(MeasureAtScale, spheres_without_size_cover_nothing) {
  for (const double size : {1e-20, 1.0, 1e20})
    for (const double radius : {0.0, 1e-300, 1e-200, 1e-160}) {
      const Mesh mesh = test::placed(test::unit_bodies()[1].mesh, size, 0);
      const std::vector<Sphere> spheres{{mesh.positions[0], radius}};
      const Coverage found = coverage(mesh, spheres);
      EXPECT_FALSE(found.covered);
      EXPECT_NEAR(found.uncovered_area, 1, 1e-12);
      EXPECT_NEAR(found.uncovered_distance / size, 2, 1e-6);
    }
}

}  // namespace
}  // namespace morula
