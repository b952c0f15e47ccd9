// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skinned bodies that compute vertices when queries read them. Each has a second collider, which is given all vertices.
#pragma once

#include <cstddef>
#include <morula/collide/collider.hpp>
#include <morula/collide/primitives.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/update/body.hpp>
#include <optional>
#include <support/transforms.hpp>
#include <vector>

namespace morula::test {

using Transforms = std::vector<AffineTransform>;

/// Bones in a row along x: each vertex has the four nearest, and follows the nearer more.
Skin skin_along_x(const Mesh& mesh, std::size_t bone_count);
/// Each bone turned and shifted against rest by up to `amount`, scaled unevenly by up to a quarter of it.
Transforms random_pose(Random& random, std::size_t bone_count, double amount);
/// The positions by the definition of a skin, summed in long double.
std::vector<Vec3> defined_positions(const Skin& skin, const std::vector<Vec3>& rest, const Transforms& transforms);

struct PosedBody {
  PosedBody(Mesh m, std::size_t bone_count, int depth = 3);
  /// Updates the body by these transforms, and gives the positions to `given`.
  void pose(const Transforms& transforms);

  Mesh mesh;
  Skin skin;
  CoveredTree model;
  Body body;
  Transforms transforms;
  std::vector<Vec3> positions;
  Collider collider, given;
};
/// A limb with 24 bones.
PosedBody& posed_limb();

inline std::size_t below(Random& random, std::size_t count) {
  return static_cast<std::size_t>(random.next() % count);
}
/// From up to 4 away to near the origin.
inline Ray random_ray(Random& random) {
  Ray ray{random_point(random, 4.0), {}};
  ray.direction = random_point(random, 1.0) - ray.origin;
  return ray;
}

bool same_bits(const PositionView& a, const std::vector<Vec3>& b);
bool same(const SurfacePoint& a, const SurfacePoint& b);
bool same(const std::optional<RayPoint>& a, const std::optional<RayPoint>& b);

}  // namespace morula::test
