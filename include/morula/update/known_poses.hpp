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
  Method method = Method::morula;
  Quality quality = Quality::standard;
  std::uint64_t seed = 1;
  /// A pose gets a tree of its own when the tightest of those there are is somewhere this many times as loose there as
  /// at the pose it was made for; above 1.
  double looser_by = 1.5;
  std::size_t most = 24;  ///< trees added at most; principal_strains() up to twice the size has as many poses
  std::stop_token stop{};
  /// After every tree: how many there are, and by how much the tightest one is looser at the worst pose. May be empty.
  std::function<void(std::size_t count, double worst)> progress{};
};

struct KnownPosesReport {
  std::size_t added = 0;
  double worst = 1;  ///< over all poses: by how much the tightest tree is looser there than where it was made
};

/// Chooses among `poses` those that no tree serves, the worst served first, and adds a tree for each to built.poses.
/// Cost: a build for each one added, and an update and an estimate of looseness for each pose and tree. Same bits for
/// any number of workers. Throws as build and Body do, std::invalid_argument for options out of range and for a pose of
/// another size, before anything is changed; BuildStopped.
KnownPosesReport add_known_poses(const Mesh& mesh, CoveredTree& built, std::span<const NamedPose> poses,
                                 const KnownPoseOptions& options = {}, Workers& workers = serial_workers());

/// Candidates where no motion is known: the mesh stretched along each axis, at constant volume, by steps of a tenth up
/// to `most` times. Axes along which the mesh has no extent are left out. Throws std::invalid_argument unless
/// 1 < most ≤ 10.
std::vector<NamedPose> principal_strains(const Mesh& mesh, double most = 2);

}  // namespace morula
