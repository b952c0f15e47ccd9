// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Layer patches: sums of many points, formulas, differences of volumes, dense slides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/surface/layer_patches.hpp>
#include <numbers>
#include <set>
#include <support/allocations.hpp>
#include <support/error_text.hpp>
#include <support/meshes.hpp>

#include "layer_oracle.hpp"
#include "surfaces.hpp"

namespace morula {
namespace {

using test::grid_plate;
using test::icosphere;
using test::LayerRule;

double plain_volume(const Mesh& a, const Mesh& b, double thickness, int points) {
  return 0.5 * (test::plain_layer(a, a.positions, b, b.positions, thickness, points) +
                test::plain_layer(b, b.positions, a, a.positions, thickness, points));
}

double volume_of(const Mesh& a, const Mesh& b, double thickness) {
  LayerPatchQuery query({.thickness = thickness});
  EXPECT_TRUE(query.run(SurfaceTree(a), SurfaceTree(b)));
  return query.volume();
}

Vec3 random_vector(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

/// A plate that is centered at the origin, with noise.
Mesh rough_plate(int n, double noise, Random& random) {
  Mesh mesh = test::translated(grid_plate(n), {-0.5, -0.5, 0});
  for (Vec3& p : mesh.positions) p += random_vector(random, noise);
  return mesh;
}

/// The relations that hold for every patch.
void expect_consistent(const LayerPatchQuery& query, const SurfaceTree& a, const SurfaceTree& b, double tolerance) {
  double volume = 0;
  for (const LayerPatch& patch : query.patches()) {
    volume += patch.volume;
    EXPECT_LE(length(patch.a.area_vector + patch.b.area_vector), tolerance);
    EXPECT_LE(length(patch.a.moment + patch.b.moment), tolerance);
    for (const LayerSide* side : {&patch.a, &patch.b}) {
      const SurfaceTree& surface = side == &patch.a ? a : b;
      Vec3 sum, moment;
      for (const VertexGradient& g : side->gradients) {
        sum += g.gradient;
        moment += cross(surface.from(g.vertex) - patch.centroid, g.gradient);
      }
      EXPECT_LE(length(sum - side->area_vector), tolerance);
      EXPECT_LE(length(moment - side->moment), tolerance);
      EXPECT_TRUE(std::is_sorted(side->facets.begin(), side->facets.end()));
      EXPECT_TRUE(std::is_sorted(side->gradients.begin(), side->gradients.end(),
                                 [](const auto& g, const auto& h) { return g.vertex < h.vertex; }));
    }
    if (patch.points.size() < 3) continue;
    Vec3 force, moment;
    double sum = 0;
    for (const LayerPoint& point : patch.points) {
      force += point.force, sum += point.volume;
      moment += cross(point.point - patch.centroid, point.force);
    }
    EXPECT_LE(length(force + patch.a.area_vector), tolerance);
    EXPECT_LE(length(moment + patch.a.moment), tolerance);
    EXPECT_NEAR(sum, patch.volume, tolerance);
  }
  EXPECT_NEAR(volume, query.volume(), tolerance);
}

TEST(LayerPatches, volume_is_the_sum_of_many_points) {
  Random random(1);
  for (int round = 0; round < 6; ++round) {
    const Mesh a = rough_plate(3, 0.05, random);
    Mesh b = round % 2 == 0 ? rough_plate(4, 0.05, random) : icosphere(1, 0.4, {0.1, 0, 0.45});
    if (round % 2 == 0) b = test::translated(b, {0.2, 0.1, 0.08});
    for (const double thickness : {0.1, 0.3}) {
      const double expected = plain_volume(a, b, thickness, 200);
      EXPECT_NEAR(volume_of(a, b, thickness), expected, 2e-5 * expected) << round << ' ' << thickness;
    }
  }
}

// Coordinates are whole numbers: facets without area or with a repeated vertex, edges of one to many facets, coplanar
// and equal facets, and edges in the planes of others.
TEST(LayerPatches, volume_of_soups_is_the_sum_of_many_points) {
  Random random(2);
  for (int round = 0; round < 20; ++round) {
    const Mesh a = test::random_soup(8, 8, 2, random).mesh, b = test::random_soup(8, 8, 2, random).mesh;
    const double expected = plain_volume(a, b, 0.9, 100);
    EXPECT_NEAR(volume_of(a, b, 0.9), expected, 1e-3 * (1 + std::abs(expected))) << round;
  }
}

TEST(LayerPatches, slivers_are_nearly_segments) {
  for (const double height : {0.0, 1e-300, 1e-12, 1e-9, 1e-7, 1e-4}) {
    Mesh b;
    b.positions = {{-1, 0, 0.1}, {1, 0, 0.1}, {0.3, height, 0.1}, {0, 1, 0.1}};
    b.facets = {{0, 1, 2}, {2, 1, 3}, {0, 2, 3}};
    const Mesh a = test::translated(grid_plate(3), {-0.4, -0.3, 0});
    const double expected = plain_volume(a, b, 0.4, 200);
    EXPECT_NEAR(volume_of(a, b, 0.4), expected, 5e-5 * expected) << height;
  }
}

TEST(LayerPatches, gradients_are_differences_of_volumes) {
  Random random(3);
  for (int round = 0; round < 4; ++round) {
    Mesh a = rough_plate(3, 0.05, random);
    const Mesh b = round % 2 == 0 ? test::translated(rough_plate(3, 0.05, random), {0.2, 0.1, 0.1})
                                  : icosphere(1, 0.4, {0.1, 0, 0.45});
    SurfaceTree tree_a(a), tree_b(b);
    LayerPatchQuery query({.thickness = 0.2}), moved({.thickness = 0.2});
    ASSERT_TRUE(query.run(tree_a, tree_b));
    expect_consistent(query, tree_a, tree_b, 1e-14);
    for (const bool of_b : {false, true}) {
      const Mesh& mesh = of_b ? b : a;
      SurfaceTree& tree = of_b ? tree_b : tree_a;
      std::vector<Vec3> gradients(mesh.positions.size());
      for (const LayerPatch& patch : query.patches())
        for (const VertexGradient& g : (of_b ? patch.b : patch.a).gradients) gradients[g.vertex] += g.gradient;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        for (int k = 0; k < 3; ++k) {
          double at[2];
          for (const int sign : {0, 1}) {
            std::vector<Vec3> positions = mesh.positions;
            positions[v][k] += sign == 0 ? -1e-5 : 1e-5;
            ASSERT_TRUE(tree.update(positions));
            ASSERT_TRUE(moved.run(tree_a, tree_b));
            at[sign] = moved.volume();
          }
          EXPECT_NEAR(gradients[v][k], (at[1] - at[0]) / 2e-5, 2e-8) << round << ' ' << v << ' ' << k;
        }
      ASSERT_TRUE(tree.update(mesh.positions));
    }
  }
}

double phi(double thickness, double distance) {
  const double depth = std::max(0.0, thickness - distance);
  return depth * depth / (2 * thickness);
}
/// The integral of f from 0 to `end`.
template <class F>
double integral(double end, const F& f) {
  double sum = 0;
  for (int k = 0; k < 20000; ++k) sum += f((k + 0.5) / 20000 * end);
  return sum * end / 20000;
}

Mesh sheet(int n, double width, double z) {
  return test::translated(grid_plate(n, width, width), {-width / 2, -width / 2, z});
}

// A square over the middle of a larger one: its own points are at the distance z, and those of the larger one around it
// at the distance from its border.
TEST(LayerPatches, parallel_sheets_have_the_volume_of_a_formula) {
  const double h = 0.1, z = 0.04, reach = std::sqrt(h * h - z * z);
  const double border = integral(reach, [&](double s) { return phi(h, std::sqrt(z * z + s * s)); });
  const double corners =
      2 * std::numbers::pi * integral(reach, [&](double s) { return s * phi(h, std::sqrt(z * z + s * s)); });
  const double expected = phi(h, z) + 0.5 * (4 * border + corners);
  double last = 1;
  for (const int n : {14, 28, 56}) {
    const double error = std::abs(volume_of(sheet(n / 2, 1, z), sheet(n, 1.4, 0), h) / expected - 1);
    EXPECT_LT(error, last / 3) << n << ": the error falls with the square of the edge length";
    last = error;
  }
  EXPECT_LT(last, 1e-3);
  SurfaceTree a(sheet(15, 1, z)), b(sheet(30, 1.4, 0));
  LayerPatchQuery query({.thickness = h});
  ASSERT_TRUE(query.run(a, b));
  ASSERT_EQ(query.patches().size(), 1u);
  const LayerPatch& patch = query.patches()[0];
  EXPECT_LE(length(patch.normal - Vec3{0, 0, 1}), 1e-12);
  EXPECT_NEAR(patch.depth, h - z, 1e-15);
  EXPECT_NEAR(patch.mean_depth, h - z, 0.05 * (h - z));
  EXPECT_NEAR(patch.a.area, 1, 1e-12);
  EXPECT_NEAR(patch.centroid.z, z / 2, 0.1 * z);
}

// The ball's points at height z above a plane, and the plane's at distance from the ball.
TEST(LayerPatches, ball_on_a_sheet_has_the_volume_of_a_formula) {
  const double h = 0.1, r = 1, gap = 0.02;
  const double of_ball = 2 * std::numbers::pi * r * integral(h - gap, [&](double z) { return phi(h, gap + z); });
  const double of_sheet = 2 * std::numbers::pi *
                          integral(std::sqrt((r + h) * (r + h) - (r + gap) * (r + gap)),
                                   [&](double s) { return s * phi(h, std::sqrt(s * s + (r + gap) * (r + gap)) - r); });
  double last = 1;
  for (const int level : {3, 4, 5}) {
    // The vertices of an icosphere are on the sphere, so its facets are inside by a quantity of the second order.
    const Mesh ball = icosphere(level, r, {0.013, 0.007, r + gap});
    const double error = std::abs(volume_of(ball, sheet(6 << (level - 2), 2, 0), h) / (0.5 * (of_ball + of_sheet)) - 1);
    EXPECT_LT(error, last / 2.5) << level;
    last = error;
  }
  EXPECT_LT(last, 0.01);
}

// Two strips of two long facets each, crossed: no vertex is near.
TEST(LayerPatches, edges_that_cross_far_from_vertices_push_apart) {
  Mesh a;
  a.positions = {{-10, 0, 0.05}, {10, 0, 0.05}, {10, 0, 5}, {-10, 0, 5}};
  a.facets = {{0, 1, 2}, {0, 2, 3}};
  Mesh b;
  b.positions = {{0, -10, 0}, {0, 10, 0}, {0, 10, -5}, {0, -10, -5}};
  b.facets = {{0, 1, 2}, {0, 2, 3}};
  SurfaceTree tree_a(a), tree_b(b);
  LayerPatchQuery query({.thickness = 0.1});
  ASSERT_TRUE(query.run(tree_a, tree_b));
  ASSERT_EQ(query.patches().size(), 1u);
  const LayerPatch& patch = query.patches()[0];
  EXPECT_NEAR(patch.depth, 0.05, 1e-14);
  EXPECT_LE(length(patch.normal - Vec3{0, 0, 1}), 1e-12);
  // Each edge counts with a third of one facet, over a length of 20.
  const double reach = std::sqrt(0.1 * 0.1 - 0.05 * 0.05);
  const double along = 2 * integral(reach, [&](double s) { return phi(0.1, std::sqrt(s * s + 0.05 * 0.05)); });
  EXPECT_NEAR(patch.volume, 0.5 * (49.5 + 50) / 3 / 20 * along, 1e-8 * along);
}

TEST(LayerPatches, coincident_sheets_have_a_volume_and_no_direction) {
  const Mesh mesh = sheet(5, 1, 0);
  SurfaceTree a(mesh), b(mesh);
  LayerPatchQuery query({.thickness = 0.01});
  ASSERT_TRUE(query.run(a, b));
  ASSERT_EQ(query.patches().size(), 1u);
  EXPECT_NEAR(query.patches()[0].volume, 0.005, 1e-15);
  EXPECT_EQ(query.patches()[0].normal, Vec3{});
  EXPECT_EQ(query.patches()[0].depth, 0.01);
  EXPECT_TRUE(query.patches()[0].points.empty());
  for (const VertexGradient& g : query.patches()[0].a.gradients) EXPECT_EQ(g.gradient, Vec3{});
}

// Rounding makes distances of coplanar sheets about 1e-16, with a direction of its own at each edge.
TEST(LayerPatches, coplanar_sheets_have_no_direction_in_any_place) {
  for (int round = 0; round < 6; ++round) {
    const auto place = RigidTransform::from_axis({1, 2, 3}, 0.7 * round, {1.0 * round, 200.0 * round, -0.3});
    const Mesh mesh = test::placed(sheet(5, 1, 0), place);
    SurfaceTree a(mesh), b(test::placed(test::translated(sheet(5, 1, 0), {0.07, 0.03, 0}), place));
    LayerPatchQuery query({.thickness = 0.01});
    ASSERT_TRUE(query.run(a, b));
    ASSERT_EQ(query.patches().size(), 1u);
    EXPECT_EQ(query.patches()[0].depth, 0.01);
    // Parts of edges beyond the border of the other sheet have a direction, in the plane.
    const Vec3 normal = place.rotate({0, 0, 1});
    for (const LayerSide* side : {&query.patches()[0].a, &query.patches()[0].b})
      for (const VertexGradient& g : side->gradients) EXPECT_LE(std::abs(dot(g.gradient, normal)), 1e-12) << round;
  }
}

TEST(LayerPatches, forces_that_cancel_each_other_leave_no_direction) {
  const RigidTransform place = RigidTransform::from_axis({1, 2, 3}, 1, {0.1, 0.2, 0.3});
  SurfaceTree inner(test::placed(icosphere(2, 1), place)), outer(test::placed(icosphere(2, 1.1), place));
  LayerPatchQuery query({.thickness = 0.2});
  ASSERT_TRUE(query.run(inner, outer));
  ASSERT_EQ(query.patches().size(), 1u);
  EXPECT_GT(query.patches()[0].volume, 0);
  EXPECT_EQ(query.patches()[0].normal, Vec3{});
  EXPECT_TRUE(query.patches()[0].points.empty());
}

// A ball that slides over a sheet and sinks, so that the force changes all the time.
TEST(LayerPatches, force_is_continuous_in_a_slow_slide) {
  const Mesh ball = icosphere(3, 0.5, {0, 0, 0});
  SurfaceTree a(ball), b(sheet(12, 0.8, 0));
  LayerPatchQuery query({.thickness = 0.03});
  constexpr int steps = 10000;
  std::vector<double> changes, turns, moves;
  Vec3 last, last_points[4];
  std::uint32_t id = 0;
  for (int k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) / steps;
    std::vector<Vec3> positions = ball.positions;
    for (Vec3& p : positions) p += Vec3{-0.05 + 0.1 * t, -0.03 + 0.07 * t, 0.515 - 0.005 * t};
    ASSERT_TRUE(a.update(positions));
    ASSERT_TRUE(query.run(a, b));
    ASSERT_EQ(query.patches().size(), 1u) << k;
    const LayerPatch& patch = query.patches()[0];
    ASSERT_EQ(patch.points.size(), 4u);
    if (k == 0) id = patch.id;
    ASSERT_EQ(patch.id, id);
    double move = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      move = std::max(move, length(patch.points[i].point - last_points[i]));
      last_points[i] = patch.points[i].point;
    }
    if (k > 0) changes.push_back(length(patch.b.area_vector - last)), moves.push_back(move);
    last = patch.b.area_vector;
  }
  for (auto* values : {&changes, &moves}) {
    std::sort(values->begin(), values->end());
    EXPECT_LE(values->back(), 3 * (*values)[steps / 2]) << (values == &changes ? "force" : "points");
  }
}

TEST(LayerPatches, rigid_motions_and_scales_change_nothing_else) {
  Random random(5);
  const Mesh a = rough_plate(4, 0.05, random), b = icosphere(2, 0.4, {0.1, 0, 0.45});
  LayerPatchQuery query({.thickness = 0.1});
  SurfaceTree tree_a(a), tree_b(b);
  ASSERT_TRUE(query.run(tree_a, tree_b));
  ASSERT_FALSE(query.patches().empty());
  const LayerPatch first = query.patches()[0];
  const double volume = query.volume();
  const auto place = RigidTransform::from_axis({1, 2, 3}, 1.1, {3, -2, 1});
  for (const double scale : {1.0, 0x1p-60, 0x1p60}) {
    const auto moved = [&](const Mesh& mesh) { return test::scaled(test::placed(mesh, place), scale); };
    SurfaceTree scaled_a(moved(a)), scaled_b(moved(b));
    LayerPatchQuery again({.thickness = 0.1 * scale});
    ASSERT_TRUE(again.run(scaled_a, scaled_b));
    ASSERT_FALSE(again.patches().empty());
    EXPECT_NEAR(again.volume() / (scale * scale * scale), volume, 1e-12 * volume);
    EXPECT_LE(length(again.patches()[0].normal - place.rotate(first.normal)), 1e-12);
    EXPECT_LE(length(again.patches()[0].centroid / scale - place(first.centroid)), 1e-12);
    EXPECT_NEAR(again.patches()[0].depth / scale, first.depth, 1e-12);
    expect_consistent(again, scaled_a, scaled_b, 1e-12 * scale * scale * std::max(1.0, scale));
  }
  // Far from the origin positions are rounded, and nothing else.
  const Vec3 far{0x1p30, -0x1p30, 0x1p29};
  SurfaceTree far_a(test::translated(a, far)), far_b(test::translated(b, far));
  ASSERT_TRUE(query.run(far_a, far_b));
  EXPECT_NEAR(query.volume(), volume, 1e-5 * volume);
  EXPECT_LE(length(query.patches()[0].a.moment + query.patches()[0].b.moment), 1e-15);
}

std::vector<double> numbers(const LayerPatchQuery& query) {
  std::vector<double> all{query.volume()};
  const auto put = [&](const Vec3& v) { all.insert(all.end(), {v.x, v.y, v.z}); };
  for (const LayerPatch& patch : query.patches()) {
    all.insert(all.end(), {double(patch.id), patch.volume, patch.depth, patch.mean_depth});
    put(patch.centroid), put(patch.normal);
    for (const LayerSide* side : {&patch.a, &patch.b}) {
      put(side->area_vector), put(side->moment), all.push_back(side->area);
      for (const std::uint32_t f : side->facets) all.push_back(f);
      for (const VertexGradient& g : side->gradients) all.push_back(g.vertex), put(g.gradient);
    }
    for (const LayerPoint& point : patch.points) {
      all.insert(all.end(), {double(point.id), point.volume, point.depth});
      put(point.point), put(point.force), put(point.on_a.point), put(point.on_b.point);
    }
  }
  return all;
}

TEST(LayerPatches, workers_and_budgets_change_no_bit) {
  Random random(6);
  const Mesh a = rough_plate(20, 0.01, random), b = icosphere(3, 0.4, {0.1, 0, 0.41});
  SurfaceTree tree_a(a), tree_b(b);
  LayerPatchQuery query({.thickness = 0.1}), threaded({.thickness = 0.1});
  LayerPatchQuery short_of({.thickness = 0.1, .budget = 20000});
  ASSERT_TRUE(query.run(tree_a, tree_b));
  Workers workers(3);
  ASSERT_TRUE(threaded.run(tree_a, tree_b, workers));
  EXPECT_EQ(numbers(query), numbers(threaded));
  SurfaceQueryStatus status = short_of.run(tree_a, tree_b);
  int calls = 1;
  for (; status && !status.finished; ++calls) {
    EXPECT_FALSE(short_of.open().empty());
    status = short_of.resume();
  }
  ASSERT_TRUE(status);
  EXPECT_GT(calls, 2);
  EXPECT_TRUE(short_of.open().empty());
  EXPECT_EQ(numbers(query), numbers(short_of));
}

TEST(LayerPatches, repeats_allocate_nothing) {
  Random random(7);
  const Mesh a = rough_plate(20, 0.01, random), b = icosphere(3, 0.4, {0.1, 0, 0.41});
  SurfaceTree tree_a(a), tree_b(b);
  LayerPatchQuery query({.thickness = 0.1});
  EXPECT_EQ(test::allocations_once_warm([&] { ASSERT_TRUE(query.run(tree_a, tree_b)); }), 0u);
  LayerPatchQuery of_one({.thickness = 0.1, .filter = {.rest_distance = 0.1}});
  EXPECT_EQ(test::allocations_once_warm([&] { ASSERT_TRUE(of_one.run(tree_a)); }), 0u);
}

/// A sheet folded over itself, from a flat one at rest: two layers at a distance `gap`.
struct Fold {
  Mesh rest = grid_plate(12, 2.0, 0.5);
  std::vector<Vec3> positions = rest.positions;
  explicit Fold(double gap) {
    for (Vec3& p : positions) {
      const double s = p.x - 1, radius = gap / 2, angle = std::numbers::pi * radius / 2;
      if (s > angle)
        p = {1 - (s - angle), p.y, gap};
      else if (s > -angle)
        p = {1 + radius * std::sin((s + angle) / radius), p.y, radius - radius * std::cos((s + angle) / radius)};
      else
        p.x = 1 + s + angle;
    }
  }
};

TEST(LayerPatches, of_one_surface_are_those_of_all_pairs) {
  const Fold fold(0.05);
  const double h = 0.08, apart = 0.3;
  SurfaceTree tree(fold.rest);
  ASSERT_TRUE(tree.update(fold.positions));
  const std::size_t count = fold.rest.facets.size();
  std::vector<bool> act(count * count);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j)
      act[i * count + j] = test::plain_facet_distance(fold.rest.positions, fold.rest.facets[i], fold.rest.positions,
                                                      fold.rest.facets[j]) > apart;
  const LayerRule acts = [&](std::uint32_t i, std::uint32_t j) { return act[i * count + j]; };
  LayerPatchQuery query({.thickness = h, .filter = {.rest_distance = apart}});
  ASSERT_TRUE(query.run(tree));
  const double expected = 0.5 * test::plain_layer(fold.rest, fold.positions, fold.rest, fold.positions, h, 20, acts);
  EXPECT_NEAR(query.volume(), expected, 1e-3 * expected);
  ASSERT_EQ(query.patches().size(), 1u);
  expect_consistent(query, tree, tree, 1e-14);
  const LayerPatch& patch = query.patches()[0];
  EXPECT_NEAR(std::abs(patch.normal.z), 1, 1e-2) << "both layers, one on each side";
  EXPECT_NEAR(patch.depth, h - 0.05, 1e-12);
  // The sides stay, whatever pair comes first.
  const Vec3 normal = patch.normal;
  const std::uint32_t id = patch.id;
  for (int k = 0; k < 20; ++k) {
    std::vector<Vec3> positions = fold.positions;
    for (Vec3& p : positions) p.z *= 1 - 0.3 * std::sin(0.3 * k + 9 * p.x);
    ASSERT_TRUE(tree.update(positions));
    ASSERT_TRUE(query.run(tree));
    for (const LayerPatch& now : query.patches()) EXPECT_TRUE(now.id != id || dot(now.normal, normal) > 0.5) << k;
  }
}

