// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies to ask about: deformed, placed, near and far from the origin; and the slow, obvious answers.
#pragma once

#include <memory>
#include <morula/collide/collider.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <string>
#include <support/transforms.hpp>
#include <vector>

namespace morula::test {

/// A mesh with all that a collider borrows, at addresses that stay.
struct PlacedBody {
  explicit PlacedBody(Mesh m, int depth = 3);
  /// Moves vertices and tells body and collider.
  void deform(std::vector<Vec3> moved);

  std::string name;
  Mesh mesh;
  CoveredTree model;
  Body body;
  std::vector<Vec3> positions;
  Collider collider;
};

/// Limb, torus and box, an open plate and a soup: made once, at rest where they were made.
std::vector<std::unique_ptr<PlacedBody>>& placed_bodies();

/// Bent and rippled by up to `amount` of its size.
std::vector<Vec3> rippled(const std::vector<Vec3>& positions, double amount, std::uint64_t seed);

/// Distance of two triangles by features, in double; 0 when an edge of one goes through the other.
double slow_distance(const Triangle& a, const Triangle& b);
double slow_segment_distance(const Vec3& p, const Vec3& q, const Triangle& t);
/// Over all pairs of facets.
double slow_distance(const Collider& a, const Collider& b);

/// Sum of all solid angles over 4 pi, in the world.
double slow_winding(const Collider& body, const Vec3& p);

/// Largest |coordinate| of the body's vertices in the world: what rounding is measured by.
double largest_coordinate(const Collider& body);

}  // namespace morula::test
