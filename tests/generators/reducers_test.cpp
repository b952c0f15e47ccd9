// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Hubbard, spawn, the adaptive medial axis and the optimizers on single nodes, and the options that choose them.
#include <gtest/gtest.h>

#include <algorithm>
#include <generators/reduce/adaptive_medial.hpp>
#include <generators/reduce/optimize.hpp>
#include <generators/reduce/reducers.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <support/meshes.hpp>
#include <support/methods.hpp>

namespace morula {
using namespace detail;
namespace {

// A mesh as a single node.
struct WholeNode {
  Mesh mesh;
  ObjectShape shape;
  std::vector<Vec3> samples, normals;
  Sphere sphere;

  explicit WholeNode(Mesh mesh_, std::size_t count = 300) : mesh(std::move(mesh_)), shape(mesh) {
    for (const SurfacePoint& s : sample_surface(mesh, count, 1)) {
      const Triangle t = mesh.corners(s.facet);
      samples.push_back(s.point);
      normals.push_back(normalized(cross(t[1] - t[0], t[2] - t[0])) * shape.orientation());
    }
    sphere = enclosing_sphere(samples);
  }
  ReducerInput input(std::size_t branching = 8) const { return {samples, normals, sphere, branching, 1, shape}; }
};

double worst_protrusion(const SignedDistance& shape, std::span<const Sphere> spheres) {
  double worst = 0;
  for (const Sphere& s : spheres) worst = std::max(worst, shape.protrusion_bound(s));
  return worst;
}

bool contain_all(std::span<const Sphere> spheres, std::span<const Vec3> points) {
  return std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
    return std::any_of(spheres.begin(), spheres.end(),
                       [&](const Sphere& s) { return distance(s.center, p) <= s.radius * (1 + 1e-9); });
  });
}

TEST(Reducers, contain_the_samples_with_few_spheres) {
  const BuildOptions options;
  for (const char* body : {"limb", "blob", "torus", "bar"}) {
    const WholeNode node(sample_body(body, 20));
    for (const std::size_t branching : {std::size_t{3}, std::size_t{8}, std::size_t{20}})
      for (const Proposal& p :
           combined_reducer({all_reductions().begin(), all_reductions().end()}, options)(node.input(branching))) {
        EXPECT_FALSE(p.spheres.empty());
        EXPECT_LE(p.spheres.size(), branching) << p.reducer;
        EXPECT_TRUE(contain_all(p.spheres, node.samples)) << p.reducer << " on " << body;
        for (const Sphere& s : p.spheres) EXPECT_LT(s.radius, 1.5 * node.sphere.radius) << p.reducer << " on " << body;
      }
  }
}

TEST(Reducers, leave_what_cannot_be_done_to_halving) {
  const Mesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const ObjectShape shape(box);
  // Without normals, as on facets without area, no ball can be inscribed.
  const std::vector<Vec3> equal(20, Vec3{0.5, 0.5, 0}), normals(20, Vec3{0, 0, 0});
  std::vector<Vec3> line, plane;
  for (int i = 0; i < 20; ++i) {
    line.push_back({0.05 * i, 0.5, 0});
    plane.push_back({0.2 * (i % 5), 0.25 * (i / 5), 0});
  }
  for (const std::vector<Vec3>& samples : {equal, line, plane, std::vector<Vec3>{}}) {
    const Sphere sphere = enclosing_sphere(samples);
    const ReducerInput node{samples, std::span(normals).first(samples.size()), sphere, 4, 1, shape};
    const Reducer all = combined_reducer({all_reductions().begin(), all_reductions().end()}, {});
    for (const Proposal& p : all(node))
      for (const Sphere& s : p.spheres) {
        EXPECT_TRUE(is_finite(s.center));
        EXPECT_TRUE(std::isfinite(s.radius)) << p.reducer;
      }
    // Medial balls need samples that are not in one plane.
    const Proposals medial = combined_reducer({Reduction::merge, Reduction::expand}, {})(node);
    ASSERT_EQ(medial.size(), 1u);
    EXPECT_EQ(medial[0].reducer, no_proposal);
    EXPECT_EQ(medial[0].spheres, std::vector<Sphere>{sphere});
  }
}

TEST(AdaptiveMedial, has_inscribed_balls_on_a_flat_part) {
  const Mesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const ObjectShape shape(box);
  std::vector<Vec3> plane;
  for (int i = 0; i < 20; ++i) plane.push_back({0.1 + 0.2 * (i % 5), 0.2 + 0.2 * (i / 5), 0});
  const std::vector<Vec3> normals(plane.size(), Vec3{0, 0, -1});
  const BallSet set = adaptive_medial({plane, normals, enclosing_sphere(plane), 4, 1, shape});
  ASSERT_GT(set.size(), 5u);
  for (std::size_t i = 0; i < set.size(); ++i)
    EXPECT_NEAR(set.ball(i).radius, -shape.distance()(set.ball(i).center), 1e-9);
}