// A plain surface has no crossing, which a search for crossings uses, but may be near to itself.
TEST(LayerPatches, of_height_fields_are_found) {
  Mesh mesh = grid_plate(48, 1, 1);
  for (Vec3& p : mesh.positions) p.z = 2 * std::abs(std::fmod(8 * p.x + 0.5, 1.0) - 0.5);
  SurfaceTree tree(mesh);
  LayerPatchQuery query({.thickness = 0.05, .filter = {.rings = 1}});
  ASSERT_TRUE(query.run(tree));
  EXPECT_GT(query.patches().size(), 0u);
}

TEST(LayerPatches, are_the_connected_groups_of_near_pairs) {
  Random random(8);
  for (int round = 0; round < 30; ++round) {
    const Mesh a = test::random_soup(20, 14, 5, random).mesh, b = test::random_soup(20, 14, 5, random).mesh;
    LayerPatchQuery query({.thickness = 0.7});
    ASSERT_TRUE(query.run(SurfaceTree(a), SurfaceTree(b)));
    const auto groups = test::plain_layer_groups(a, a.positions, b, b.positions, 0.7);
    ASSERT_EQ(query.patches().size(), groups.size()) << round;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      std::set<std::uint32_t> of_a, of_b;
      for (const auto& [f, g] : groups[i]) of_a.insert(f), of_b.insert(g);
      const LayerPatch& patch = query.patches()[i];
      EXPECT_TRUE(std::equal(of_a.begin(), of_a.end(), patch.a.facets.begin(), patch.a.facets.end()));
      EXPECT_TRUE(std::equal(of_b.begin(), of_b.end(), patch.b.facets.begin(), patch.b.facets.end()));
    }
  }
}

