// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Looseness of open meshes, against closed ones, closed forms, and every voxel with every facet.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/accuracy/looseness.hpp>
#include <morula/accuracy/measure.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <numbers>

namespace morula::test {
namespace {

VoxelGrid level_grid(int resolution) {
  return {.kind = VoxelGrid::Kind::level, .resolution = resolution, .voxel_edge = 0};
}

/// The upper half of the unit ball, with or without its disc; n vertices around.
Mesh hemisphere(std::uint32_t n, bool with_disc) {
  Mesh mesh;
  const std::uint32_t rings = n / 4;
  for (std::uint32_t j = 0; j < rings; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const double up = 0.5 * std::numbers::pi * j / rings, around = 2 * std::numbers::pi * i / n;
      mesh.positions.push_back({std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up)});
    }
  mesh.positions.push_back({0, 0, 1});
  const auto top = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t j = 0; j < rings; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * n + i, b = j * n + (i + 1) % n;
      if (j + 1 == rings) {
        mesh.facets.push_back({a, b, top});
      } else {
        mesh.facets.push_back({a, b, b + n});
        mesh.facets.push_back({a, b + n, a + n});
      }
    }
  if (!with_disc) return mesh;
  mesh.positions.push_back({0, 0, 0});
  for (std::uint32_t i = 0; i < n; ++i) mesh.facets.push_back({(i + 1) % n, i, top + 1});
  return mesh;
}

const std::vector<Sphere>& some_spheres() {
  static const std::vector<Sphere> spheres{{{0, 0, 0.4}, 1.05}, {{0.5, 0.3, 0.2}, 0.8}, {{-0.6, 0, 0.1}, 0.5}};
  return spheres;
}

/// Half the solid angle of a facet [van Oosterom and Strackee 1983], in turns of the whole sphere.
double plain_turns(const Mesh& mesh, const Vec3& p) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const auto corners = mesh.corners(f);
    const Vec3 a = corners[0] - p, b = corners[1] - p, c = corners[2] - p;
    const double la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
    sum += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

TEST(OpenLooseness, counts_what_every_voxel_with_every_facet_counts) {
  const Mesh mesh = hemisphere(16, false);
  // No center of a voxel lies on a sphere or in the plane of the hole, where rounding decides.
  const std::vector<Sphere> spheres{
      {{0.0131, -0.0217, 0.3937}, 1.0613}, {{0.5171, 0.3023, 0.2119}, 0.8071}, {{-0.6013, 0.0151, 0.1303}, 0.5119}};
  const Looseness l = LoosenessMeter(mesh).measure_open(mesh.positions, spheres, level_grid(24));
  ASSERT_TRUE(l.looseness && l.range);
  // The lattice's phase is that of the spheres' box, and it goes past the object.
  Vec3 lower{1e9, 1e9, 1e9};
  for (const Sphere& s : spheres)
    for (int axis = 0; axis < 3; ++axis) lower[axis] = std::min(lower[axis], s.center[axis] - s.radius);
  const Mesh closed = hemisphere(16, true);
  std::size_t inside = 0, outside = 0, uncertain = 0, in_union = 0;
  double closed_turns = 0;
  for (int x = -8; x < 40; ++x)
    for (int y = -8; y < 40; ++y)
      for (int z = -8; z < 40; ++z) {
        const Vec3 p = lower + l.voxel_edge * Vec3{x + 0.5, y + 0.5, z + 0.5};
        const double turns = plain_turns(mesh, p);
        bool in_some = false;
        for (const Sphere& s : spheres) in_some = in_some || squared_distance(s.center, p) <= s.radius * s.radius;
        in_union += in_some;
        inside += turns > 0.5;
        outside += in_some && !(turns > 0.5);
        uncertain += turns > 0.495 && turns < 0.505;
        closed_turns += std::round(plain_turns(closed, p));
      }
  const double voxel = l.voxel_edge * l.voxel_edge * l.voxel_edge;
  EXPECT_NEAR(l.union_volume / voxel, static_cast<double>(in_union), 0.5);
  // The far field of the caps is right to 0.005 of a turn.
  const double beyond = signed_volume(closed) / voxel - closed_turns;
  EXPECT_NEAR(l.object_volume / voxel, static_cast<double>(inside) + beyond, static_cast<double>(uncertain) + 0.5);
  EXPECT_NEAR(l.outside_volume / voxel, static_cast<double>(outside), static_cast<double>(uncertain) + 0.5);
  EXPECT_LT(uncertain, inside / 10);
}

