// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Parts that change hands across parents, and the demand that shares the surface out.
#include <gtest/gtest.h>

#include <algorithm>
#include <generators/divide/demand.hpp>
#include <generators/divide/exchange.hpp>
#include <generators/reduce/reduce.hpp>
#include <generators/reduce/reducers.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <support/meshes.hpp>

namespace morula {
using namespace detail;
namespace {

struct Made {
  CoveredTree model;
  std::vector<BuildNode> before, after;  // of level 2
};
Made exchanged(const Mesh& mesh, int rounds, Workers& workers) {
  const ObjectShape shape(mesh);
  const ObjectLines lines(mesh, shape, 96, serial_workers());
  const FitInput input = fit_input(mesh, shape, lines);
  const BuildRun run({.method = Method::grid, .depth = 2}, mesh);
  const ReduceSettings settings{
      .fit = {.spacing = 0.2, .cell = 0.3, .cells_per_radius = 3, .balance = 0, .exact_rounds = 1},
      .changes = {0, 0, 0},
      .move_every = 5};
  Made made;
  made.model = top_down(mesh, run,
                        {.divide = divide_by(input, run, propose_grid, settings),
                         .new_level =
                             [&](std::vector<BuildNode>& nodes) {
                               if (nodes[0].level != 2) return;
                               made.before = nodes;
                               exchange(input, nodes, rounds, workers);
                               made.after = nodes;
                             }},
                        workers);
  return made;
}

double surface_of(const Mesh& mesh, std::span<const BuildNode> nodes) {
  double sum = 0;
  for (const BuildNode& node : nodes) sum += area_of(mesh, node.region);
  return sum;
}

TEST(Exchange, keeps_every_region_inside_its_sphere_and_all_its_ancestors) {
  for (const char* body : {"limb", "torus", "two"}) {
    const Mesh mesh = sample_body(body, 16);
    const Made made = exchanged(mesh, 2, serial_workers());
    ASSERT_EQ(made.before.size(), made.after.size());
    std::size_t changed = 0;
    std::vector<Vec3> corners;
    for (std::size_t i = 0; i < made.after.size(); ++i) {
      const BuildNode& node = made.after[i];
      EXPECT_FALSE(node.region.empty()) << body;
      EXPECT_EQ(node.ancestors, made.before[i].ancestors);
      EXPECT_EQ(node.parent, made.before[i].parent);
      corner_positions(mesh, node.region, corners);
      for (const Vec3& p : corners) {
        ASSERT_LE(distance(node.sphere.center, p), node.sphere.radius) << body;
        for (const Sphere& a : node.ancestors) ASSERT_LE(distance(a.center, p), a.radius) << body;
      }
      changed += std::abs(area_of(mesh, node.region) / area_of(mesh, made.before[i].region) - 1) > 1e-6;
    }
    EXPECT_GT(4 * changed, made.after.size()) << body << ": next to nothing changed hands";
    EXPECT_NEAR(surface_of(mesh, made.after) / surface_of(mesh, made.before), 1, 1e-9) << body;
    const auto faults = validate(mesh, made.model);
    EXPECT_TRUE(faults.empty()) << faults.front();
  }
}

TEST(Exchange, has_the_same_bits_for_any_number_of_workers) {
  const Mesh mesh = sample_body("limb", 12);
  const std::uint64_t reference = tree_hash(exchanged(mesh, 2, serial_workers()).model.tree);
  for (const unsigned threads : {1u, 2u, 3u, 8u}) {
    Workers workers(threads);
    EXPECT_EQ(tree_hash(exchanged(mesh, 2, workers).model.tree), reference) << threads;
  }
}

TEST(Demand, is_positive_and_larger_where_the_surface_is_finely_structured) {
  const Mesh mesh =
      test::joined(test::icosphere(4), test::translated(test::scaled(sample_body("torus", 16), 0.15), {1.25, 0, 0}));
  const ObjectShape shape(mesh);
  const BuildRun run({.method = Method::optimized, .depth = 2, .quality = Quality::fast}, mesh);
  const ObjectLines lines(mesh, shape, lattice_cells(mesh, shape, run.branching, run.depth), serial_workers());
  const FitInput input = fit_input(mesh, shape, lines);
  const CoveredTree first = fast_tree(input, run, serial_workers());
  const Demand demand = demand_from(input, first, serial_workers());
  double large = 0, small = 0;
  int large_count = 0, small_count = 0;
  for (const SurfacePoint& s : sample_surface(mesh, 3000)) {
    const double d = demand(s.point);
    EXPECT_GT(d, 0);
    EXPECT_TRUE(std::isfinite(d));
    (s.point.x > 1.01 ? small : large) += d;
    ++(s.point.x > 1.01 ? small_count : large_count);
  }
  ASSERT_GT(small_count, 20);
  EXPECT_GT(small / small_count, 1.5 * large / large_count);
}

}  // namespace
}  // namespace morula
