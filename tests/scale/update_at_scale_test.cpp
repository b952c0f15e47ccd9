// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies that move, at every size.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/update/body.hpp>
#include <morula/update/kdop_tree.hpp>
#include <morula/update/looseness_estimate.hpp>

#include "bodies_at_scale.hpp"

namespace morula {
namespace {

CoveredTree scaled_tree(const Mesh& unit, const Mesh& mesh, double size, double offset) {
  CoveredTree model = build(unit, {.method = Method::octree, .branching = 4, .depth = 2});
  for (Sphere& s : model.tree.spheres)
    s = {test::placed(s.center, size, offset), s.radius * size + 0x1p-46 * test::reach_of(mesh)};
  model.report.mesh_hash = mesh_hash(mesh);
  return model;
}

std::vector<Vec3> shaken(const Mesh& mesh, double amplitude) {
  std::vector<Vec3> positions = mesh.positions;
  Random random(3);
  for (Vec3& p : positions) p += Vec3{random.uniform(-amplitude, amplitude), random.uniform(-amplitude, amplitude), 0};
  return positions;
}

std::vector<Sphere> spheres_of(const Body& body) {
  std::vector<Sphere> spheres;
  body.copy_spheres(spheres);
  return spheres;
}

TEST(UpdateAtScale, covers_by_the_judge_or_refuses) {
  const std::vector<UpdateOptions> all{{},
                                       {.rules = {Rule::wrapped}},
                                       {.rules = {Rule::approach1}, .conservative = true},
                                       {.rules = {Rule::approach2}, .conservative = true},
                                       {.rules = {Rule::traditional}, .conservative = true}};
  int bodies = 0;
  for (const test::BodyAtScale& unit : test::unit_bodies())
    for (const double size : test::sizes())
      for (const double offset : test::offsets()) {
        const Mesh mesh = test::placed(unit.mesh, size, offset);
        const CoveredTree model = scaled_tree(unit.mesh, mesh, size, offset);
        for (std::size_t k = 0; k < all.size(); ++k) {
          const std::string what = test::told(unit.name, size, offset) + ", rules " + std::to_string(k);
          const bool has_links = k >= 2;  // found by squares of lengths
          if (size > 1e17 || (has_links && test::is_out_of_range(mesh))) {
            EXPECT_TRUE(test::is_refused([&] { Body body(mesh, model, all[k]); })) << what;
            continue;
          }
          Body body(mesh, model, all[k]);
          EXPECT_TRUE(test::covers(model.cover, mesh.positions, spheres_of(body))) << what;
          const std::vector<Vec3> positions = shaken(mesh, 0.2 * size);
          ASSERT_TRUE(body.update(positions)) << what;
          EXPECT_TRUE(test::covers(model.cover, positions, spheres_of(body))) << what;
          EXPECT_TRUE(certify(model.cover, positions, spheres_of(body)).covered) << what;
          ++bodies;
        }
        if (size > 1e17) {
          EXPECT_TRUE(test::is_refused([&] { KDopTree boxes(mesh, model, 6); }) || test::reach_of(mesh) > 1e17);
        }
      }
  EXPECT_GT(bodies, 200);
}

TEST(UpdateAtScale, frames_out_of_range_change_nothing) {
  const Mesh& mesh = test::unit_bodies()[2].mesh;
  const CoveredTree model = build(mesh, {.method = Method::octree, .branching = 4, .depth = 2});
  Body body(mesh, model);
  const std::uint64_t before = body.hash();
  for (const double far : {1e31, 1e100, 1e200, 1e300}) {
    // All of them there: a body as flat as the digits that are left, and one in a single place.
    std::vector<Vec3> there(mesh.vertex_count(), Vec3{far, -far, far});
    const UpdateStatus status = body.update(there);
    EXPECT_EQ(status.code, UpdateStatus::Code::non_finite_position) << far;
    EXPECT_EQ(status.index, 0u) << far;
    there = mesh.positions;
    for (Vec3& p : there) p = p * far;
    EXPECT_FALSE(body.update(there)) << far;
    EXPECT_EQ(body.hash(), before) << far;
  }
  for (const double far : {1e9, 1e20, 1e29}) {
    const std::vector<Vec3> there(mesh.vertex_count(), Vec3{far, -far, far});
    ASSERT_TRUE(body.update(there)) << far;
    EXPECT_TRUE(test::covers(model.cover, there, spheres_of(body))) << far;
  }
}

TEST(UpdateAtScale, looseness_is_estimated_alike_at_every_power_of_two) {
  const Mesh& unit = test::unit_bodies()[4].mesh;
  const CoveredTree tree = build(unit, {.method = Method::octree, .branching = 4, .depth = 2});
  const std::vector<double> expected = estimate_looseness(unit, Body(unit, tree), unit.positions);
  for (const int power : {-40, -30, 30, 50}) {
    const double size = std::ldexp(1.0, power);
    const Mesh mesh = test::placed(unit, size, 0);
    const CoveredTree model = scaled_tree(unit, mesh, size, 0);
    const std::vector<double> found = estimate_looseness(mesh, Body(mesh, model), mesh.positions);
    for (std::size_t level = 0; level < expected.size(); ++level)
      EXPECT_NEAR(found[level], expected[level], 1e-3 * (1 + expected[level])) << power;
  }
  for (const double size : {1e-300, 1e-50, 1e50, 1e300})
    EXPECT_TRUE(test::is_refused([&] { LoosenessEstimator estimator(test::placed(unit, size, 0)); })) << size;
}

}  // namespace
}  // namespace morula