TEST(LayerPatches, points_stand_for_the_patch) {
  Random random(9);
  const Mesh a = rough_plate(12, 0.01, random), b = icosphere(3, 0.4, {0.1, 0, 0.42});
  SurfaceTree tree_a(a), tree_b(b);
  for (const std::uint32_t count : {0u, 1u, 2u, 3u, 4u, 8u, 16u}) {
    LayerPatchQuery query({.thickness = 0.1, .max_points = count});
    ASSERT_TRUE(query.run(tree_a, tree_b));
    ASSERT_EQ(query.patches().size(), 1u);
    const LayerPatch& patch = query.patches()[0];
    EXPECT_EQ(patch.points.size(), count);
    expect_consistent(query, tree_a, tree_b, 1e-13);
    Vec3 force;
    for (const LayerPoint& point : patch.points) {
      force += point.force;
      EXPECT_GT(dot(point.force, patch.normal), 0);
      EXPECT_LE(point.depth, patch.depth);
      for (const auto& [surface, on] : {std::pair{&tree_a, &point.on_a}, std::pair{&tree_b, &point.on_b}}) {
        const Facet& f = surface->facets()[on->facet];
        const Vec3 at =
            at_barycentric({surface->from(f[0]), surface->from(f[1]), surface->from(f[2])}, on->barycentric);
        EXPECT_LE(length(at - on->point), 1e-14);
        EXPECT_LE(length(on->point - point.point), 0.1);
      }
    }
    if (count == 0) force = -patch.a.area_vector;
    EXPECT_LE(length(force + patch.a.area_vector), 1e-14);
  }
}