TEST(AdaptiveMedial, covers_the_samples_and_sticks_out_little) {
  for (const char* body : {"limb", "torus", "plate"}) {
    const WholeNode node(sample_body(body, 24));
    const BallSet set = adaptive_medial(node.input());
    ASSERT_GT(set.size(), 100u) << body;
    std::vector<Sphere> balls;
    std::size_t within_target = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
      balls.push_back(set.ball(i));
      EXPECT_NEAR(set.distance(i), node.shape.distance()(set.ball(i).center), 1e-12);
      within_target +=
          set.protrusion(i, set.ball(i).radius) <= 0.5 * node.shape.distance().protrusion_bound(node.sphere);
    }
    EXPECT_GE(10 * within_target, 9 * set.size()) << body;
    std::size_t missed = 0;
    // Balls go through the samples that form them but for the rounding of the diagram's lattice.
    for (Sphere& b : balls) b.radius *= 1 + 1e-4;
    for (const Vec3& p : node.samples) missed += !contain_all(balls, std::span(&p, 1));
    EXPECT_LE(50 * missed, node.samples.size()) << body;
  }
}

TEST(Optimize, never_makes_the_worst_sphere_worse_and_keeps_the_samples) {
  for (const char* body : {"limb", "blob"}) {
    const WholeNode node(sample_body(body, 16));
    const Proposals grid = propose_grid(node.input());
    ASSERT_FALSE(grid.empty());
    // What there is to start from: the proposal with its samples shared out, which `balance` without room leaves.
    for (const Optimizer optimizer : {Optimizer::recenter, Optimizer::simplex, Optimizer::balance}) {
      Proposal p = grid[0];
      const double before = worst_protrusion(node.shape.distance(), p.spheres);
      optimize(p, node.input(), optimizer, 0);
      EXPECT_TRUE(contain_all(p.spheres, node.samples)) << name(optimizer);
      EXPECT_LE(p.spheres.size(), grid[0].spheres.size());
      EXPECT_LT(worst_protrusion(node.shape.distance(), p.spheres), before) << name(optimizer);
      Proposal again = grid[0];
      optimize(again, node.input(), optimizer, 0);
      EXPECT_EQ(again.spheres, p.spheres);
    }
    Proposal untouched = grid[0];
    optimize(untouched, node.input(), Optimizer::none, 0);
    EXPECT_EQ(untouched.spheres, grid[0].spheres);
  }
}

TEST(Optimize, balance_trades_spheres_for_excess_and_leaves_at_least_three) {
  const WholeNode node(sample_body("limb", 16));
  const Proposals spawn = propose_spawn(node.input());
  ASSERT_EQ(spawn.size(), 1u);
  std::size_t before = spawn[0].spheres.size() + 1;
  for (const double excess : {0.0, 0.5, 100.0}) {
    Proposal p = spawn[0];
    optimize(p, node.input(), Optimizer::balance, excess);
    EXPECT_LE(p.spheres.size(), before);
    EXPECT_GE(p.spheres.size(), 3u);
    EXPECT_TRUE(contain_all(p.spheres, node.samples));
    EXPECT_EQ(p.fill_places, p.spheres.size() == spawn[0].spheres.size());
    before = p.spheres.size();
  }
  EXPECT_EQ(before, 3u);
}

TEST(BuildOptions, are_refused_where_a_method_has_no_use_for_them) {
  const Mesh mesh = sample_body("bar", 3);
  const auto refused = [&](const BuildOptions& options) { EXPECT_THROW(build(mesh, options), std::invalid_argument); };
  refused({.method = Method::grid, .reducers = {Reduction::merge}});
  refused({.method = Method::medial, .reducers = {Reduction::grid}});
  refused({.method = Method::combined, .reducers = {Reduction::grid, Reduction::grid}});
  refused({.method = Method::octree, .optimizer = Optimizer::recenter});
  refused({.method = Method::grid, .balance_excess = 0.1});
  refused({.method = Method::grid, .optimizer = Optimizer::balance, .balance_excess = -1});
  refused({.method = Method::grid, .optimizer = Optimizer::balance, .balance_excess = NAN});
}

TEST(BuildOptions, reducers_and_optimizers_have_names) {
  for (const Reduction r : all_reductions()) EXPECT_EQ(reduction_from_name(name(r)), r);
  for (const Optimizer o : all_optimizers()) EXPECT_EQ(optimizer_from_name(name(o)), o);
  EXPECT_FALSE(reduction_from_name("octree").has_value());
  EXPECT_FALSE(optimizer_from_name("").has_value());
}

TEST(Combined, says_which_reducers_won) {
  const Mesh mesh = sample_body("blob", 16);
  const CoveredTree model = build(mesh, {.method = Method::combined, .depth = 2});
  ASSERT_FALSE(model.report.notes.empty());
  EXPECT_NE(model.report.notes.back().find("proposals taken: "), std::string::npos);
}

using OptimizedBy = test::ByMethod;

TEST_P(OptimizedBy, trees_keep_their_proof) {
  const Mesh mesh = sample_body("limb", 12);
  for (const Optimizer optimizer : all_optimizers()) {
    const CoveredTree model = build(mesh, {.method = GetParam(), .depth = 2, .optimizer = optimizer});
    EXPECT_TRUE(validate(mesh, model).empty()) << name(optimizer);
  }
}

INSTANTIATE_TEST_SUITE_P(Quick, OptimizedBy, testing::Values(Method::grid, Method::spawn), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, OptimizedBy, testing::ValuesIn(test::slow_methods), test::method_name);

}  // namespace
}  // namespace morula
