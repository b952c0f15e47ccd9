// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Each deformation against what geometry says it does.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/deform/deformation.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/triangle.hpp>
#include <regex>
#include <stdexcept>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

namespace morula {
namespace {

using test::pi;

Mesh deformed(const Mesh& mesh, const Deformations& deformations, double t = 1) {
  return {deform(mesh, deformations, t), mesh.facets};
}

double longest_displacement(const Mesh& mesh, const Deformations& deformations) {
  const std::vector<Vec3> moved = deform(mesh, deformations, 1);
  double longest = 0;
  for (std::size_t i = 0; i < moved.size(); ++i) longest = std::max(longest, distance(moved[i], mesh.positions[i]));
  return longest;
}

TEST(Stretch, scales_length_and_cross_section) {
  const Mesh bar = sample_body("bar", 8);
  for (const double factor : {0.25, 0.7, 2.0, 3.0})
    for (const double shrink : {-1.0, 0.0, 0.25, 0.3, 0.5, 1.0, 1.9, 2.0})
      for (const double t : {0.5, 1.0}) {
        const Mesh stretched = deformed(bar, {Stretch{factor, shrink}}, t);
        const double s = 1 + t * (factor - 1), across = std::pow(s, -shrink);
        for (std::size_t i = 0; i < bar.vertex_count(); ++i) {
          const Vec3 p = bar.positions[i];
          EXPECT_LT(distance(stretched.positions[i], {s * p.x, across * p.y, across * p.z}), 1e-13 * (1 + across));
        }
      }
}

TEST(Stretch, with_shrink_one_half_keeps_the_volume) {
  for (const char* name : {"bar", "limb", "blob", "torus"}) {
    const Mesh mesh = sample_body(name, 16);
    const double volume = signed_volume(mesh);
    for (const double factor : {0.1, 1.3, 2.0, 10.0})
      EXPECT_NEAR(signed_volume(deformed(mesh, {Stretch{factor}})) / volume, 1, 1e-12) << name;
    EXPECT_NEAR(signed_volume(deformed(mesh, {Stretch{3, 0}})) / volume, 3, 1e-12) << name;
  }
}

TEST(Twist, keeps_the_axis_coordinate_and_the_distance_to_the_axis) {
  const Mesh mesh = sample_body("limb", 16);
  const Box box = bounding_box(mesh);
  const Vec3 middle = box.center();
  const std::vector<Vec3> twisted = deform(mesh, {Twist{250}}, 1);
  for (std::size_t i = 0; i < twisted.size(); ++i) {
    const Vec3 before = mesh.positions[i] - middle, after = twisted[i] - middle;
    EXPECT_EQ(mesh.positions[i].x, twisted[i].x);
    EXPECT_NEAR(std::hypot(before.y, before.z), std::hypot(after.y, after.z), 1e-14);
    // The angle grows evenly from one end to the other.
    const double angle = 250 * pi / 180 * (mesh.positions[i].x - box.lower.x) / box.extent().x;
    EXPECT_NEAR(after.y, std::cos(angle) * before.y - std::sin(angle) * before.z, 1e-14);
    EXPECT_NEAR(after.z, std::sin(angle) * before.y + std::cos(angle) * before.z, 1e-14);
  }
}

// A strip around the x axis whose middle row is the center line.
Mesh strip(int n) {
  return test::translated(test::grid_plate(n, 4, 1), {1, 2, 3});
}

TEST(Bend, rolls_parallels_of_the_axis_into_arcs_about_one_center) {
  const Mesh mesh = strip(20);
  const Vec3 middle = bounding_box(mesh).center();
  for (const double degrees : {-200.0, -90.0, 30.0, 90.0, 180.0, 350.0}) {
    const double radius = 4 / (degrees * pi / 180);
    const Vec3 arc_center = middle + Vec3{0, radius, 0};
    const std::vector<Vec3> bent = deform(mesh, {Bend{degrees}}, 1);
    for (std::size_t i = 0; i < bent.size(); ++i) {
      const Vec3 before = mesh.positions[i] - middle;
      const double angle = before.x / radius, reach = radius - before.y;
      EXPECT_LT(distance(bent[i], arc_center + Vec3{reach * std::sin(angle), -reach * std::cos(angle), before.z}),
                1e-13);
    }
  }
}

TEST(Bend, keeps_the_length_of_the_center_line_and_the_body_ends_square_to_it) {
  const int n = 200;
  const Mesh mesh = strip(n);
  const std::vector<Vec3> bent = deform(mesh, {Bend{120}}, 1);
  const auto at = [&](int i, int j) { return bent[static_cast<std::size_t>(j * (n + 1) + i)]; };
  double line = 0;
  for (int i = 0; i < n; ++i) line += distance(at(i, n / 2), at(i + 1, n / 2));
  // Chords are shorter than their arcs by the factor sin(a)/a of half their angle a.
  const double half_angle = 120 * pi / 180 / n / 2;
  EXPECT_NEAR(line, 4 * std::sin(half_angle) / half_angle, 1e-12);
  // The two end sides enclose the bend's angle.
  const Vec3 first = normalized(at(0, n) - at(0, 0)), last = normalized(at(n, n) - at(n, 0));
  EXPECT_NEAR(std::acos(dot(first, last)) * 180 / pi, 120, 1e-9);
}

TEST(Bend, carries_on_straight_beyond_the_rest_box) {
  // Stretched to twice the length first, the outer quarters of the strip lie beyond the range that is bent.
  const Mesh mesh = test::grid_plate(40, 4, 1);
  const std::vector<Vec3> bent = deform(mesh, {Stretch{2, 0}, Bend{90}}, 1);
  const std::size_t row = 20 * 41;
  for (std::size_t i = 1; i < 10; ++i) {
    const Vec3 before = bent[row + i] - bent[row + i - 1], after = bent[row + i + 1] - bent[row + i];
    EXPECT_LT(distance(before, after), 1e-13);
    EXPECT_NEAR(dot(normalized(after), {std::sqrt(0.5), -std::sqrt(0.5), 0}), 1, 1e-12);
  }
}

TEST(Bend, refuses_to_fold_and_names_the_largest_angle_that_works) {
  // Along its short side, the bar reaches twice its length across.
  const Mesh bar = sample_body("bar", 8);
  for (const double sign : {1.0, -1.0})
    for (const double t : {0.0, 0.1, 1.0}) {
      try {
        deform(bar, {Bend{sign * 300, Axis::z}}, t);
        FAIL() << "a bend of 300 degrees was accepted";
      } catch (const std::invalid_argument& error) {
        const std::string message = error.what();
        std::smatch found;
        ASSERT_TRUE(std::regex_search(message, found, std::regex("at most ([0-9.]+) degrees work"))) << message;
        const double works = std::stod(found[1]);
        EXPECT_NEAR(works, 1 / 2.0 * 180 / pi, 2e-3);
        EXPECT_NE(message.find(sign < 0 ? "-300 degrees along z" : "300 degrees along z"), std::string::npos);
        const Mesh bent = deformed(bar, {Bend{sign * works, Axis::z}});
        EXPECT_GT(signed_volume(bent), 0);
        EXPECT_THROW(deform(bar, {Bend{sign * (works + 2e-3), Axis::z}}, t), std::invalid_argument);
      }
    }
}

TEST(Bend, may_follow_what_made_room_for_it) {
  const Mesh bar = sample_body("bar", 8);
  const Bend bend{50, Axis::z};
  EXPECT_THROW(deform(bar, {bend}, 1), std::invalid_argument);
  EXPECT_NO_THROW(deform(bar, {Stretch{0.5, 0}, bend}, 1));
}

TEST(Rotate, keeps_all_distances_and_returns_after_a_full_turn) {
  const Mesh mesh = sample_body("blob", 8);
  for (const Axis axis : {Axis::x, Axis::y, Axis::z, Axis::automatic}) {
    const std::vector<Vec3> turned = deform(mesh, {Rotate{77, axis}}, 1);
    for (std::size_t i = 0; i < turned.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const double before = distance(mesh.positions[i], mesh.positions[j]);
        EXPECT_NEAR(distance(turned[i], turned[j]) / before, 1, 1e-12);
      }
    EXPECT_LT(longest_displacement(mesh, {Rotate{360, axis}}), 1e-14);
    EXPECT_LT(longest_displacement(mesh, {Rotate{-7200, axis}}), 1e-13);
  }
  // Which way round: x towards y about z.
  const Mesh corner{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 1, 3}}};
  EXPECT_LT(distance(deform(corner, {Rotate{90, Axis::z}}, 1)[0], {0, 1, 0}), 1e-15);
}