TEST(LayerPatches, ids_follow_vertices_over_any_way) {
  const Mesh balls = test::joined(icosphere(2, 0.2, {-0.5, 0, 0.25}), icosphere(2, 0.2, {0.5, 0, 0.25}));
  SurfaceTree a(balls), b(sheet(40, 20, 0));
  LayerPatchQuery query({.thickness = 0.1});
  ASSERT_TRUE(query.run(a, b));
  ASSERT_EQ(query.patches().size(), 2u);
  const auto id_at = [&](double x) {
    for (const LayerPatch& patch : query.patches())
      if (std::abs(patch.centroid.x - x) < 0.2) return patch.id;
    return 999u;
  };
  const std::uint32_t left = id_at(-0.5), right = id_at(0.5);
  EXPECT_NE(left, right);
  ASSERT_TRUE(a.update(test::translated(balls, {7, 3, 0}).positions));
  ASSERT_TRUE(query.run(a, b));
  EXPECT_EQ(id_at(6.5), left);
  EXPECT_EQ(id_at(7.5), right);
  ASSERT_TRUE(a.update(test::translated(balls, {7, 3, 1}).positions));
  ASSERT_TRUE(query.run(a, b));
  EXPECT_TRUE(query.patches().empty());
  ASSERT_TRUE(a.update(balls.positions));
  ASSERT_TRUE(query.run(a, b));
  EXPECT_NE(id_at(-0.5), left) << "a patch that has gone does not come back";
}

