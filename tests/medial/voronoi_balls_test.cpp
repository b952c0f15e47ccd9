// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "medial/voronoi_balls.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <set>

#include "../support/meshes.hpp"

namespace morula::test {
using namespace detail;
namespace {

std::vector<Vec3> surface_points(const Mesh& mesh, std::size_t count) {
  std::vector<Vec3> points;
  for (const SurfacePoint& sample : sample_surface(mesh, count)) points.push_back(sample.point);
  return points;
}

/// All that VoronoiBalls says of a ball, by brute force; `tolerance` of the box's diagonal.
void expect_sound(const VoronoiBalls& voronoi, const Box& box, const SignedDistance& shape) {
  const double tolerance = 0x1p-18 * box.diagonal();
  for (std::uint32_t slot = 0; slot < voronoi.balls().size(); ++slot) {
    const VoronoiBall& ball = voronoi.balls()[slot];
    if (!ball.alive) continue;
    const auto& [center, radius] = ball.ball;
    ASSERT_TRUE(is_finite(center) && radius > 0);
    // Far away the radius itself is only good to so many digits.
    const double slack = tolerance + 1e-12 * radius;
    for (const std::uint32_t sample : ball.samples) {
      ASSERT_NEAR(distance(voronoi.samples()[sample], center), radius, slack);
    }
    for (const Vec3& sample : voronoi.samples()) ASSERT_GE(distance(sample, center), radius - slack);
    for (std::size_t k = 0; k < 4; ++k) {
      if (ball.neighbors[k] == no_ball) continue;
      const VoronoiBall& neighbor = voronoi.balls()[ball.neighbors[k]];
      ASSERT_TRUE(neighbor.alive);
      const auto back = std::find(neighbor.neighbors.begin(), neighbor.neighbors.end(), slot);
      ASSERT_NE(back, neighbor.neighbors.end());
      auto mine = ball.samples, its = neighbor.samples;
      mine[k] = its[static_cast<std::size_t>(back - neighbor.neighbors.begin())] = no_sample;
      std::sort(mine.begin(), mine.end());
      std::sort(its.begin(), its.end());
      ASSERT_EQ(mine, its);
    }
    const bool is_near = squared_distance(box, center) <= box.diagonal() * box.diagonal();
    const double away = is_near ? shape(center) : std::numeric_limits<double>::infinity();
    ASSERT_EQ(voronoi.is_far(slot), !is_near);
    // Before its distance is asked for: what is known of others has to do, mostly.
    ASSERT_EQ(voronoi.side(slot), (away > 0) - (away < 0));
    const auto closest = voronoi.closest_within(slot, 0.9 * radius);
    ASSERT_EQ(closest.has_value(), is_near && std::abs(away) <= 0.9 * radius);
    if (closest) {
      ASSERT_EQ(closest->distance, away);
      ASSERT_EQ(closest->point, shape.at(center).closest.point);
    }
    ASSERT_EQ(voronoi.distance(slot), away);
  }
}

TEST(VoronoiBalls, hold_no_sample_and_know_their_neighbors_on_every_mesh) {
  for (const NamedMesh& named : all_meshes()) {
    SCOPED_TRACE(named.name);
    const SignedDistance shape(named.mesh);
    const Box box = bounding_box(named.mesh);
    VoronoiBalls voronoi(box, shape);
    voronoi.insert(surface_points(named.mesh, 150));
    // The vertices too: they are the grid-like ones.
    for (std::size_t facet = 0; facet < std::min<std::size_t>(named.mesh.facet_count(), 60); ++facet) {
      voronoi.insert(named.mesh.corners(facet)[0]);
    }
    expect_sound(voronoi, box, shape);
  }
}

TEST(VoronoiBalls, sides_are_those_of_distances_in_whatever_order_they_are_asked) {
  const Mesh mesh = sample_body("torus", 24);
  const SignedDistance shape(mesh);
  const Box box = bounding_box(mesh);
  VoronoiBalls first(box, shape), second(box, shape);
  const std::vector<Vec3> points = surface_points(mesh, 400);
  first.insert(points);
  second.insert(points);
  const auto count = static_cast<std::uint32_t>(first.balls().size());
  std::size_t inside = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t slot = i * 7919u % count;
    if (!first.balls()[i].alive) continue;
    const int side = first.side(i);
    inside += side < 0;
    if (second.balls()[slot].alive) second.side(slot);
    EXPECT_EQ(second.side(i), side);
    const double away = second.distance(i);
    EXPECT_EQ(side, (away > 0) - (away < 0));
  }
  EXPECT_GT(inside, 100u);
}

TEST(VoronoiBalls, sides_are_those_of_distances_where_surfaces_pass_through_each_other) {
  Mesh mesh = sample_body("torus", 24);
  const auto count = static_cast<std::uint32_t>(mesh.vertex_count());
  const std::vector<Vec3> positions = mesh.positions;
  const std::vector<Facet> facets = mesh.facets;
  for (const Vec3& p : positions) mesh.positions.push_back(p + Vec3{0.31, 0.17, 0.23});
  for (const Facet& f : facets) mesh.facets.push_back({f[0] + count, f[1] + count, f[2] + count});
  const SignedDistance shape(mesh);
  ASSERT_TRUE(shape.has_volume());
  ASSERT_EQ(shape.method(), SignMethod::winding_number);
  const Box box = bounding_box(mesh);
  VoronoiBalls voronoi(box, shape);
  voronoi.insert(surface_points(mesh, 600));
  expect_sound(voronoi, box, shape);
}

TEST(VoronoiBalls, one_by_one_and_at_once_are_the_same_balls) {
  const Mesh mesh = sample_body("torus", 24);
  const SignedDistance shape(mesh);
  const std::vector<Vec3> points = surface_points(mesh, 300);
  VoronoiBalls one_by_one(bounding_box(mesh), shape), at_once(bounding_box(mesh), shape);
  for (const Vec3& point : points) EXPECT_TRUE(one_by_one.insert(point));
  EXPECT_EQ(at_once.insert(points), points.size());
  ASSERT_EQ(one_by_one.balls().size(), at_once.balls().size());
  for (std::size_t slot = 0; slot < at_once.balls().size(); ++slot) {
    const VoronoiBall &a = one_by_one.balls()[slot], &b = at_once.balls()[slot];
    ASSERT_EQ(a.alive, b.alive);
    if (!a.alive) continue;
    EXPECT_EQ(a.ball, b.ball);
    EXPECT_EQ(one_by_one.distance(static_cast<std::uint32_t>(slot)),
              at_once.distance(static_cast<std::uint32_t>(slot)));
    EXPECT_EQ(a.samples, b.samples);
    EXPECT_EQ(a.neighbors, b.neighbors);
  }
}

TEST(VoronoiBalls, say_after_every_insert_what_changed) {
  const Mesh mesh = box_mesh({0, 0, 0}, {3, 2, 1}, 6);
  const SignedDistance shape(mesh);
  const Box box = bounding_box(mesh);
  VoronoiBalls voronoi(box, shape);
  std::set<std::uint32_t> alive;
  std::size_t inserted = 0;
  for (const Vec3& vertex : mesh.positions) {
    ASSERT_TRUE(voronoi.insert(vertex));
    ASSERT_EQ(voronoi.samples().size(), ++inserted);
    for (const std::uint32_t slot : voronoi.removed()) ASSERT_EQ(alive.erase(slot), 1u);
    for (const std::uint32_t slot : voronoi.created()) ASSERT_TRUE(alive.insert(slot).second);
    for (std::uint32_t slot = 0; slot < voronoi.balls().size(); ++slot) {
      ASSERT_EQ(voronoi.balls()[slot].alive, alive.count(slot) == 1);
    }
    if (inserted % 20 == 0) expect_sound(voronoi, box, shape);
  }
  EXPECT_EQ(voronoi.samples(), mesh.positions);
  EXPECT_FALSE(voronoi.insert(mesh.positions[7]));
  EXPECT_FALSE(voronoi.insert({std::numeric_limits<double>::quiet_NaN(), 0, 0}));
  EXPECT_EQ(voronoi.samples(), mesh.positions);
  expect_sound(voronoi, box, shape);
}

TEST(VoronoiBalls, of_samples_in_one_plane_there_are_none) {
  const Mesh mesh = grid_plate(5);
  const SignedDistance shape(mesh);
  VoronoiBalls voronoi(bounding_box(mesh), shape);
  EXPECT_EQ(voronoi.insert(mesh.positions), mesh.vertex_count());
  EXPECT_TRUE(voronoi.balls().empty());
  VoronoiBalls of_a_point({{1, 1, 1}, {1, 1, 1}}, shape);
  EXPECT_TRUE(of_a_point.insert({1, 1, 1}));
  EXPECT_FALSE(of_a_point.insert({1, 1, 1}));
}

}  // namespace
}  // namespace morula::test
