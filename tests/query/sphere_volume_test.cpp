// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/query/signed_distance.hpp>
#include <numbers>
#include <scenes/brute_force.hpp>
#include <support/meshes.hpp>

#include "points.hpp"

namespace morula {
namespace {

using test::box_mesh;
using test::icosphere;
using test::inverted;
using test::joined;

constexpr double tight = 1e-12;

// Part of the ball inside the object.
double share(const SignedDistance& object, const Sphere& ball) {
  return inside_volume(object, ball) / volume(ball);
}

// Part of a unit ball beyond a plane at this signed distance from its center.
double cap_share(double distance) {
  const double h = std::clamp(1 - distance, 0.0, 2.0);
  return h * h * (3 - h) / 4;
}

// A ball with its center anywhere, or exactly or nearly on the mesh.
Sphere hard_ball(const Mesh& mesh, Random& random) {
  const Box box = bounding_box(mesh);
  const double size = box.diagonal();
  const double radius = size * std::pow(10.0, -random.uniform(0, 2));
  switch (random.next() % 3) {
    case 0:
      return {test::point_around(box, 0.1, random), radius};
    case 1:
      return {test::point_on_surface(mesh, random), radius};
    default: {
      const double off = size * std::pow(10.0, -random.uniform(2, 16));
      return {test::point_on_surface(mesh, random) + test::random_direction(random) * off, radius};
    }
  }
}

TEST(SphereVolume, is_exact_for_halves_quarters_and_octants_of_a_cube) {
  for (const int n : {1, 2, 3, 8}) {
    SCOPED_TRACE(n);
    const SignedDistance cube(box_mesh({0, 0, 0}, {1, 1, 1}, n));
    EXPECT_EQ(share(cube, {{0.5, 0.5, 0.5}, 0.4}), 1);
    EXPECT_EQ(share(cube, {{0.5, 0.5, 1.5}, 0.4}), 0);
    for (const double r : {0.3, 0.01, 1e-6}) {
      EXPECT_NEAR(share(cube, {{0.5, 0.5, 1}, r}), 0.5, tight);
      EXPECT_NEAR(share(cube, {{0.5, 1.0 / 3, 0}, r}), 0.5, tight);
      EXPECT_NEAR(share(cube, {{0, 0.375, 0.625}, r}), 0.5, tight);
      EXPECT_NEAR(share(cube, {{1, 0, 0.5}, r}), 0.25, tight);
      EXPECT_NEAR(share(cube, {{1, 0.4, 1}, r}), 0.25, tight);
      EXPECT_NEAR(share(cube, {{0, 1, 0}, r}), 0.125, tight);
      EXPECT_NEAR(share(cube, {{0, 0, 0}, r}), 0.125, tight);
    }
    EXPECT_EQ(inside_volume(cube, {{0.5, 0.5, 0.5}, 0}), 0);
    EXPECT_EQ(outside_volume(cube, {{0.5, 0.5, 0.5}, -1}), volume(Sphere{{}, -1}));
  }
}

TEST(SphereVolume, is_exact_for_caps) {
  const SignedDistance cube(box_mesh({0, 0, 0}, {1, 1, 1}, 5));
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    const double r = random.uniform(0.01, 0.3), height = random.uniform(-1.1, 1.1);
    const Sphere ball{{random.uniform(r, 1 - r), random.uniform(r, 1 - r), 1 + r * height}, r};
    EXPECT_NEAR(share(cube, ball), cap_share(height), tight);
  }
}

TEST(SphereVolume, tangent_balls_lose_and_gain_nothing) {
  const SignedDistance cube(box_mesh({0, 0, 0}, {1, 1, 1}, 3));
  EXPECT_NEAR(share(cube, {{0.5, 0.5, 0.5}, 0.5}), 1, tight);
  EXPECT_NEAR(share(cube, {{0.25, 0.5, 0.5}, 0.25}), 1, tight);
  EXPECT_NEAR(share(cube, {{0.5, 0.5, 1.5}, 0.5}), 0, tight);
  EXPECT_NEAR(share(cube, {{0.3, 1.3, 1.4}, 0.5}), 0, tight);
  EXPECT_NEAR(share(cube, {{1.3, 1.4, 0.5}, 0.5}), 0, tight);
  EXPECT_NEAR(share(cube, {{3, 3, 2}, 3}), 0, tight);
  const Sphere circumscribed{{0.5, 0.5, 0.5}, std::sqrt(0.75)};
  EXPECT_NEAR(inside_volume(cube, circumscribed), 1, 1e-12);
  const Sphere inscribed_by_edges{{0.5, 0.5, 0.5}, std::sqrt(0.5)};
  EXPECT_NEAR(share(cube, inscribed_by_edges), 1 - 6 * cap_share(std::sqrt(0.5)), tight);
}

TEST(SphereVolume, a_ball_around_everything_holds_the_whole_volume) {
  for (const test::NamedMesh& named : test::all_meshes()) {
    if (!named.has_volume()) continue;
    SCOPED_TRACE(named.name);
    const SignedDistance object(named.mesh);
    const Box box = bounding_box(named.mesh);
    Random random(2);
    for (int i = 0; i < 10; ++i) {
      const Sphere ball{test::point_around(box, 0.2, random), box.diagonal() * random.uniform(1.5, 4)};
      EXPECT_NEAR(inside_volume(object, ball), std::abs(named.volume), 1e-11 * volume(ball));
    }
  }
}

TEST(SphereVolume, adds_up_over_the_pieces_of_a_body) {
  // A cube cut into two boxes, and into tetrahedra about an inner point: planes in all directions, and centers on them.
  Random random(7);
  const Mesh cube = box_mesh({0, 0, 0}, {1, 1, 1}, 3);
  const SignedDistance whole(cube);
  const SignedDistance left(box_mesh({0, 0, 0}, {0.37, 1, 1}, 2)), right(box_mesh({0.37, 0, 0}, {1, 1, 1}, 4));
  const Vec3 inner{0.41, 0.52, 0.63};
  const Mesh hull = box_mesh({0, 0, 0}, {1, 1, 1}, 1);
  std::vector<Mesh> piece_meshes;
  std::vector<SignedDistance> pieces;
  for (std::size_t f = 0; f < hull.facet_count(); ++f) {
    const Triangle t = hull.corners(f);
    piece_meshes.push_back({{inner, t[0], t[1], t[2]}, {{1, 2, 3}, {0, 2, 1}, {0, 3, 2}, {0, 1, 3}}});
    pieces.emplace_back(piece_meshes.back());
  }
  for (int i = 0; i < 600; ++i) {
    const Mesh& about = i % 3 == 0 ? piece_meshes[random.next() % piece_meshes.size()] : cube;
    const Sphere ball = hard_ball(about, random);
    SCOPED_TRACE(testing::Message() << ball.center.x << ' ' << ball.center.y << ' ' << ball.center.z << " radius "
                                    << ball.radius);
    EXPECT_NEAR(share(left, ball) + share(right, ball), share(whole, ball), tight);
    double sum = 0;
    for (const SignedDistance& piece : pieces) sum += share(piece, ball);
    EXPECT_NEAR(sum, share(whole, ball), 5 * tight);
  }
}

TEST(SphereVolume, subtracts_shells_that_are_turned_inwards) {
  // Thirty layers: the far field alone would miscount them.
  Mesh onion = icosphere(2);
  std::vector<SignedDistance> shells;
  shells.emplace_back(onion);
  for (int layer = 1; layer < 30; ++layer) {
    const Mesh shell = icosphere(2, 1 - 0.02 * layer);
    onion = joined(onion, layer % 2 == 1 ? inverted(shell) : shell);
    shells.emplace_back(shell);
  }
  const SignedDistance object(onion);
  Random random(4);
  for (int i = 0; i < 60; ++i) {
    const Sphere ball{test::random_direction(random) * random.uniform(0, 1.2), random.uniform(0.005, 0.3)};
    double expected = 0;
    for (std::size_t layer = 0; layer < shells.size(); ++layer)
      expected += layer % 2 == 1 ? -share(shells[layer], ball) : share(shells[layer], ball);
    EXPECT_NEAR(share(object, ball), expected, 1e-11);
  }
}

TEST(SphereVolume, approaches_the_lens_of_two_balls) {
  const Sphere body{{0.2, -0.1, 0.3}, 1};
  const auto lens = [&](const Sphere& ball) {
    const double d = distance(body.center, ball.center), sum = body.radius + ball.radius;
    const double difference = body.radius - ball.radius;
    return std::numbers::pi * (sum - d) * (sum - d) * (d * d + 2 * d * sum - 3 * difference * difference) / (12 * d);
  };
  double errors[2];
  for (const int subdivisions : {3, 4}) {
    const SignedDistance object(icosphere(subdivisions, body.radius, body.center));
    double& worst = errors[subdivisions - 3] = 0;
    Random random(5);
    for (int i = 0; i < 100; ++i) {
      const double r = random.uniform(0.1, 1.5);
      const double d = random.uniform(std::abs(1 - r), 1 + r);
      const Sphere ball{body.center + test::random_direction(random) * d, r};
      worst = std::max(worst, std::abs(inside_volume(object, ball) - lens(ball)) / volume(ball));
    }
  }
  EXPECT_LT(errors[0], 0.05);
  // Inscribed polyhedra: half the edge, a quarter of the error.
  EXPECT_NEAR(errors[0] / errors[1], 4, 0.5);
}

TEST(SphereVolume, agrees_with_sampling) {
  for (const test::NamedMesh& named : test::all_meshes()) {
    if (!named.has_volume() || named.volume < 0 || named.mesh.facet_count() > 700) continue;
    SCOPED_TRACE(named.name);
    const SignedDistance object(named.mesh);
    Random random(8);
    for (int i = 0; i < 6; ++i) {
      const Sphere ball = hard_ball(named.mesh, random);
      const double sampled = brute_force::inside_volume(named.mesh, ball, 1000) / volume(ball);
      EXPECT_NEAR(share(object, ball), sampled, 0.03);
    }
  }
}

TEST(SphereVolume, changes_no_faster_than_the_ball_moves) {
  // A wrong count of turns shows as a jump of at least an eighth somewhere. Moving the ball by s changes the volume by
  // at most π r² s; `s` is far below the distances at which hard_ball puts centers beside vertices and edges.
  std::vector<Mesh> meshes;
  for (const test::NamedMesh& named : test::closed_meshes()) meshes.push_back(named.mesh);
  for (const std::string_view name : sample_body_names()) meshes.push_back(sample_body(name, 12));
  for (const Mesh& mesh : meshes) {
    const SignedDistance object(mesh);
    const Box box = bounding_box(mesh);
    const double ulp = 0x1p-52 * std::max(max_norm(box.lower), max_norm(box.upper));
    Random random(10);
    for (int i = 0; i < 400; ++i) {
      const Sphere ball = hard_ball(mesh, random);
      const double step = std::pow(10.0, -random.uniform(3, 15)) * ball.radius;
      const Sphere moved{ball.center + test::random_direction(random) * step, ball.radius};
      EXPECT_NEAR(share(object, ball), share(object, moved), 0.75 * (step + 100 * ulp) / ball.radius + tight)
          << mesh.facet_count() << " facets, ball " << ball.center.x << ' ' << ball.center.y << ' ' << ball.center.z
          << " radius " << ball.radius << " step " << step;
    }
  }
}

TEST(SphereVolume, moves_and_scales_with_its_object) {
  const Mesh mesh = sample_body("limb", 16);
  const SignedDistance object(mesh), turned(inverted(mesh));
  const SignedDistance small(test::scaled(mesh, 0x1p-40)), large(test::scaled(mesh, 0x1p40));
  const Vec3 offset{1e6, -2e6, 5e5};
  const SignedDistance far(test::translated(mesh, offset));
  Random random(14);
  for (int i = 0; i < 100; ++i) {
    const Sphere ball = hard_ball(mesh, random);
    const double expected = share(object, ball);
    EXPECT_EQ(share(small, {ball.center * 0x1p-40, ball.radius * 0x1p-40}), expected);
    EXPECT_EQ(share(large, {ball.center * 0x1p40, ball.radius * 0x1p40}), expected);
    EXPECT_NEAR(share(turned, ball), expected, tight);
    EXPECT_NEAR(share(far, {ball.center + offset, ball.radius}), expected, 1e-8 / ball.radius);
  }
}

TEST(SphereVolume, integrates_the_winding_number_of_an_open_surface) {
  const Mesh& scan = test::mesh_named("open_scan").mesh;
  const SignedDistance object(scan);
  Random random(15);
  for (int i = 0; i < 5; ++i) {
    const Sphere ball{test::random_direction(random) * 0.5, 0.4};
    double sum = 0;
    const int count = 400;
    for (int k = 0; k < count; ++k) {
      const double radius = ball.radius * std::cbrt((k + random.uniform()) / count);
      sum += brute_force::winding_number(scan, ball.center + test::random_direction(random) * radius);
    }
    EXPECT_NEAR(share(object, ball), sum / count, 0.04);
  }
}

}  // namespace
}  // namespace morula
