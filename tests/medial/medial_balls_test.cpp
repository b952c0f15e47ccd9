// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/medial/medial_balls.hpp>
#include <scenes/brute_force.hpp>
#include <set>
#include <string>

#include "../support/meshes.hpp"
#include "medial/shrunken_balls.hpp"

namespace morula::test {
namespace {

struct Samples {
  std::vector<Vec3> points, normals;
};

Samples samples_of(const Mesh& mesh, std::size_t count) {
  Samples samples;
  for (const SurfacePoint& sample : sample_surface(mesh, count)) {
    samples.points.push_back(sample.point);
    samples.normals.push_back(normalized(area_vector(mesh.corners(sample.facet))));
  }
  return samples;
}

MedialBalls balls_of(const Mesh& mesh, std::size_t count, Workers& workers = serial_workers()) {
  const Samples samples = samples_of(mesh, count);
  return shrinking_balls(SignedDistance(mesh), samples.points, samples.normals, workers);
}

void expect_inscribed(std::span<const Sphere> balls, const Mesh& mesh) {
  const SignedDistance shape(mesh, SignMethod::winding_number);
  for (const Sphere& ball : balls) {
    ASSERT_GT(ball.radius, 0);
    ASSERT_TRUE(shape.is_inside(ball.center));
    const double clear = std::sqrt(brute_force::closest_point(mesh, ball.center).squared_distance);
    ASSERT_GE(clear, ball.radius * (1 - 1e-12));
  }
}

void expect_sound_neighbors(const MedialBalls& medial) {
  ASSERT_EQ(medial.neighbor_begin.size(), medial.balls.size() + 1);
  ASSERT_EQ(medial.neighbor_begin.front(), 0u);
  ASSERT_EQ(medial.neighbor_begin.back(), medial.neighbors.size());
  const auto of = [&](std::uint32_t i) {
    const std::uint32_t begin = medial.neighbor_begin[i];
    return std::span(medial.neighbors).subspan(begin, medial.neighbor_begin[i + 1] - begin);
  };
  for (std::uint32_t i = 0; i < medial.balls.size(); ++i) {
    ASSERT_TRUE(std::is_sorted(of(i).begin(), of(i).end()));
    for (const std::uint32_t j : of(i)) {
      ASSERT_NE(i, j);
      ASSERT_TRUE(std::binary_search(of(j).begin(), of(j).end(), i));
    }
  }
}

bool same(const MedialBalls& a, const MedialBalls& b) {
  return a.balls == b.balls && a.neighbor_begin == b.neighbor_begin && a.neighbors == b.neighbors;
}

/// Number of balls that cannot be reached from each other.
std::size_t part_count(const MedialBalls& medial) {
  std::vector<bool> seen(medial.balls.size());
  std::size_t parts = 0;
  for (std::uint32_t start = 0; start < medial.balls.size(); ++start) {
    if (seen[start]) continue;
    ++parts;
    std::vector<std::uint32_t> open{start};
    while (!open.empty()) {
      const std::uint32_t ball = open.back();
      open.pop_back();
      if (seen[ball]) continue;
      seen[ball] = true;
      for (std::uint32_t i = medial.neighbor_begin[ball]; i < medial.neighbor_begin[ball + 1]; ++i) {
        open.push_back(medial.neighbors[i]);
      }
    }
  }
  return parts;
}

TEST(ShrinkingBalls, are_inscribed_in_every_closed_mesh) {
  for (const NamedMesh& named : closed_meshes()) {
    SCOPED_TRACE(named.name);
    const MedialBalls medial = balls_of(named.mesh, 200);
    expect_inscribed(medial.balls, named.mesh);
    expect_sound_neighbors(medial);
  }
}

TEST(ShrinkingBalls, of_a_sphere_are_the_sphere_wherever_they_start) {
  const Vec3 center{5, -3, 2};
  const Mesh mesh = icosphere(4, 2.0, center);
  MedialBalls medial = balls_of(mesh, 1000);
  EXPECT_EQ(medial.balls.size(), 1000u);
  // At vertices, where no ball touches the facets from inside, as well.
  Samples vertices;
  for (const Vec3& position : mesh.positions) {
    vertices.points.push_back(position);
    vertices.normals.push_back((position - center) / 2.0);
  }
  const MedialBalls at_vertices = shrinking_balls(SignedDistance(mesh), vertices.points, vertices.normals);
  EXPECT_EQ(at_vertices.balls.size(), mesh.vertex_count());
  medial.balls.insert(medial.balls.end(), at_vertices.balls.begin(), at_vertices.balls.end());
  for (const Sphere& ball : medial.balls) {
    EXPECT_NEAR(ball.radius, 2.0, 0.06);
    EXPECT_LE(distance(ball.center, center), 0.06);
  }
}

TEST(ShrinkingBalls, of_a_box_touch_two_sides_one_of_them_at_the_point) {
  const Vec3 lower{0, 0, 0}, upper{4, 3, 1};
  const Mesh mesh = box_mesh(lower, upper, 3);
  const Samples samples = samples_of(mesh, 500);
  const SignedDistance shape(mesh);
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    const Vec3 &p = samples.points[i], &n = samples.normals[i];
    // By hand: the ball is tangent to p's side and to the opposite one, or before that to one beside it.
    double radius = 2;
    for (int axis = 0; axis < 3; ++axis) {
      const bool across = std::abs(n[axis]) > 0.5;
      const double room = across ? (upper - lower)[axis] / 2 : std::min(p[axis] - lower[axis], upper[axis] - p[axis]);
      radius = std::min(radius, room);
    }
    const MedialBalls medial = shrinking_balls(shape, std::span(&p, 1), std::span(&n, 1));
    if (medial.balls.empty()) {
      EXPECT_LT(radius, 1e-5);
      continue;
    }
    const Sphere& ball = medial.balls[0];
    EXPECT_GE(ball.radius, radius * (1 - 1e-6));
    EXPECT_LE(ball.radius, radius * 1.12);
    EXPECT_LE(distance(ball.center, p - radius * n), 0.2 * radius);
    std::vector<double> rooms;
    for (int axis = 0; axis < 3; ++axis) {
      rooms.push_back(ball.center[axis] - lower[axis]);
      rooms.push_back(upper[axis] - ball.center[axis]);
    }
    std::sort(rooms.begin(), rooms.end());
    EXPECT_NEAR(rooms[0], ball.radius, 1e-12);
    EXPECT_NEAR(rooms[1], ball.radius, 0.03 * ball.radius);
  }
}

TEST(ShrinkingBalls, of_a_torus_have_its_tube_s_radius) {
  const Mesh mesh = sample_body("torus", 96);
  const MedialBalls medial = balls_of(mesh, 1000);
  EXPECT_EQ(medial.balls.size(), 1000u);
  for (const Sphere& ball : medial.balls) EXPECT_NEAR(ball.radius, 0.35, 0.35 * 0.04);
  expect_sound_neighbors(medial);
  EXPECT_EQ(part_count(medial), 1u);
}

TEST(ShrinkingBalls, of_a_capsule_have_its_radius) {
  const Mesh mesh = sample_body("capsule", 96);
  const double radius = bounding_box(mesh).extent().y / 2;
  const MedialBalls medial = balls_of(mesh, 1000);
  EXPECT_EQ(medial.balls.size(), 1000u);
  for (const Sphere& ball : medial.balls) EXPECT_NEAR(ball.radius, radius, 0.03 * radius);
}

TEST(ShrinkingBalls, of_a_thin_plate_are_as_thick_as_it) {
  for (const double thickness : {0.1, 1e-3, 1e-5, 1e-7}) {
    const Mesh mesh = box_mesh({0, 0, 0}, {4, thickness, 3}, 4);
    const MedialBalls medial = balls_of(mesh, 500);
    EXPECT_GT(medial.balls.size(), 400u);
    std::size_t full = 0;
    for (const Sphere& ball : medial.balls) full += std::abs(ball.radius - thickness / 2) <= 1e-5 * thickness;
    EXPECT_GT(full, 380u) << thickness;
    expect_inscribed(medial.balls, mesh);
  }
}

TEST(ShrinkingBalls, stay_in_their_component) {
  const Mesh mesh = joined(icosphere(3, 1.0, {0, 0, 0}), icosphere(3, 1.0, {2.01, 0, 0}));
  const MedialBalls medial = balls_of(mesh, 400);
  EXPECT_EQ(medial.balls.size(), 400u);
  for (const Sphere& ball : medial.balls) EXPECT_NEAR(ball.radius, 1, 0.05);
  expect_inscribed(medial.balls, mesh);
  EXPECT_EQ(part_count(medial), 2u);
}

TEST(ShrinkingBalls, work_on_a_scan_with_holes) {
  Mesh mesh = sample_body("limb", 48);
  const std::size_t before = mesh.facet_count();
  std::size_t facet = 0;
  std::erase_if(mesh.facets, [&](const Facet&) { return facet++ % 100 < 3; });
  ASSERT_LT(mesh.facet_count(), before);
  const MedialBalls medial = balls_of(mesh, 500);
  EXPECT_GT(medial.balls.size(), 450u);
  expect_inscribed(medial.balls, mesh);
  expect_sound_neighbors(medial);
}

TEST(ShrinkingBalls, bad_points_give_none) {
  const Mesh mesh = icosphere(2);
  const SignedDistance shape(mesh);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3> points{{1, 0, 0}, {nan, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  const std::vector<Vec3> normals{{0, 0, 0}, {1, 0, 0}, {nan, 0, 0}, {0, 0, -1}};
  const MedialBalls medial = shrinking_balls(shape, points, normals);
  EXPECT_TRUE(medial.balls.empty());
  EXPECT_EQ(medial.neighbor_begin, std::vector<std::uint32_t>{0});
  EXPECT_TRUE(shrinking_balls(shape, {}, {}).balls.empty());
  EXPECT_TRUE(balls_of(grid_plate(4), 50).balls.empty());  // nothing is inside
}

TEST(ShrinkingBalls, same_bits_for_any_number_of_workers) {
  const Mesh mesh = sample_body("limb", 32);
  const MedialBalls serial = balls_of(mesh, 1500);
  for (const unsigned threads : {1u, 2u, 3u, 8u}) {
    Workers workers(threads);
    EXPECT_TRUE(same(balls_of(mesh, 1500, workers), serial)) << threads;
  }
}

std::vector<Sphere> shared_balls_of(const Mesh& mesh, std::size_t count, Workers& workers = serial_workers()) {
  const Samples samples = samples_of(mesh, count);
  return detail::shrunken_balls(SignedDistance(mesh), samples.points, samples.normals,
                                detail::BallSharing::on_round_parts, workers);
}

std::size_t different(std::vector<Sphere> balls) {
  std::set<std::array<double, 4>> all;
  for (const Sphere& b : balls) all.insert({b.center.x, b.center.y, b.center.z, b.radius});
  return all.size();
}

TEST(SharedBalls, of_a_sphere_are_few_and_it) {
  const Vec3 center{5, -3, 2};
  const std::vector<Sphere> balls = shared_balls_of(icosphere(4, 2.0, center), 1000);
  EXPECT_EQ(balls.size(), 1000u);
  EXPECT_LT(different(balls), 400u);
  for (const Sphere& ball : balls) {
    EXPECT_NEAR(ball.radius, 2.0, 0.06);
    EXPECT_LE(distance(ball.center, center), 0.06);
  }
}

TEST(SharedBalls, are_inscribed_and_touch_their_points_in_every_closed_mesh) {
  std::size_t shared = 0;
  for (const NamedMesh& named : closed_meshes()) {
    SCOPED_TRACE(named.name);
    const Samples samples = samples_of(named.mesh, 300);
    const SignedDistance shape(named.mesh);
    expect_inscribed(shared_balls_of(named.mesh, 300), named.mesh);
    // A point alone has none to share with; 32 share among themselves.
    for (std::size_t i = 0; i < 32; ++i) {
      const auto of = [&](std::size_t from, std::size_t count) {
        return detail::shrunken_balls(shape, std::span(samples.points).subspan(from, count),
                                      std::span(samples.normals).subspan(from, count),
                                      detail::BallSharing::on_round_parts);
      };
      const std::vector<Sphere> before = of(0, i), with = of(0, i + 1), alone = of(i, 1);
      if (with.size() == before.size() || (!alone.empty() && with.back() == alone[0])) continue;
      ++shared;
      int touched = 0;
      for (const Sphere& ball : before)
        touched += std::abs(distance(ball.center, samples.points[i]) - ball.radius) <= 0.004 * ball.radius;
      EXPECT_GE(touched, 2);
      EXPECT_NE(std::find(before.begin(), before.end(), with.back()), before.end());
    }
  }
  EXPECT_GT(shared, 20u);
}

TEST(SharedBalls, of_a_box_are_those_of_each_point) {
  // Wide balls between two walls: points near the one that a ball was found at touch it, nearly, but no other.
  const Mesh mesh = box_mesh({0, 0, 0}, {4, 3, 1}, 3);
  const Samples samples = samples_of(mesh, 500);
  const SignedDistance shape(mesh);
  const std::vector<Sphere> each =
      detail::shrunken_balls(shape, samples.points, samples.normals, detail::BallSharing::none);
  EXPECT_EQ(shared_balls_of(mesh, 500), each);
  EXPECT_EQ(balls_of(mesh, 500).balls, each);
}

TEST(SharedBalls, of_tubes_are_those_of_each_point) {
  // Normals around an axis lie in one plane.
  const Mesh mesh = sample_body("torus", 48);
  EXPECT_EQ(shared_balls_of(mesh, 2000), balls_of(mesh, 2000).balls);
}

TEST(SharedBalls, same_bits_for_any_number_of_workers) {
  const Mesh mesh = icosphere(3);
  const std::vector<Sphere> serial = shared_balls_of(mesh, 1000);
  for (const unsigned threads : {2u, 3u, 8u}) {
    Workers workers(threads);
    EXPECT_EQ(shared_balls_of(mesh, 1000, workers), serial) << threads;
  }
}

TEST(ShrinkingBalls, neighbors_are_the_nearest_that_overlap) {
  const MedialBalls medial = balls_of(sample_body("blob", 24), 300);
  const auto count = static_cast<std::uint32_t>(medial.balls.size());
  std::vector<std::vector<bool>> expected(count, std::vector<bool>(count));
  for (std::uint32_t i = 0; i < count; ++i) {
    std::vector<std::pair<double, std::uint32_t>> others;
    for (std::uint32_t j = 0; j < count; ++j) {
      if (j != i) others.emplace_back(squared_distance(medial.balls[i].center, medial.balls[j].center), j);
    }
    std::sort(others.begin(), others.end());
    for (std::size_t k = 0; k < 8; ++k) {
      const auto& [squared, j] = others[k];
      const double reach = medial.balls[i].radius + medial.balls[j].radius;
      if (squared < reach * reach) expected[i][j] = expected[j][i] = true;
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    std::vector<std::uint32_t> neighbors;
    for (std::uint32_t j = 0; j < count; ++j) {
      if (expected[i][j]) neighbors.push_back(j);
    }
    const auto begin = medial.neighbors.begin() + medial.neighbor_begin[i];
    EXPECT_EQ(neighbors, std::vector(begin, medial.neighbors.begin() + medial.neighbor_begin[i + 1]));
  }
}

TEST(MedialVoronoiBalls, hold_no_sample_and_have_their_centers_inside) {
  for (const char* name : {"limb", "bar", "torus", "two"}) {
    SCOPED_TRACE(name);
    const Mesh mesh = sample_body(name, 24);
    const SignedDistance shape(mesh);
    const std::vector<Vec3> points = samples_of(mesh, 400).points;
    const MedialBalls medial = voronoi_balls(shape, points);
    EXPECT_GT(medial.balls.size(), 100u);
    expect_sound_neighbors(medial);
    const double slack = 1e-5 * bounding_box(mesh).diagonal();
    for (const Sphere& ball : medial.balls) {
      ASSERT_TRUE(shape.is_inside(ball.center));
      for (const Vec3& point : points) ASSERT_GE(distance(point, ball.center), ball.radius - slack);
    }
    for (std::uint32_t i = 0; i < medial.balls.size(); ++i) {
      ASSERT_LE(medial.neighbor_begin[i + 1] - medial.neighbor_begin[i], 4u);
    }
    EXPECT_TRUE(same(voronoi_balls(shape, points), medial));
  }
}

TEST(MedialVoronoiBalls, of_nothing_there_are_none) {
  const Mesh mesh = icosphere(1);
  const SignedDistance shape(mesh);
  EXPECT_TRUE(voronoi_balls(shape, {}).balls.empty());
  EXPECT_TRUE(voronoi_balls(shape, std::span(mesh.positions).first(3)).balls.empty());
}

}  // namespace
}  // namespace morula::test
