// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Modal certificates: brute force at random coordinates up to the limit, and bodies whose limit is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/box.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/triangle_intersection.hpp>
#include <morula/surface/modal_certificate.hpp>
#include <morula/update/sample_motions.hpp>
#include <support/allocations.hpp>

#include "surfaces.hpp"

namespace morula {
namespace {

std::vector<FeaturePair> crossings_by_brute_force(const Mesh& mesh, const std::vector<Vec3>& at) {
  std::vector<FeaturePair> found;
  for (std::uint32_t f = 0; f < mesh.facets.size(); ++f)
    for (std::uint32_t g = f + 1; g < mesh.facets.size(); ++g) {
      const Facet &a = mesh.facets[f], &b = mesh.facets[g];
      if (std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end()) continue;
      if (intersect(Triangle{at[a[0]], at[a[1]], at[a[2]]}, Triangle{at[b[0]], at[b[1]], at[b[2]]}))
        found.push_back({PairKind::facet_facet, f, g});
    }
  return found;
}

/// Coordinates of this norm, in a random direction.
std::vector<double> random_coordinates(std::span<const double> scales, double norm, Random& random) {
  std::vector<double> q(scales.size());
  double square = 0;
  for (double& y : q) y = random.uniform(-1, 1), square += y * y;
  for (std::size_t j = 0; j < q.size(); ++j) q[j] *= norm / std::sqrt(square) * scales[j];
  return q;
}

/// A ring that is cut open. The first mode closes it, the others shear and ripple it.
struct Bending {
  Mesh mesh;
  Modes modes;
  std::vector<double> scales;
};
Bending open_ring(int resolution) {
  Bending b;
  b.mesh = sample_body("capsule", resolution);
  const Box box = bounding_box(b.mesh);
  const double extent = box.extent().x;
  for (Vec3& p : b.mesh.positions) {
    const double angle = 5.2 * (p.x - box.center().x) / extent, r = 1 + 0.25 * p.y;
    p = {r * std::sin(angle), r * std::cos(angle), 0.25 * p.z};
  }
  b.modes = {.vertex_count = b.mesh.vertex_count(), .mode_count = 3, .displacements = {}};
  for (const Vec3& p : b.mesh.positions) b.modes.displacements.push_back({-1.2 * p.x * std::max(0.0, -p.y), 0, 0});
  for (const Vec3& p : b.mesh.positions) b.modes.displacements.push_back({0, 0.2 * p.x, 0.3 * p.x});
  for (const Vec3& p : b.mesh.positions) b.modes.displacements.push_back({0.3 * p.y, 0.2 * std::sin(3 * p.x), 0});
  b.scales = {1, 2, 1};
  return b;
}

TEST(ModalCertificate, is_right_at_random_coordinates_up_to_the_limit) {
  Random random(61);
  const Bending b = open_ring(24);
  ModalCertificate certificate(b.mesh, b.modes, {.largest_norm = 1.5, .scales = b.scales});
  ASSERT_GT(certificate.free_norm(), 0.01);
  ASSERT_LT(certificate.free_norm(), 1.5);
  std::vector<Vec3> at(b.mesh.positions.size());
  std::vector<FeaturePair> found;
  std::size_t crossing = 0, open = 0;
  for (int round = 0; round < 30; ++round) {
    const bool at_the_limit = round % 2 == 0;
    const double norm = at_the_limit ? certificate.free_norm() * (1 - 1e-12) : 1.5 * random.uniform();
    std::vector<double> q = random_coordinates(b.scales, norm, random);
    // Some of them close the ring, nearly as far as is certified.
    if (round % 4 == 1) q = {random.uniform(1.1, 1.4), random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3)};
    double square = 0;
    for (std::size_t j = 0; j < q.size(); ++j) square += q[j] * q[j] / (b.scales[j] * b.scales[j]);
    EXPECT_NEAR(certificate.norm(q), std::sqrt(square), 1e-9);
    EXPECT_GE(certificate.norm(q), std::sqrt(square) * (1 - 1e-15));
    ASSERT_TRUE(certificate.is_known(q));
    move_by_modes(b.modes, b.mesh.positions, q, at);
    const std::vector<FeaturePair> expected = crossings_by_brute_force(b.mesh, at);
    if (certificate.is_free(q)) {
      EXPECT_TRUE(expected.empty());
      EXPECT_TRUE(certificate.open(q).empty());
    }
    EXPECT_TRUE(!at_the_limit || certificate.is_free(q));
    found.clear();
    ASSERT_TRUE(certificate.crossings(q, at, found));
    EXPECT_EQ(found, expected);
    crossing += expected.size();
    open += certificate.open(q).size();
  }
  EXPECT_GT(crossing, 100u);
  EXPECT_LT(open / 30, b.mesh.facets.size() * b.mesh.facets.size() / 20) << "whole pairs are left out";
  EXPECT_LT(certificate.tested_facet_pairs(), b.mesh.facets.size() * b.mesh.facets.size() / 4);
}

TEST(ModalCertificate, leaves_out_what_is_near_at_rest_and_nothing_else) {
  Random random(71);
  const Bending b = open_ring(12);
  const double rest_distance = 0.12;
  const ModalCertificate all(b.mesh, b.modes, {.largest_norm = 1.5}),
      some(b.mesh, b.modes, {.largest_norm = 1.5, .rest_distance = rest_distance});
  EXPECT_GT(some.free_norm(), 1.2 * all.free_norm());
  const std::vector<Vec3>& rest = b.mesh.positions;
  const auto near_at_rest = [&](const FeaturePair& pair) {
    const Facet &f = b.mesh.facets[pair.a], &g = b.mesh.facets[pair.b];
    long double least = 9;
    for (std::size_t k = 0; k < 3; ++k) {
      least = std::min(least, test::plain_distance(rest, {f[k]}, {g[0], g[1], g[2]}));
      least = std::min(least, test::plain_distance(rest, {g[k]}, {f[0], f[1], f[2]}));
      for (std::size_t l = 0; l < 3; ++l)
        least = std::min(least, test::plain_distance(rest, {f[k], f[(k + 1) % 3]}, {g[l], g[(l + 1) % 3]}));
    }
    return least <= rest_distance;
  };
  std::vector<Vec3> at(rest.size());
  std::size_t left_out = 0, kept = 0;
  for (int round = 0; round < 40; ++round) {
    // At the limit, and where the ring closes.
    std::vector<double> q = random_coordinates({b.scales.data(), 3}, some.free_norm() * 0.4, random);
    if (round % 2 == 1) q = {random.uniform(1.1, 1.4), random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3)};
    ASSERT_TRUE(some.is_known(q));
    move_by_modes(b.modes, rest, q, at);
    std::vector<FeaturePair> expected, found;
    for (const FeaturePair& pair : crossings_by_brute_force(b.mesh, at)) {
      if (near_at_rest(pair)) {
        ++left_out;
      } else {
        expected.push_back(pair);
      }
    }
    ASSERT_TRUE(some.crossings(q, at, found));
    EXPECT_EQ(found, expected);
    EXPECT_TRUE(!some.is_free(q) || expected.empty());
    kept += expected.size();
  }
  EXPECT_GT(kept, 20u);
  EXPECT_GT(left_out + kept, kept);
}

