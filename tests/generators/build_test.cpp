// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What every generator promises, on every kind of mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/accuracy/looseness.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <support/meshes.hpp>
#include <support/methods.hpp>

#include "same_bits.hpp"

namespace morula {
namespace {

// Promises do not depend on the quality: method optimized keeps them at its fastest here, and at the others in
// own_test.
Quality quick(Method method) {
  return method == Method::optimized ? Quality::fast : Quality::standard;
}

std::string described(Method method, const std::string& mesh, int branching, int depth) {
  return std::string(name(method)) + " on " + mesh + ", branching " + std::to_string(branching) + ", depth " +
         std::to_string(depth);
}

void expect_promises_kept(const Mesh& mesh, const BuildOptions& options, const std::string& what) {
  const CoveredTree model = build(mesh, options);
  const auto faults = validate(mesh, model);
  EXPECT_TRUE(faults.empty()) << what << ": " << (faults.empty() ? "" : faults.front());
  EXPECT_LE(model.tree.level_count(), static_cast<std::size_t>(options.depth.value()) + 1) << what;
  EXPECT_EQ(model.tree.branching, static_cast<std::uint32_t>(options.branching)) << what;
  EXPECT_EQ(model.report.mesh_hash, mesh_hash(mesh)) << what;
  // The certificate's claim, seen from outside: samples of the surface in plain arithmetic.
  for (std::size_t level = 0; level < model.tree.level_count(); ++level) {
    const std::vector<Sphere> spheres = level_set_spheres(model.tree, level);
    for (const SurfacePoint& s : sample_surface(mesh, 200, 4)) {
      const bool inside = std::any_of(spheres.begin(), spheres.end(), [&](const Sphere& b) {
        return distance(b.center, s.point) <= b.radius * (1 + 1e-12);
      });
      ASSERT_TRUE(inside) << what << ", level " << level;
    }
  }
}

using BuildBy = test::ByMethod;

TEST_P(BuildBy, covers_every_kind_of_mesh) {
  for (const test::NamedMesh& named : test::all_meshes())
    expect_promises_kept(named.mesh, {.method = GetParam(), .depth = 2, .quality = quick(GetParam())},
                         described(GetParam(), named.name, 8, 2));
}

class BuildInEveryForm : public test::ByMethod {};

TEST_P(BuildInEveryForm, keeps_its_promises_for_every_branching_and_depth) {
  const Mesh mesh = sample_body("limb", 8);
  const Method method = GetParam();
  // Those that make medial balls take some 20 ms per node.
  const bool slow = method == Method::hubbard || method == Method::medial || method == Method::combined;
  const auto expect = [&](int branching, int depth) {
    expect_promises_kept(mesh, {.method = method, .branching = branching, .depth = depth, .quality = quick(method)},
                         described(method, "limb", branching, depth));
  };
  for (const int branching : {2, 3, 5, 8, 13}) expect(branching, slow ? 1 : 2);
  expect(64, slow ? 1 : 2);
  for (const int depth : {0, 1, slow ? 2 : 4}) expect(4, depth);
  expect(2, slow ? 4 : 8);
}

INSTANTIATE_TEST_SUITE_P(Quick, BuildInEveryForm, testing::Values(Method::octree), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, BuildInEveryForm,
                         testing::Values(Method::grid, Method::hubbard, Method::spawn, Method::medial, Method::combined,
                                         Method::optimized),
                         test::method_name);

TEST_P(BuildBy, keeps_its_promises_for_the_least_and_the_most_branching) {
  const Mesh mesh = sample_body("limb", 6);
  for (const int branching : {2, 64})
    expect_promises_kept(mesh, {.method = GetParam(), .branching = branching, .depth = 1, .quality = quick(GetParam())},
                         described(GetParam(), "limb", branching, 1));
}

TEST_P(BuildBy, has_the_same_bits_for_any_number_of_workers_and_on_every_run) {
  test::expect_same_bits_for_any_number_of_workers(sample_body("blob", 16),
                                                   {.method = GetParam(), .depth = 2, .quality = quick(GetParam())});
}

TEST(LongBuild, of_default_quality_has_the_same_bits_for_any_number_of_workers_and_on_every_run) {
  test::expect_same_bits_for_any_number_of_workers(sample_body("blob", 16), {.method = Method::optimized, .depth = 2});
}

// All that medial balls are made for, on little: the rest of it is long.
TEST(Build, covers_and_keeps_its_promises_with_the_slow_methods) {
  for (const Method method : test::slow_methods)
    for (const char* mesh : {"moebius_strip", "folded_facet", "needle"})
      expect_promises_kept(test::mesh_named(mesh).mesh, {.method = method, .branching = 4, .depth = 1},
                           described(method, mesh, 4, 1));
}

TEST(Build, makes_the_golden_trees) {
  // Changes when a generator changes; must not change with compiler, processor or build type.
  const Mesh mesh = sample_body("limb", 16);
  const auto hash = [&](Method method, Quality quality = Quality::standard) {
    return tree_hash(build(mesh, {.method = method, .depth = 2, .quality = quality}).tree);
  };
  EXPECT_EQ(hash(Method::octree), 0x40e7147504044a26u);
  EXPECT_EQ(hash(Method::grid), 0xbbcdc7e8130638d8u);
  EXPECT_EQ(hash(Method::hubbard), 0x94214f813dd1731eu);
  EXPECT_EQ(hash(Method::spawn), 0x79fe65e1a31a4685u);
  EXPECT_EQ(hash(Method::medial), 0x5e3f8c1a816fd05eu);
  EXPECT_EQ(hash(Method::optimized, Quality::fast), 0x2be1ba1db68aef95u);
  EXPECT_EQ(hash(Method::optimized), 0xa08096af933f62ceu);
}

TEST_P(BuildBy, moves_and_scales_with_its_input) {
  const Mesh mesh = sample_body("limb", 16);
  const Vec3 offset{3, -7, 11};
  const BuildOptions options{.method = GetParam(), .depth = 2, .quality = quick(GetParam())};
  const SphereTree here = build(mesh, options).tree;
  // Powers of two scale every number of the computation exactly.
  const SphereTree larger = build(test::scaled(mesh, 4), options).tree;
  ASSERT_EQ(larger.node_count(), here.node_count());
  for (std::size_t i = 0; i < here.node_count(); ++i) {
    EXPECT_NEAR(larger.spheres[i].radius, 4 * here.spheres[i].radius, 1e-9);
    EXPECT_LT(distance(larger.spheres[i].center, here.spheres[i].center * 4.0), 1e-9);
  }
  // Elsewhere coordinates are rounded differently, and a search may end at another optimum that is as good.
  const Mesh moved = test::translated(mesh, offset);
  const SphereTree there = build(moved, options).tree;
  for (std::size_t level = 1; level <= 2; ++level) {
    const double here_loose = looseness(mesh, level_set_spheres(here, level)).looseness.value();
    const double there_loose = looseness(moved, level_set_spheres(there, level)).looseness.value();
    EXPECT_NEAR(there_loose / here_loose, 1, 0.25) << "level " << level;
  }
}

TEST_P(BuildBy, gets_tighter_with_depth) {
  const Mesh mesh = sample_body("torus", 24);
  const SphereTree tree = build(mesh, {.method = GetParam(), .quality = quick(GetParam())}).tree;
  const auto loose = [&](std::size_t level) {
    return looseness(mesh, level_set_spheres(tree, level), {.resolution = 64}).looseness.value();
  };
  // The first division may be no tighter than the root: eight spheres around the octants of a flat body stick out of
  // it.
  EXPECT_LE(loose(1), loose(0));
  for (std::size_t level = 2; level < tree.level_count(); ++level)
    EXPECT_LT(loose(level), loose(level - 1)) << "level " << level;
}

INSTANTIATE_TEST_SUITE_P(Quick, BuildBy, testing::ValuesIn(test::quick_methods), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, BuildBy, testing::ValuesIn(test::slow_methods), test::method_name);

TEST(Methods, are_quick_or_slow) {
  std::vector<Method> both(test::quick_methods.begin(), test::quick_methods.end());
  both.insert(both.end(), test::slow_methods.begin(), test::slow_methods.end());
  std::sort(both.begin(), both.end());
  std::vector<Method> all(all_methods().begin(), all_methods().end());
  std::sort(all.begin(), all.end());
  EXPECT_EQ(both, all);
}

TEST(Build, ends_early_where_there_is_nothing_to_divide) {
  Mesh point;
  point.positions.assign(3, Vec3{1, 2, 3});
  point.facets = {{0, 1, 2}};
  for (const Method method : all_methods()) {
    const CoveredTree model = build(point, {.method = method});
    EXPECT_EQ(model.tree.node_count(), 1u);
    EXPECT_FALSE(model.report.notes.empty());
    EXPECT_TRUE(validate(point, model).empty());
  }
}

TEST(Build, reports_progress_that_never_goes_back) {
  for (const Method method : all_methods()) {
    std::vector<double> seen;
    build(sample_body("bar", 8),
          {.method = method, .depth = 2, .progress = [&](const BuildProgress& p) { seen.push_back(p.share); }});
    ASSERT_GE(seen.size(), 2u);
    EXPECT_EQ(seen.front(), 0);
    EXPECT_EQ(seen.back(), 1);
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  }
}

TEST(Build, refuses_bad_options_and_meshes_before_any_work) {
  const Mesh mesh = sample_body("bar", 3);
  EXPECT_THROW(build(mesh, {.branching = 1}), std::invalid_argument);
  EXPECT_THROW(build(mesh, {.branching = 65}), std::invalid_argument);
  EXPECT_THROW(build(mesh, {.depth = -1}), std::invalid_argument);
  EXPECT_THROW(build(mesh, {.depth = 9}), std::invalid_argument);
  EXPECT_THROW(build(Mesh{}, {}), std::invalid_argument);
  Mesh broken = mesh;
  broken.positions[0].x = NAN;
  EXPECT_THROW(build(broken, {}), std::invalid_argument);
}

TEST(Build, knows_its_methods_by_name) {
  for (const Method method : all_methods()) EXPECT_EQ(method_from_name(name(method)), method);
  EXPECT_FALSE(method_from_name("sphere-o-matic").has_value());
}

}  // namespace
}  // namespace morula
