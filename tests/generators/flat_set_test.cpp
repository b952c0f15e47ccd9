// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// So many spheres, or so little protrusion, instead of a depth.
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/accuracy/coverage.hpp>
#include <morula/accuracy/looseness.hpp>
#include <morula/accuracy/protrusion.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <support/meshes.hpp>
#include <support/methods.hpp>

#include "same_bits.hpp"

namespace morula {
namespace {

constexpr std::array cheap{Method::octree, Method::grid, Method::hubbard, Method::spawn};

std::vector<Sphere> leaves(const CoveredTree& model) {
  return level_set_spheres(model.tree, model.tree.level_count() - 1);
}

double loose(const Mesh& mesh, const CoveredTree& model) {
  return looseness(mesh, leaves(model), {.resolution = 64}).looseness.value();
}

void expect_sound(const Mesh& mesh, const CoveredTree& model, const std::string& what) {
  const auto faults = validate(mesh, model);
  EXPECT_TRUE(faults.empty()) << what << ": " << (faults.empty() ? "" : faults.front());
  EXPECT_EQ(leaves(model).size(), model.tree.leaf_count()) << what;
  EXPECT_TRUE(coverage(mesh, leaves(model)).covered) << what;
}

using FlatSetBy = test::ByMethod;

TEST_P(FlatSetBy, has_the_number_of_spheres_asked_for_and_covers) {
  const Method method = GetParam();
  for (const char* body : {"limb", "two"}) {
    const Mesh mesh = sample_body(body, 16);
    for (const std::size_t spheres : {1, 2, 5, 8, 9, 20, 64, 100, 500}) {
      if (method == Method::hubbard && spheres > 20) continue;  // slow
      const std::string what = std::string(name(method)) + " on " + body + ", " + std::to_string(spheres);
      const CoveredTree model = build(mesh, {.method = method, .spheres = spheres});
      EXPECT_LE(model.tree.leaf_count(), spheres) << what;
      // Two balls are tighter than five that a grid places: fewer is right where all of them would be looser.
      if (static_cast<double>(model.tree.leaf_count()) < 0.8 * static_cast<double>(spheres)) {
        ASSERT_LE(spheres, static_cast<std::size_t>(max_branching)) << what;
        const CoveredTree all = build(mesh, {.method = method, .branching = static_cast<int>(spheres), .depth = 1});
        EXPECT_GT(all.tree.leaf_count(), model.tree.leaf_count()) << what;
        EXPECT_LT(loose(mesh, model), loose(mesh, all)) << what;
      }
      EXPECT_TRUE(model.report.complete) << what;
      ASSERT_TRUE(model.report.protrusion_bound.has_value());
      expect_sound(mesh, model, what);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Quick, FlatSetBy, testing::Values(Method::octree), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, FlatSetBy, testing::Values(Method::grid, Method::hubbard, Method::spawn),
                         test::method_name);

TEST(FlatSet, keeps_within_every_branching) {
  const Mesh mesh = sample_body("limb", 12);
  for (const int branching : {2, 3, 17, 64})
    for (const std::size_t spheres : {3, 30, 200}) {
      const CoveredTree model = build(mesh, {.method = Method::octree, .branching = branching, .spheres = spheres});
      const std::string what = std::to_string(branching) + ", " + std::to_string(spheres);
      EXPECT_LE(model.tree.leaf_count(), spheres) << what;
      for (const std::uint32_t count : model.tree.child_count) EXPECT_LE(count, static_cast<std::uint32_t>(branching));
      EXPECT_LE(model.tree.level_count(), static_cast<std::size_t>(max_depth) + 1);
      expect_sound(mesh, model, what);
    }
}

class FlatSetOfAll : public test::ByMethod {};

TEST_P(FlatSetOfAll, every_kind_of_mesh_is_sound) {
  for (const test::NamedMesh& named : test::all_meshes())
    for (const std::size_t spheres : {2, 30}) {
      const CoveredTree model = build(named.mesh, {.method = GetParam(), .spheres = spheres});
      EXPECT_LE(model.tree.leaf_count(), spheres) << named.name;
      const auto faults = validate(named.mesh, model);
      EXPECT_TRUE(faults.empty()) << named.name << ": " << (faults.empty() ? "" : faults.front());
    }
}

INSTANTIATE_TEST_SUITE_P(Quick, FlatSetOfAll, testing::Values(Method::octree), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, FlatSetOfAll, testing::Values(Method::grid), test::method_name);

TEST(FlatSet, works_with_every_method) {
  const Mesh mesh = sample_body("bar", 6);
  for (const Method method : all_methods()) {
    const CoveredTree few = build(mesh, {.method = method, .spheres = 5});
    EXPECT_EQ(few.tree.leaf_count(), 5u) << name(method);
    expect_sound(mesh, few, std::string(name(method)));
  }
}

class FlatSetBits : public test::ByMethod {};

TEST_P(FlatSetBits, are_the_same_for_any_number_of_workers) {
  const Mesh mesh = sample_body("limb", 16);
  for (const double protrusion : {0.0, 0.08})
    test::expect_same_bits_for_any_number_of_workers(
        mesh, {.method = GetParam(), .spheres = protrusion > 0 ? 0u : 60u, .max_protrusion = protrusion});
}

INSTANTIATE_TEST_SUITE_P(Quick, FlatSetBits, testing::Values(Method::octree), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, FlatSetBits, testing::Values(Method::grid, Method::spawn), test::method_name);

TEST(LongFlatSet, gets_tighter_with_more_spheres) {
  const Mesh mesh = sample_body("limb", 16);
  for (const Method method : {Method::octree, Method::grid, Method::spawn}) {
    double before = std::numeric_limits<double>::infinity();
    for (const std::size_t spheres : {1, 8, 40, 200}) {
      const double now = loose(mesh, build(mesh, {.method = method, .spheres = spheres}));
      EXPECT_LT(now, before) << name(method) << ' ' << spheres;
      before = now;
    }
  }
}

TEST(FlatSet, is_tighter_than_a_level_of_as_many_spheres) {
  for (const char* body : {"limb", "blob", "torus"})
    for (const Method method : {Method::octree, Method::grid}) {
      const Mesh mesh = sample_body(body, 24);
      const CoveredTree levels = build(mesh, {.method = method, .depth = 2});
      const CoveredTree flat = build(mesh, {.method = method, .spheres = levels.tree.leaf_count()});
      EXPECT_LT(loose(mesh, flat), loose(mesh, levels)) << body << ' ' << name(method);
    }
}

TEST(MaxProtrusion, holds_for_every_leaf_and_needs_fewer_spheres_the_larger_it_is) {
  for (const char* body : {"limb", "blob"})
    for (const Method method : cheap) {
      const Mesh mesh = sample_body(body, 16);
      const SignedDistance object(mesh);
      const double diagonal = bounding_box(mesh).diagonal();
      std::size_t before = std::numeric_limits<std::size_t>::max();
      for (const double share : {0.02, 0.05, 0.2}) {
        const std::string what = std::string(name(method)) + " on " + body + ", " + std::to_string(share);
        const CoveredTree model = build(mesh, {.method = method, .max_protrusion = share * diagonal});
        EXPECT_TRUE(model.report.complete) << what;
        EXPECT_LT(model.tree.leaf_count(), before) << what;
        before = model.tree.leaf_count();
        double worst = 0;
        for (const Sphere& sphere : leaves(model)) worst = std::max(worst, object.protrusion_bound(sphere));
        EXPECT_LE(worst, share * diagonal) << what;
        EXPECT_EQ(model.report.protrusion_bound, worst) << what;
        // What a branch-and-bound search finds, which knows nothing of the bound.
        EXPECT_LE(protrusion(object, leaves(model), 1e-2).worst, share * diagonal * (1 + 1e-2)) << what;
        expect_sound(mesh, model, what);
      }
    }
}

TEST(MaxProtrusion, of_the_whole_object_needs_one_sphere) {
  const Mesh mesh = sample_body("blob", 12);
  const CoveredTree model = build(mesh, {.max_protrusion = 100});
  EXPECT_EQ(model.tree.node_count(), 1u);
  EXPECT_TRUE(model.report.complete);
}

TEST(MaxProtrusion, that_cannot_be_had_is_reported) {
  // Spheres of a flat plate's surface stick out whatever their size, until branching 2 runs out of levels.
  const Mesh mesh = sample_body("plate", 6);
  const CoveredTree model = build(mesh, {.method = Method::octree, .branching = 2, .max_protrusion = 1e-6});
  EXPECT_FALSE(model.report.complete);
  ASSERT_FALSE(model.report.notes.empty());
  EXPECT_NE(model.report.notes[0].find("stick out by more than 1e-06"), std::string::npos) << model.report.notes[0];
  EXPECT_NE(model.report.notes[0].find("level 8"), std::string::npos) << model.report.notes[0];
  expect_sound(mesh, model, "plate");
}

TEST(MaxProtrusion, with_a_number_of_spheres_ends_with_the_one_or_the_other) {
  const Mesh mesh = sample_body("limb", 16);
  const double length = 0.05 * bounding_box(mesh).diagonal();
  const std::size_t needed = build(mesh, {.max_protrusion = length}).tree.leaf_count();
  ASSERT_GT(needed, 4u);
  const CoveredTree enough = build(mesh, {.spheres = 10 * needed, .max_protrusion = length});
  EXPECT_EQ(enough.tree.leaf_count(), needed);
  EXPECT_TRUE(enough.report.complete);
  const CoveredTree few = build(mesh, {.spheres = needed / 2, .max_protrusion = length});
  EXPECT_LE(few.tree.leaf_count(), needed / 2);
  EXPECT_FALSE(few.report.complete);
  EXPECT_GT(few.report.protrusion_bound, length);
  expect_sound(mesh, few, "few");
}

TEST(FlatSet, that_cannot_be_divided_further_says_so) {
  Mesh point;
  point.positions.assign(3, Vec3{1, 2, 3});
  point.facets = {{0, 1, 2}};
  const CoveredTree model = build(point, {.spheres = 10});
  EXPECT_EQ(model.tree.node_count(), 1u);
  EXPECT_TRUE(validate(point, model).empty());
  ASSERT_FALSE(model.report.notes.empty());
  EXPECT_NE(model.report.notes[0].find("1 spheres, not 10"), std::string::npos) << model.report.notes[0];
}

}  // namespace
}  // namespace morula
