// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What is particular to method optimized: its qualities, and how much its seed matters.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/accuracy/looseness.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <numbers>
#include <numeric>
#include <support/meshes.hpp>

namespace morula {
namespace {

std::array<double, 2> loose_at_levels_2_and_3(const Mesh& mesh, BuildOptions options) {
  options.depth = 3;
  const SphereTree tree = build(mesh, options).tree;
  std::array<double, 2> loose{};
  for (const std::size_t level : {2u, 3u})
    loose[level - 2] = looseness(mesh, level_set_spheres(tree, level), {.resolution = 128}).looseness.value();
  return loose;
}

class OwnAt : public testing::TestWithParam<Quality> {};

TEST_P(OwnAt, keeps_its_promises) {
  for (const Mesh& mesh : {sample_body("two", 6), test::mesh_named("moebius_strip").mesh}) {
    const CoveredTree model = build(mesh, {.method = Method::optimized, .depth = 2, .quality = GetParam()});
    const auto faults = validate(mesh, model);
    EXPECT_TRUE(faults.empty()) << (faults.empty() ? "" : faults.front());
    EXPECT_TRUE(certify(model.cover, mesh.positions, model.tree.spheres).covered);
    EXPECT_TRUE(model.report.complete);
    for (const std::uint32_t count : model.tree.child_count) EXPECT_LE(count, 8u);
  }
}

std::string quality_name(const testing::TestParamInfo<Quality>& tested) {
  return std::string(name(tested.param));
}
INSTANTIATE_TEST_SUITE_P(Quick, OwnAt, testing::Values(Quality::draft, Quality::fast, Quality::standard), quality_name);
INSTANTIATE_TEST_SUITE_P(Long, OwnAt, testing::Values(Quality::best), quality_name);

TEST(Own, has_a_test_for_every_quality) {
  EXPECT_EQ(all_qualities().size(), 4u);
}

TEST(LongOwn, is_tighter_with_more_work) {
  const Mesh mesh = sample_body("limb", 16);
  const auto fast = loose_at_levels_2_and_3(mesh, {.method = Method::optimized, .quality = Quality::fast});
  const auto best = loose_at_levels_2_and_3(mesh, {.method = Method::optimized, .quality = Quality::best});
  for (const std::size_t i : {0u, 1u}) {
    RecordProperty(i == 0 ? "level_2" : "level_3", std::to_string(fast[i]) + " " + std::to_string(best[i]));
    EXPECT_LE(best[i], fast[i]) << "level " << i + 2;
  }
}

// What spheres near the x axis take in outside a straight tube along it, over its volume, at most: discs about the
// axis, each as wide as the widest sphere there reaches. cross_section: its area, everywhere between -half and half.
double taken_in_by_discs(std::span<const Sphere> spheres, double half, double cross_section) {
  constexpr int steps = 8000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double x = half * (2 * (i + 0.5) / steps - 1);
    double widest = 0;
    for (const Sphere& s : spheres) {
      const double square = s.radius * s.radius - (x - s.center.x) * (x - s.center.x);
      if (square > 0) widest = std::max(widest, std::hypot(s.center.y, s.center.z) + std::sqrt(square));
    }
    sum += std::numbers::pi * widest * widest / steps;
  }
  return sum / cross_section - 1;
}

// Slabs of a tube are a fifth as wide as its spheres: what weighs them has to be as fine. Spheres in a row whose
// centers are s radii apart take in s² / 6 beside what the polygon of the mesh does, whose corners they go through.
TEST(LongOwn, has_leaves_as_tight_as_a_chain_on_a_long_capsule) {
  constexpr int around = 40;
  constexpr double radius = 0.5, chain_of_80 = 0.15 * 0.15 / 6;  // along 12 radii
  Mesh mesh = sample_body("capsule", around);
  for (Vec3& p : mesh.positions) p.x = std::abs(p.x) < 1 ? 3 * p.x : p.x + std::copysign(2.0, p.x);
  const double step = 2 * std::numbers::pi / around;
  const double circle = std::numbers::pi * radius * radius, polygon = circle * std::sin(step) / step;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const SphereTree tree = build(mesh, {.method = Method::optimized, .depth = 3, .seed = seed}).tree;
    const double leaves = taken_in_by_discs(level_set_spheres(tree, 3), 2.8, polygon);
    RecordProperty("seed_" + std::to_string(seed), std::to_string(leaves));
    EXPECT_GE(leaves, circle / polygon - 1);
    EXPECT_LE(leaves, circle / polygon - 1 + chain_of_80);
  }
}

// The same of level 2 of a short one, whose slabs are a tenth of a radius wide; the mean of some seeds.
TEST(LongOwn, has_a_level_2_nearly_as_tight_as_a_chain_on_a_short_capsule) {
  constexpr int around = 48;
  constexpr double radius = 0.5, step = 2 * std::numbers::pi / around;
  constexpr double chain_of_52 = (6.0 / 52) * (6.0 / 52) / 6;  // along 6 radii
  const double circle = std::numbers::pi * radius * radius, polygon = circle * std::sin(step) / step;
  const Mesh mesh = sample_body("capsule", around);
  double mean = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const SphereTree tree = build(mesh, {.method = Method::optimized, .depth = 3, .seed = seed}).tree;
    const double level_2 = taken_in_by_discs(level_set_spheres(tree, 2), 0.8, polygon);
    RecordProperty("seed_" + std::to_string(seed), std::to_string(level_2));
    EXPECT_GE(level_2, circle / polygon - 1);
    mean += level_2 / 3;
  }
  EXPECT_LE(mean, circle / polygon - 1 + chain_of_52);
}

TEST(Own, is_tighter_with_more_work_at_one_level) {
  const Mesh mesh = sample_body("limb", 8);
  const auto loose = [&](Quality quality) {
    const SphereTree tree = build(mesh, {.method = Method::optimized, .depth = 1, .quality = quality}).tree;
    return looseness(mesh, level_set_spheres(tree, 1), {.resolution = 128}).looseness.value();
  };
  EXPECT_LE(loose(Quality::best), loose(Quality::fast));
}

TEST(Own, is_nearly_as_tight_for_every_seed_at_one_level) {
  const Mesh mesh = sample_body("limb", 16);
  std::vector<double> loose;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SphereTree tree = build(mesh, {.method = Method::optimized, .depth = 1, .seed = seed}).tree;
    loose.push_back(looseness(mesh, level_set_spheres(tree, 1), {.resolution = 128}).looseness.value());
  }
  const double mean = std::accumulate(loose.begin(), loose.end(), 0.0) / 5;
  for (const double l : loose) EXPECT_NEAR(l / mean, 1, 0.15);
}

TEST(NightlyOwn, is_nearly_as_tight_for_every_seed) {
  const Mesh mesh = sample_body("limb", 16);
  std::array<std::vector<double>, 2> loose;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto both = loose_at_levels_2_and_3(mesh, {.method = Method::optimized, .seed = seed});
    for (const std::size_t i : {0u, 1u}) loose[i].push_back(both[i]);
  }
  for (const std::size_t i : {0u, 1u}) {
    const double mean = std::accumulate(loose[i].begin(), loose[i].end(), 0.0) / 5;
    for (const double l : loose[i]) {
      EXPECT_NEAR(l / mean, 1, 0.15) << "level " << i + 2;
    }
  }
}

}  // namespace
}  // namespace morula
