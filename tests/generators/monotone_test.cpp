// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// No level is looser than the level above it: judged by points strewn over both, which share no code with the builds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <numbers>
#include <string>
#include <support/meshes.hpp>
#include <support/methods.hpp>
#include <vector>

namespace morula {
namespace {

// By the solid angles of all facets [vanoosterom1983].
bool is_outside(const Mesh& mesh, const Vec3& p) {
  double turns = 0;
  for (const Facet& f : mesh.facets) {
    const Vec3 a = mesh.positions[f[0]] - p, b = mesh.positions[f[1]] - p, c = mesh.positions[f[2]] - p;
    const double la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
    turns += std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return std::abs(turns) < std::numbers::pi;
}

bool in_union(const std::vector<Sphere>& spheres, const Vec3& p) {
  for (const Sphere& s : spheres) {
    const Vec3 d = p - s.center;
    if (d.x * d.x + d.y * d.y + d.z * d.z <= s.radius * s.radius) return true;
  }
  return false;
}

// Points, one in each cell of a lattice, of empty space that only one of two levels takes in.
struct Difference {
  double lost = 0, gained = 0;  // only in the finer, only in the coarser level
};
Difference difference(const Mesh& mesh, const std::vector<Sphere>& coarser, const std::vector<Sphere>& finer) {
  Box box;
  for (const auto* level : {&coarser, &finer})
    for (const Sphere& s : *level) {
      box.add(s.center - Vec3{s.radius, s.radius, s.radius});
      box.add(s.center + Vec3{s.radius, s.radius, s.radius});
    }
  const Vec3 extent = box.upper - box.lower;
  constexpr double cells = 80'000;
  const double edge = std::cbrt(extent.x * extent.y * extent.z / cells);
  Random random(1);
  Difference result;
  for (double x = box.lower.x; x < box.upper.x; x += edge)
    for (double y = box.lower.y; y < box.upper.y; y += edge)
      for (double z = box.lower.z; z < box.upper.z; z += edge) {
        Vec3 p{x, y, z};
        p += Vec3{random.uniform(), random.uniform(), random.uniform()} * edge;
        const bool was = in_union(coarser, p), is = in_union(finer, p);
        if (was == is || !is_outside(mesh, p)) continue;
        (is ? result.lost : result.gained) += 1;
      }
  return result;
}

void expect_no_looser_level(const Mesh& mesh, const BuildOptions& options, const std::string& what) {
  const SphereTree tree = build(mesh, options).tree;
  for (std::size_t level = 1; level < tree.level_count(); ++level) {
    const Difference d = difference(mesh, level_set_spheres(tree, level - 1), level_set_spheres(tree, level));
    // Three times what chance makes of as many points.
    EXPECT_LE(d.lost - d.gained, 3 * std::sqrt(d.lost + d.gained))
        << name(options.method) << ", " << what << ", seed " << options.seed << ", level " << level;
  }
}

Mesh octahedron() {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.facets = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

using Monotone = test::ByMethod;

// Where it was not so: an octree of a coarse ring, and tubes, whose parts are a row of slabs.
TEST_P(Monotone, no_level_is_looser_than_the_level_above) {
  for (const auto& [what, mesh] :
       {std::pair{"ring", sample_body("torus", 6)}, std::pair{"tube", sample_body("capsule", 12)}})
    expect_no_looser_level(mesh,
                           {.method = GetParam(),
                            .depth = 3,
                            .quality = GetParam() == Method::optimized ? Quality::fast : Quality::standard},
                           what);
}

INSTANTIATE_TEST_SUITE_P(Quick, Monotone, testing::ValuesIn(test::quick_methods), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, Monotone, testing::ValuesIn(test::slow_methods), test::method_name);

using AnyMonotone = test::ByMethod;

TEST_P(AnyMonotone, no_level_is_looser_whatever_the_body_and_the_seed) {
  const std::vector<std::pair<std::string, Mesh>> bodies{{"octahedron", octahedron()},
                                                         {"box", test::box_mesh({0, 0, 0}, {1, 1, 1}, 1)},
                                                         {"ball", test::icosphere(2)},
                                                         {"torus", sample_body("torus", 12)},
                                                         {"capsule", sample_body("capsule", 22)},
                                                         {"limb", sample_body("limb", 8)},
                                                         {"bar", sample_body("bar", 4)},
                                                         {"tool", sample_body("tool", 8)}};
  // MORULA_MONOTONE_SEEDS: so many. Three of a slow method take minutes.
  const bool is_slow =
      std::find(test::slow_methods.begin(), test::slow_methods.end(), GetParam()) != test::slow_methods.end() ||
      GetParam() == Method::optimized;
  const char* const given = std::getenv("MORULA_MONOTONE_SEEDS");
  const std::uint64_t seeds = given != nullptr ? std::strtoull(given, nullptr, 10) : is_slow ? 1 : 3;
  for (const auto& [what, mesh] : bodies)
    for (std::uint64_t seed = 1; seed <= seeds; ++seed)
      expect_no_looser_level(mesh, {.method = GetParam(), .depth = 3, .seed = seed}, what);
}

INSTANTIATE_TEST_SUITE_P(Nightly, AnyMonotone, testing::ValuesIn(all_methods().begin(), all_methods().end()),
                         test::method_name);

TEST(NightlyMonotoneForms, holds_for_other_branching_and_depths) {
  const Mesh mesh = sample_body("capsule", 12);
  for (const Method method : test::quick_methods)
    for (const auto& [branching, depth] : {std::pair{2, 7}, std::pair{4, 4}, std::pair{16, 2}, std::pair{64, 1}})
      expect_no_looser_level(mesh, {.method = method, .branching = branching, .depth = depth},
                             "branching " + std::to_string(branching));
}

}  // namespace
}  // namespace morula