TEST(OpenLooseness, of_a_hemisphere_without_its_disc_is_that_of_the_closed_one) {
  const Mesh open = hemisphere(48, false), closed = hemisphere(48, true);
  for (const int resolution : {48, 96}) {
    const Looseness truth = LoosenessMeter(closed).measure(closed.positions, some_spheres(), level_grid(resolution));
    const Looseness l = LoosenessMeter(open).measure_open(open.positions, some_spheres(), level_grid(resolution));
    ASSERT_TRUE(truth.looseness && l.looseness && l.range);
    // A flat hole is closed by half a turn where its disc is: what is left is the lattice's layer of voxels.
    const double layer = l.voxel_edge * std::numbers::pi / truth.object_volume;
    EXPECT_NEAR(*l.looseness, *truth.looseness, layer * (1 + *truth.looseness)) << resolution;
    EXPECT_NEAR(l.object_volume, truth.object_volume, layer * truth.object_volume + 0.01) << resolution;
    EXPECT_LE(l.range->low, *truth.looseness);
    EXPECT_GE(l.range->high, *truth.looseness);
    EXPECT_LT(l.range->low, *l.looseness);
    EXPECT_GT(l.range->high, *l.looseness);
  }
}

TEST(OpenLooseness, of_a_body_with_a_facet_missing_is_that_of_the_body) {
  const Mesh closed = sample_body("limb", 16);
  const SphereTree tree = build(closed, {.method = Method::octree, .depth = 2}).tree;
  Mesh open = closed;
  open.facets.erase(open.facets.begin() + 100);
  const std::vector<LevelMeasure> truth = measure(closed, tree, {.grid = level_grid(64), .with_protrusion = false});
  const std::vector<LevelMeasure> levels =
      measure(open, tree, {.grid = level_grid(64), .with_protrusion = false, .open_by_winding = true});
  ASSERT_EQ(levels.size(), truth.size());
  for (std::size_t j = 0; j < levels.size(); ++j) {
    const Looseness& l = levels[j].looseness;
    ASSERT_TRUE(l.looseness && l.range);
    EXPECT_FALSE(truth[j].looseness.range) << "closed meshes are not asked";
    // Those of the closed one are divided by the signed volume, these by a count of voxels.
    EXPECT_NEAR(*l.looseness, *truth[j].looseness.looseness, 0.02 * (1 + *truth[j].looseness.looseness)) << j;
    EXPECT_NEAR(l.outside_volume, truth[j].looseness.outside_volume, 0.02) << j;
    EXPECT_LE(l.range->high - l.range->low, 0.05 * (1 + *l.looseness)) << "a small hole leaves little open";
  }
}

TEST(OpenLooseness, does_not_care_which_way_round_and_how_many_threads) {
  const Mesh mesh = hemisphere(24, false);
  Mesh inverted = mesh;
  for (Facet& f : inverted.facets) std::swap(f[1], f[2]);
  const Looseness a = LoosenessMeter(mesh).measure_open(mesh.positions, some_spheres(), level_grid(48));
  const Looseness b = LoosenessMeter(inverted).measure_open(mesh.positions, some_spheres(), level_grid(48));
  Workers three(3);
  const Looseness c = LoosenessMeter(mesh).measure_open(mesh.positions, some_spheres(), level_grid(48), three);
  EXPECT_EQ(*a.looseness, *c.looseness);
  EXPECT_EQ(a.range->low, c.range->low);
  EXPECT_NEAR(*a.looseness, *b.looseness, 1e-3);
}

TEST(OpenLooseness, says_nothing_of_sheets_and_of_facets_that_disagree) {
  const Mesh square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const Looseness sheet = LoosenessMeter(square).measure_open(square.positions, some_spheres(), level_grid(32));
  EXPECT_FALSE(sheet.looseness);
  EXPECT_FALSE(sheet.range);
  EXPECT_GT(sheet.union_volume, 0);
  Mesh mixed = hemisphere(24, false);
  std::swap(mixed.facets[30][1], mixed.facets[30][2]);
  EXPECT_FALSE(LoosenessMeter(mixed).measure_open(mixed.positions, some_spheres(), level_grid(32)).looseness);
}

}  // namespace
}  // namespace morula::test
