// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Known poses: trees made beforehand for poses that a mesh will come to, so that a RebuiltBody is tight there at once.
#pragma once

#include <cstddef>
#include <morula/generators/build.hpp>
#include <morula/tree/cover.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula {

struct NamedPose {
  std::string name;
  std::vector<Vec3> positions;  ///< one per mesh vertex
};

struct KnownPoseOptions {
  /// Of every pose; branching and depth as those of the tree that they are added to.
  Method method = Method::optimized;
  Quality quality = Quality::standard;
  std::uint64_t seed = 1;
  /// A pose gets a tree of its own when the tightest of those there are has a level that is this many times as loose
  /// there as that of a tree built for the pose; above 1.
  double pose_threshold = 1.2;
  std::size_t max_trees =
      24;  ///< largest number of trees added; principal_strains() up to twice the size has as many poses
  std::stop_token stop{};
  /// At first, and after every tree that was built or added: KnownPosesReport::trees_built and worst so far. May be
  /// empty.
  std::function<void(std::size_t count, double worst)> progress{};
};

struct KnownPosesReport {
  /// Trees, at most one for each pose: those added, and those that only show how tight a pose can be.
  std::size_t trees_built = 0;
  std::size_t added = 0;
  /// Over all poses that have no tree of their own, and levels: how many times as loose the tightest tree is as one
  /// built for the pose; at least 1. Poses for which none was built count beside the tightest of all trees, each at its
  /// own.
  double worst = 1;
};

/// Chooses among `poses` those that no tree serves, the worst served first, and adds a tree for each to built.poses.
/// Cost: a build for each pose that might be one of them, which may be all (their trees are kept until it is done), up
/// to 16 side by side where there are workers; an update and an estimate of looseness for each pose and tree added.
/// Same bits for any number of workers. Throws as build and Body do, std::invalid_argument for options out of range and
/// for a pose of another size, before anything is changed; BuildStopped.
KnownPosesReport add_known_poses(const MeshView& mesh, CoveredTree& model, std::span<const NamedPose> poses,
                                 const KnownPoseOptions& options = {}, WorkersOrAll workers = {});

/// Candidates where no motion is known: the mesh stretched along each axis, at constant volume, by steps of a tenth up
/// to `max_stretch` times. Axes along which the mesh has no extent are left out. Throws std::invalid_argument unless
/// 1 < max_stretch ≤ 10.
std::vector<NamedPose> principal_strains(const MeshView& mesh, double max_stretch = 2);

}  // namespace morula