// Facets around one vertex: sums over them take no square of their number.
TEST(LayerPatches, fans_count_once) {
  Mesh cone;
  cone.positions = {{0, 0, 0.02}};
  for (int k = 0; k < 60; ++k) {
    const SinCos angle = sin_cos(2 * std::numbers::pi * k / 60);
    cone.positions.push_back({angle.cos, angle.sin, 0.5});
  }
  for (std::uint32_t k = 0; k < 60; ++k) cone.facets.push_back({0, 1 + k, 1 + (k + 1) % 60});
  const Mesh below = sheet(7, 1, 0);
  const double h = 0.1;
  // The points of the sheet are nearest to the tip, or above a facet: the distance from the cone's surface, or the tip.
  const double expected = 0.5 * (test::plain_layer(below, below.positions, cone, cone.positions, h, 400) +
                                 test::plain_layer(cone, cone.positions, below, below.positions, h, 400));
  EXPECT_NEAR(volume_of(below, cone, h), expected, 1e-4 * expected);
}

TEST(LayerPatches, options_out_of_range_are_named) {
  for (const double thickness : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_NE(test::error_text([&] { LayerPatchQuery query({.thickness = thickness}); }).find("thickness"),
              std::string::npos);
  EXPECT_NE(test::error_text([] { LayerPatchQuery query({.thickness = 1, .max_points = 17}); }).find("max_points"),
            std::string::npos);
  EXPECT_THROW(LayerPatchQuery({.thickness = 1, .filter = {.rest_distance = -1}}), std::invalid_argument);
  LayerPatchQuery query({.thickness = 1});
  EXPECT_EQ(query.resume().code, Status::Code::no_front);
  LayerPatchQuery masked({.thickness = 1, .filter = {.masks_a = {.mask = {1}}}});
  EXPECT_EQ(masked.run(SurfaceTree(sheet(2, 1, 0))).code, Status::Code::bad_option);
}

}  // namespace
}  // namespace morula
