// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The spheres of a link under a tree, for tests of one link against another.
#pragma once

#include <cstdint>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <vector>

namespace morula::robot {

/// A node's sphere contains, up to rounding, the spheres below it.
struct SphereGroup {
  struct Node {
    Sphere sphere{};                ///< sphere in the link's axes
    std::uint32_t first_child = 0;  ///< children are adjacent
    std::uint32_t child_count = 0;  ///< number of children; 0: one of the link's spheres
  };
  std::vector<Node> nodes;  ///< the root first
  double extent = 0;        ///< upper bound of the distance of a sphere's points from the link's origin
};
SphereGroup group_of(std::span<const Sphere> spheres);

/// Whether a sphere of one meets one of the other, and counts the pairs of nodes that were tested. Spheres that are
/// apart by less than rounding can move them (2^-40 of their coordinates and radii) count as meeting.
bool groups_meet(const SphereGroup& a, const RigidTransform& at_a, const SphereGroup& b, const RigidTransform& at_b,
                 std::size_t& tests);

/// The two spheres that are nearest, or lie deepest in each other.
struct NearestSpheres {
  double distance = 0;  ///< distance of their surfaces; negative where they overlap
  Vec3 a{}, b{};        ///< their centers
};
NearestSpheres nearest_spheres(const SphereGroup& a, const RigidTransform& at_a, const SphereGroup& b,
                               const RigidTransform& at_b);

}  // namespace morula::robot
