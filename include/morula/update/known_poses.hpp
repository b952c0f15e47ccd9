// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Known poses: trees built in advance for expected poses of a mesh, so that a RebuiltBody is tight there at once.
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
  /// Method of the trees for all poses; branching and depth are those of the model that receives them.
  Method method = Method::optimized;
  Quality quality = Quality::standard;
  std::uint64_t seed = 1;
  /// A pose gets its own tree if the tightest of the existing trees has a level that is this many times as loose there
  /// as that of a tree built for the pose; above 1.
  double pose_threshold = 1.2;
  /// Largest number of trees added; principal_strains() with max_stretch up to 2 has as many poses.
  std::size_t max_trees = 24;
  StopToken stop{};
  /// Called at the start, and after every tree that was built or added, with KnownPosesReport::trees_built and worst up
  /// to then. May be empty.
  std::function<void(std::size_t count, double worst)> progress{};
};

struct KnownPosesReport {
  /// Trees that were built, at most one per pose: added ones, and others that only measure how tight a pose can be.
  std::size_t trees_built = 0;
  std::size_t added = 0;
  /// Largest ratio, over levels and all poses without their own tree, of the looseness of the tightest tree to that of
  /// a tree built for the pose; at least 1. A pose for which no tree was built is compared with the tightest of all
  /// trees, each at its own pose.
  double worst = 1;
};

/// Selects among `poses` those without a fitting tree, the worst first, and adds a tree for each to model.poses.
///
/// Cost: a build for each candidate pose, possibly for all (their trees are kept until the end), up to 16 in parallel
/// if there are workers; an update and an estimate of looseness for each pose and added tree. The result has the same
/// bits for any number of workers. Throws like build and Body; std::invalid_argument for options out of range and for a
/// pose of another size, and then changes nothing; BuildStopped.
KnownPosesReport add_known_poses(const MeshView& mesh, CoveredTree& model, std::span<const NamedPose> poses,
                                 const KnownPoseOptions& options = {}, WorkersOrAll workers = {});

/// Candidate poses for an unknown motion: the mesh stretched along each axis, at constant volume, in steps of a tenth
/// up to `max_stretch` times. Axes along which the mesh has no extent are skipped. Throws std::invalid_argument unless
/// 1 < max_stretch ≤ 10.
std::vector<NamedPose> principal_strains(const MeshView& mesh, double max_stretch = 2);

}  // namespace morula