TEST(Poke, moves_its_ball_smoothly_and_nothing_else) {
  const Mesh mesh = test::box_mesh({0, 0, 0}, {3, 2, 1}, 30);
  const double diagonal = std::sqrt(14.0);
  const Poke poke{{0.5, 0.5, 1}, {0.02, 0, -0.1}, 0.25};
  const Vec3 center{1.5, 1, 1};
  const std::vector<Vec3> poked = deform(mesh, {poke}, 1);
  std::size_t outside = 0;
  double deepest = 0;
  for (std::size_t i = 0; i < poked.size(); ++i) {
    const double share = distance(mesh.positions[i], center) / (0.25 * diagonal);
    const Vec3 moved = poked[i] - mesh.positions[i];
    if (share >= 1) {
      ++outside;
      EXPECT_EQ(poked[i], mesh.positions[i]);
    } else {
      EXPECT_LT(distance(moved, poke.push * (diagonal * std::pow(1 - share * share, 3))), 1e-14);
      deepest = std::max(deepest, length(moved));
    }
  }
  EXPECT_GT(outside, 100u);
  EXPECT_NEAR(deepest, diagonal * length(poke.push), 1e-12);
}

TEST(Noise, stays_within_its_amplitude_and_follows_its_seed) {
  const Mesh mesh = sample_body("limb", 24);
  const double diagonal = bounding_box(mesh).diagonal();
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const double moved = longest_displacement(mesh, {Noise{0.05, 0.25, seed}});
    EXPECT_LE(moved, 0.05 * diagonal * (1 + 1e-12)) << seed;
    EXPECT_GE(moved, 0.01 * diagonal) << seed;
  }
  EXPECT_EQ(deform(mesh, {Noise{0.05, 0.25, 9}}, 1), deform(mesh, {Noise{0.05, 0.25, 9}}, 1));
  EXPECT_NE(deform(mesh, {Noise{0.05, 0.25, 9}}, 1), deform(mesh, {Noise{0.05, 0.25, 10}}, 1));
}