TEST(ModalCertificate, keeps_the_margin) {
  Random random(67);
  const Bending b = open_ring(12);
  const double margin = 0.02;
  ModalCertificate certificate(b.mesh, b.modes, {.largest_norm = 1, .margin = margin, .scales = b.scales});
  std::vector<Vec3> at(b.mesh.positions.size());
  const auto share = [](const Facet& f, const test::Vertices& vertices) {
    return std::find_first_of(f.begin(), f.end(), vertices.begin(), vertices.end()) != f.end();
  };
  for (int round = 0; round < 4; ++round) {
    const double norm = certificate.free_norm() + 0.2 * round;
    const std::vector<double> q = random_coordinates(b.scales, norm * (1 - 1e-12), random);
    move_by_modes(b.modes, b.mesh.positions, q, at);
    const auto pairs = certificate.open(q);
    std::vector<std::array<std::uint32_t, 2>> open;
    for (const FeaturePair& pair : pairs) open.push_back({pair.a, pair.b});
    std::sort(open.begin(), open.end());
    for (std::uint32_t f = 0; f < b.mesh.facets.size(); ++f)
      for (std::uint32_t g = 0; g < b.mesh.facets.size(); ++g) {
        const Facet &i = b.mesh.facets[f], &j = b.mesh.facets[g];
        if (f == g || share(i, {j[0], j[1], j[2]})) continue;
        if (std::binary_search(open.begin(), open.end(), std::array{std::min(f, g), std::max(f, g)})) continue;
        ASSERT_GT(test::plain_distance(at, {i[0]}, {j[0], j[1], j[2]}), margin);
      }
  }
}

