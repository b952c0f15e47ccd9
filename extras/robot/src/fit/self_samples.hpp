// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sampled configurations of a robot, and the collisions of its links' shapes in them.
#pragma once

#include <memory>
#include <morula/robot/self_fit.hpp>
#include <span>
#include <utility>

namespace morula::robot {

/// Poses of all links in random configurations, by sample. Joints without a usable range stay at rest.
std::vector<std::vector<RigidTransform>> sampled_poses(const Robot& robot, const RobotSpheres& spheres,
                                                       std::size_t samples, std::uint64_t seed);

/// The shapes of links as solids, for exact tests. Safe to use from several threads.
class LinkSolids {
 public:
  /// Prepares all links of `spheres`. Borrows nothing.
  LinkSolids(const RobotSpheres& spheres, Workers& workers);
  ~LinkSolids();
  LinkSolids(const LinkSolids&) = delete;
  LinkSolids& operator=(const LinkSolids&) = delete;

  /// Whether the shapes collide: surfaces cross or touch, or one contains a component of the other. a, b: places in
  /// spheres.links, in the given poses.
  bool collide(std::size_t a, const RigidTransform& at_a, std::size_t b, const RigidTransform& at_b) const;

 private:
  struct Solid;
  std::vector<std::unique_ptr<Solid>> solids_;
};

/// A pair of places in RobotSpheres::links.
using PlacePair = std::pair<std::size_t, std::size_t>;
/// All pairs that are not ignored, first place first, ascending.
std::vector<PlacePair> tested_pairs(const RobotSpheres& spheres, std::span<const IgnoredPair> ignored);
/// Per pair, whether it counts: its shapes collide in less than 95 % of the samples. collisions: per sample the pairs.
std::vector<bool> counted_pairs(std::span<const std::vector<std::size_t>> collisions, std::size_t pairs);

}  // namespace morula::robot
