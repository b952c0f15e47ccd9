// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The estimate against voxels, and what it promises otherwise.
#include <gtest/gtest.h>

#include <array>
#include <morula/accuracy/looseness.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/looseness_estimate.hpp>
#include <numbers>
#include <support/meshes.hpp>

#include "bodies.hpp"
#include "looseness_comparison.hpp"

namespace morula {
namespace {

class EstimateOf : public testing::TestWithParam<const char*> {};

TEST_P(EstimateOf, a_sample_body_agrees_with_voxels_at_rest_and_deformed) {
  test::expect_estimates_near_voxels(GetParam(), sample_body(GetParam(), 32));
}
INSTANTIATE_TEST_SUITE_P(Sample, EstimateOf, testing::Values("limb", "bar", "capsule", "torus", "blob", "two"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(LoosenessEstimate, of_thousands_of_spheres_agrees_with_voxels) {
  const Mesh mesh = sample_body("blob", 40);
  const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 5});
  ASSERT_GT(level_set_spheres(model.tree, model.tree.spheres, 5).size(), 2000u);
  const Body body(mesh, model);
  const std::vector<double> estimate = estimate_looseness(mesh, body, mesh.positions);
  const LoosenessMeter meter(mesh);
  for (std::size_t level = 1; level < estimate.size(); ++level) {
    const auto measured =
        meter.measure(mesh.positions, level_set_spheres(model.tree, model.tree.spheres, level), {.resolution = 256});
    ASSERT_TRUE(measured.looseness);
    EXPECT_NEAR(estimate[level], *measured.looseness, 0.15 * *measured.looseness) << "level " << level;
  }
}

// Bodies side by side, nearer to each other than samples are, then apart, each turned its own way: what lay beside a
// sample at rest says nothing of the surface around it.
TEST(LoosenessEstimate, of_bodies_that_part_agrees_with_voxels) {
  const Mesh part = sample_body("capsule", 12);
  const Vec3 size = bounding_box(part).extent();
  const auto bundle = [&](const Vec3& apart, double turned) {
    Mesh all;
    for (int i = 0; i < 27; ++i) {
      const Vec3 at{apart.x * (i % 3), apart.y * (i / 3 % 3), apart.z * (i / 9)};
      const RigidTransform place = RigidTransform::from_axis({1.0 + i, 2.0 - i, 0.5}, turned * (i + 1), at);
      all = test::joined(all, test::placed(part, place));
    }
    return all;
  };
  const Mesh together = bundle(1.02 * size, 0), parted = bundle(1.2 * max_norm(size) * Vec3{1, 1, 1}, 1);
  const Body body(parted, build(parted, {.depth = 3, .quality = Quality::fast}));
  std::vector<Sphere> spheres;
  body.copy_spheres(spheres);
  LoosenessEstimator estimator(together);
  std::vector<double> estimate(body.rest_tree().level_count());
  estimator.pose(parted.positions);
  estimator.estimate(body, estimate);
  const LoosenessMeter meter(parted);
  for (std::size_t level = 2; level < estimate.size(); ++level) {
    const auto measured =
        meter.measure(parted.positions, level_set_spheres(body.rest_tree(), spheres, level), {.resolution = 256});
    ASSERT_TRUE(measured.looseness);
    EXPECT_NEAR(estimate[level], *measured.looseness, 0.15 * *measured.looseness) << "level " << level;
  }
  // Facets with corners of their own at the same places are of one piece. Both have a border, so that both count alike.
  std::vector<double> looseness[2];
  for (const bool is_loose : {false, true}) {
    Mesh before = together, after = parted;
    for (Mesh* mesh : {&before, &after}) {
      mesh->facets.pop_back();
      if (is_loose) *mesh = test::soup_of(*mesh);
    }
    LoosenessEstimator of_open(before);
    looseness[is_loose].resize(estimate.size());
    of_open.pose(after.positions);
    of_open.estimate(body, looseness[is_loose]);
  }
  EXPECT_GT(looseness[0].back(), 0);
  EXPECT_EQ(looseness[0], looseness[1]);
}

// What is known without voxels: shells about a ball, and the root.
TEST(LoosenessEstimate, is_exact_about_a_ball) {
  const Mesh ball = test::icosphere(4);
  const double volume = signed_volume(ball);
  for (const double radius : {1.001, 1.1, 1.5}) {
    const std::vector<Sphere> leaves{{{0, 0, 0}, radius}};
    const Body body(ball, test::root_with_leaves(ball, leaves[0], leaves), {.rules = {Rule::approach2}, .details = {}});
    const std::vector<double> looseness = estimate_looseness(ball, body, ball.positions);
    const double expected = 4 * std::numbers::pi / 3 * radius * radius * radius / volume - 1;
    EXPECT_NEAR(looseness[0], expected, 1e-5);
    EXPECT_NEAR(looseness[1], expected, 0.02 * expected + 1e-4) << radius;
  }
}

// Shares of the volume are even and odd numbers of facets: 12 in all, and 300.
TEST(LoosenessEstimate, has_the_exact_volume_of_a_box_in_every_pose) {
  const Mesh at_once = test::box_mesh({0, 0, 0}, {1, 2, 3}), fine = test::box_mesh({0, 0, 0}, {1, 2, 3}, 5);
  for (const Mesh& box : {at_once, fine, test::inverted(fine)}) {
    LoosenessEstimator estimator(box);
    EXPECT_NEAR(estimator.volume(), 6, 1e-12);
    for (const Vec3& stretch : {Vec3{1, 1, 1}, Vec3{20, 1, 0.01}, Vec3{0.01, 20, 1}, Vec3{1, 0.01, 20}}) {
      std::vector<Vec3> positions;
      for (const Vec3& p : box.positions)
        positions.push_back({p.x * stretch.x + 1e6, p.y * stretch.y - 2e6, p.z * stretch.z + 5e5});
      const double expected = 6 * stretch.x * stretch.y * stretch.z;
      estimator.pose(positions);
      EXPECT_NEAR(estimator.volume(), expected, 1e-6 * expected);
    }
  }
}

TEST(LoosenessEstimate, does_not_depend_on_place_size_side_or_scalar) {
  const test::Specimen& b = test::specimens()[2];
  const std::vector<double> expected = estimate_looseness(b.mesh, Body(b.mesh, b.model), b.mesh.positions);

  Body far(b.mesh, b.model);
  const auto there = test::translated(b.mesh.positions, {1e6, -2e6, 5e5});
  ASSERT_TRUE(far.update(there));
  const std::vector<double> moved = estimate_looseness(b.mesh, far, there);

  Body narrow(b.mesh, b.model);
  std::vector<Vec3f> floats;
  for (const Vec3& p : b.mesh.positions) floats.emplace_back(p);
  ASSERT_TRUE(narrow.update(floats));
  const std::vector<double> from_floats = estimate_looseness(b.mesh, narrow, floats);

  Mesh turned = b.mesh;
  for (Facet& f : turned.facets) std::swap(f[1], f[2]);
  const std::vector<double> inside_out = estimate_looseness(turned, Body(b.mesh, b.model), b.mesh.positions);

  for (std::size_t level = 0; level < expected.size(); ++level) {
    EXPECT_GT(expected[level], 0);
    EXPECT_NEAR(moved[level], expected[level], 1e-3 * expected[level]);
    EXPECT_NEAR(from_floats[level], expected[level], 1e-3 * expected[level]);
    EXPECT_NEAR(inside_out[level], expected[level], 0.02 * expected[level]);
  }
}

TEST(LoosenessEstimate, of_a_mesh_of_floats_with_others_between_them_has_the_bits_of_doubles) {
  Mesh mesh = sample_body("limb", 16);
  std::vector<std::array<float, 5>> rows;
  for (Vec3& p : mesh.positions) {
    const Vec3f single(p);
    rows.push_back({single.x, single.y, single.z, 1e30f, -1e30f});
    p = Vec3(single);
  }
  const MeshView view{PositionView::strided(rows[0].data(), rows.size(), sizeof rows[0]), mesh.facets};
  const Body body(mesh, build(mesh, {.method = Method::octree, .depth = 2}));
  EXPECT_EQ(estimate_looseness(view, body, view.positions), estimate_looseness(mesh, body, mesh.positions));
}

TEST(LoosenessEstimate, gives_finite_figures_for_any_mesh_and_motion) {
  for (const test::Specimen& b : test::specimens()) {
    Body body(b.mesh, b.model);
    for (const test::Motion& motion : test::motions()) {
      const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
      ASSERT_TRUE(body.update(positions));
      for (const double looseness : estimate_looseness(b.mesh, body, positions))
        EXPECT_TRUE(std::isfinite(looseness) && looseness >= 0) << b.name << ", " << motion.name;
    }
  }
}

// No inside: the space on both sides counts.
TEST(LoosenessEstimate, finds_coarse_levels_of_open_meshes_looser) {
  const test::Specimen& plate = test::specimens()[1];
  const std::vector<double> looseness =
      estimate_looseness(plate.mesh, Body(plate.mesh, plate.model), plate.mesh.positions);
  for (std::size_t level = 1; level < looseness.size(); ++level) EXPECT_LT(looseness[level], looseness[level - 1]);
  EXPECT_GT(looseness.back(), 0);
}

TEST(LoosenessEstimate, gives_the_same_bits_again_and_for_another_body_in_between) {
  const Mesh mesh = sample_body("limb", 20);
  const CoveredTree model = build(mesh, {.method = Method::grid, .depth = 2});
  const Body body(mesh, model), other(mesh, build(mesh, {.method = Method::octree, .depth = 2}));
  LoosenessEstimator estimator(mesh);
  std::vector<double> first(3), second(3), longer(5);
  estimator.estimate(body, first);
  estimator.estimate(other, second);
  EXPECT_NE(first, second);
  estimator.pose(mesh.positions);
  estimator.estimate(body, second);
  EXPECT_EQ(first, second);
  estimator.estimate(body, longer);
  EXPECT_EQ(longer[4], first[2]);
}

// One with a volume and one without: all tasks of an estimate, in every share of them.
TEST(LoosenessEstimate, in_steps_gives_the_bits_that_it_gives_at_once) {
  for (const std::size_t which : {1u, 2u}) {
    const test::Specimen& b = test::specimens()[which];
    Body body(b.mesh, b.model);
    const std::vector<Vec3> away = test::noisy(b.mesh.positions, 0.1, 3);
    ASSERT_TRUE(body.update(away));
    LoosenessEstimator at_once(b.mesh), in_steps(b.mesh);
    std::vector<double> expected(b.model.tree.level_count() + 1), figures(expected.size());
    at_once.pose(away);
    at_once.estimate(body, expected);
    EXPECT_FALSE(in_steps.step(figures)) << "nothing is under way";
    for (const std::size_t steps : {0u, 1u, 2u, 3u, 8u, 100u}) {
      Body moving(body);
      std::vector<Vec3> positions = away;
      ASSERT_TRUE(moving.update(positions));
      in_steps.begin(positions, moving, steps);
      // What it needs it has copied: the body goes on.
      for (Vec3& p : positions) p = {};
      ASSERT_TRUE(moving.update(b.mesh.positions));
      std::fill(figures.begin(), figures.end(), -1);
      for (std::size_t step = 1; step < steps; ++step) EXPECT_FALSE(in_steps.step(figures)) << step << " of " << steps;
      EXPECT_TRUE(in_steps.step(figures)) << steps;
      EXPECT_EQ(figures, expected) << b.name << " in " << steps;
      EXPECT_FALSE(in_steps.step(figures));
    }
    in_steps.begin(away, body, 3);
    in_steps.give_up();
    EXPECT_FALSE(in_steps.step(figures));
  }
}

TEST(LoosenessEstimate, refuses_what_it_cannot_sample) {
  const Mesh mesh = test::icosphere(1);
  EXPECT_THROW(LoosenessEstimator(mesh, 63), std::invalid_argument);
  EXPECT_THROW(LoosenessEstimator(mesh, (std::size_t{1} << 20) + 1), std::invalid_argument);
  EXPECT_THROW(LoosenessEstimator(Mesh{}), std::invalid_argument);
  EXPECT_THROW(LoosenessEstimator(Mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}), std::invalid_argument);
  EXPECT_EQ(LoosenessEstimator(mesh, 65).sample_count(), 80u);
}

}  // namespace
}  // namespace morula