TEST(ModalCertificate, of_two_plates_ends_where_they_meet) {
  // The upper plate comes down by one per unit of the first mode; the second slides it; the third moves both.
  const Mesh plate = test::grid_plate(6);
  const Mesh mesh = test::joined(plate, test::translated(plate, {0, 0, 1}));
  const std::size_t half = plate.positions.size();
  Modes modes{.vertex_count = mesh.vertex_count(), .mode_count = 3, .displacements = {}};
  for (std::size_t v = 0; v < 2 * half; ++v) modes.displacements.push_back({0, 0, v < half ? 0.0 : -1.0});
  for (std::size_t v = 0; v < 2 * half; ++v) modes.displacements.push_back({v < half ? 0.0 : 0.5, 0, 0});
  for (std::size_t v = 0; v < 2 * half; ++v) modes.displacements.push_back({9, 9, 9});
  // Within a plate nothing bends, so all that counts is between them.
  const ModalCertificate certificate(mesh, modes, {.largest_norm = 1.5});
  EXPECT_LE(certificate.free_norm(), 1);
  EXPECT_GT(certificate.free_norm(), 1 - 1e-9);
  EXPECT_NEAR(ModalCertificate(mesh, modes, {.largest_norm = 1.5, .margin = 0.05}).free_norm(), 0.95, 1e-9);
  EXPECT_NEAR(ModalCertificate(mesh, modes, {.largest_norm = 5, .scales = {0.5, 1, 1}}).free_norm(), 2, 1e-9);
  EXPECT_EQ(ModalCertificate(mesh, modes, {.largest_norm = 0.9}).free_norm(), 0.9);
  std::vector<Vec3> at(mesh.positions.size());
  const double q[]{1, 0, 0};
  move_by_modes(modes, mesh.positions, q, at);
  EXPECT_FALSE(certificate.is_free(q));
  std::vector<FeaturePair> found;
  EXPECT_TRUE(certificate.crossings(q, at, found));
  EXPECT_EQ(found, crossings_by_brute_force(mesh, at));
  EXPECT_FALSE(found.empty());
}

// A sum of thousands of squares that are all rounded down.
TEST(ModalCertificate, norm_is_rounded_up_for_any_number_of_modes) {
  const Mesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  Modes modes;
  modes.vertex_count = mesh.positions.size();
  modes.mode_count = 16'000;
  modes.displacements.resize(modes.mode_count * modes.vertex_count);
  const ModalCertificate certificate(mesh, modes, {.largest_norm = 1e-3});
  const double y = 1 + 0.98 * 0x1p-43;
  const std::vector<double> q(modes.mode_count, y);
  const long double square = static_cast<long double>(y) * y * static_cast<long double>(q.size());
  const long double norm = certificate.norm(q);
  EXPECT_GE(norm * norm, square);
  EXPECT_LE(norm * norm, square * (1 + 1e-11L));
}

TEST(ModalCertificate, refuses_what_it_cannot_know) {
  const Mesh mesh = sample_body("capsule", 12);
  const Modes modes = sample_modes(mesh.positions, 4);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ModalCertificate(mesh, modes, {.largest_norm = 0}), std::invalid_argument);
  EXPECT_THROW(ModalCertificate(mesh, modes, {.margin = -1}), std::invalid_argument);
  EXPECT_THROW(ModalCertificate(mesh, modes, {.rest_distance = nan}), std::invalid_argument);
  EXPECT_THROW(ModalCertificate(mesh, modes, {.scales = {1, 1}}), std::invalid_argument);
  EXPECT_THROW(ModalCertificate(mesh, modes, {.scales = {1, 1, 0, 1}}), std::invalid_argument);
  Modes other = modes;
  other.displacements[3].y = nan;
  EXPECT_THROW(ModalCertificate(mesh, other), std::invalid_argument);
  other = sample_modes(std::span(mesh.positions).first(7), 4);
  EXPECT_THROW(ModalCertificate(mesh, other), std::invalid_argument);

  const ModalCertificate certificate(mesh, modes, {.largest_norm = 2});
  std::vector<FeaturePair> found;
  for (const std::vector<double>& q : {std::vector<double>{1, 2, 3, 4}, {nan, 0, 0, 0}, {0, 0, 0}}) {
    EXPECT_FALSE(certificate.is_known(q));
    EXPECT_FALSE(certificate.is_free(q));
    EXPECT_FALSE(certificate.crossings(q, mesh.positions, found));
  }
  const double q[]{0.5, 1, 1, 0.5};
  EXPECT_FALSE(certificate.crossings(q, std::span(mesh.positions).first(7), found));
  std::vector<Vec3> at(mesh.positions.size());
  move_by_modes(modes, mesh.positions, q, at);
  EXPECT_TRUE(certificate.crossings(q, at, found));
  found.clear();
  const std::size_t before = test::allocations;
  EXPECT_TRUE(certificate.crossings(q, at, found));
  EXPECT_EQ(test::allocations - before, 0u);
}

}  // namespace
}  // namespace morula
