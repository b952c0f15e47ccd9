// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "medial/voronoi_balls.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <morula/geometry/random.hpp>
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
    if (squared_distance(box, center) <= box.diagonal() * box.diagonal()) {
      ASSERT_EQ(ball.distance, shape(center));
    } else {
      ASSERT_EQ(ball.distance, std::numeric_limits<double>::infinity());
    }
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
    EXPECT_EQ(a.distance, b.distance);
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
