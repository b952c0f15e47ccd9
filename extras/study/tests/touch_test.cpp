// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/triangle_intersection.hpp>
#include <morula/study/touch.hpp>

namespace morula::study {
namespace {

TEST(StudyTouch, no_budget_misses_a_crossing_and_crossings_are_real) {
  const Mesh mesh = sample_body("limb", 8);
  TouchPlan plan = TouchPlan::crossed_arms(mesh);
  plan.budgets = {20, std::nullopt};
  plan.timed_queries = 1;
  plan.frames = 3;
  const Touch touch = run_touch(plan, mesh, build(mesh, {.method = Method::grid, .depth = 3}));
  ASSERT_EQ(touch.crossings.size(), plan.frames);
  ASSERT_EQ(touch.rows.size(), 2u);

  const auto corners = [](const std::vector<Vec3>& at, const Facet& f) {
    return Triangle{at[f[0]], at[f[1]], at[f[2]]};
  };
  std::size_t pairs = 0;
  for (const Facet& f : mesh.facets)
    for (const Facet& g : mesh.facets)
      pairs += intersect(corners(touch.middle_a, f), corners(touch.middle_b, g)) ? 1 : 0;
  EXPECT_GT(pairs, 0u);
  EXPECT_EQ(touch.crossings[plan.frames / 2], pairs);

  for (const TouchRow& row : touch.rows) EXPECT_EQ(row.missed, 0u);
  EXPECT_LE(touch.rows[0].pair_tests, 20);
  EXPECT_LT(touch.rows[0].finished_share, 1);
  EXPECT_EQ(touch.rows[1].finished_share, 1);
  EXPECT_GT(touch.rows[0].mean_error_bound, touch.rows[1].mean_error_bound);
}

}  // namespace
}  // namespace morula::study