// How much longer or shorter edges get is bounded by the steepness of the waves.
TEST(Noise, is_smooth_and_within_the_documented_limit_does_not_fold) {
  const Mesh mesh = sample_body("blob", 48);
  for (std::uint64_t seed = 0; seed < 10; ++seed)
    for (const double wavelength : {0.1, 0.25, 1.0}) {
      const std::vector<Vec3> moved = deform(mesh, {Noise{0.35 * wavelength, wavelength, seed}}, 1);
      for (const Facet& f : mesh.facets)
        for (int side = 0; side < 3; ++side) {
          const std::uint32_t a = f[side], b = f[(side + 1) % 3];
          const Vec3 before = mesh.positions[b] - mesh.positions[a], after = moved[b] - moved[a];
          EXPECT_LT(length(after - before), length(before));
        }
    }
}

TEST(Poke, within_the_documented_limit_does_not_fold) {
  const Mesh mesh = sample_body("blob", 48);
  const std::vector<Vec3> moved = deform(mesh, {Poke{{0.4, 0.6, 0.5}, {0, 0.58 * 0.3, 0}, 0.3}}, 1);
  for (const Facet& f : mesh.facets)
    for (int side = 0; side < 3; ++side) {
      const std::uint32_t a = f[side], b = f[(side + 1) % 3];
      const Vec3 before = mesh.positions[b] - mesh.positions[a], after = moved[b] - moved[a];
      EXPECT_LT(length(after - before), length(before));
    }
}

}  // namespace
}  // namespace morula
