// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The looseness of a body's current spheres, estimated from samples of its surface. It is cheap enough for every frame,
// unlike the count of voxels in accuracy/looseness.hpp.
#pragma once

#include <cstddef>
#include <memory>
#include <morula/update/body.hpp>
#include <span>
#include <vector>

namespace morula {

/// The estimate is the sum of A (h + H h² + K h³/3) over samples of the surface, divided by V. A is the area of a
/// sample; h is the way from it along the outward normal until it leaves the spheres of the level; H and K are mean and
/// Gaussian curvature there (Steiner's formula); V is the volume of the object. If two parts of the surface face each
/// other, the space between them counts up to the middle for each.
///
/// Compared with looseness() by voxels, the error is mostly below 5 % up to a looseness of 1.5, and below 15 % in all
/// poses of the tests, which include deformed and rough bodies. The largest known error is 20 %, on a limb stretched to
/// twice its length. A body that intersects itself gets a value that is too large, up to several times, because the
/// shared volume counts for each part. Surface outside all spheres counts as perfectly tight, so check the certificate
/// also. An open mesh has no inside: both sides count, V is the volume of the ball with the mesh's area, and only
/// ratios of estimates have a meaning.
///
/// Only one thread may use an estimator at a time.
class LoosenessEstimator {
 public:
  static constexpr std::size_t default_samples = 1024;

  /// Places samples evenly on the surface at rest; each stays at its place on its facet. Copies the required data.
  ///
  /// sample_count: 64 to 2^20, rounded up to a multiple of 16. The error decreases slowly with it, and the cost grows
  /// linearly. Throws std::invalid_argument for a mesh that require_usable() or require_usable_scale() rejects or that
  /// has no area, and for a count out of range.
  explicit LoosenessEstimator(const MeshView& rest, std::size_t sample_count = default_samples);
  ~LoosenessEstimator();
  LoosenessEstimator(LoosenessEstimator&&) noexcept;
  LoosenessEstimator& operator=(LoosenessEstimator&&) noexcept;

  /// Moves the samples to the positions of a frame; call it before estimate(). positions: one per vertex of the mesh,
  /// mesh units, finite. Allocates nothing. Cost: linear in facets and samples.
  void pose(const PositionView& positions) noexcept;

  /// Estimates the looseness of the level sets of a body at the positions of pose(): looseness[j] is that of level j,
  /// in volumes of the object. Entries beyond the tree's last level repeat its value. The value of the root is exact if
  /// its sphere contains the object. Allocates nothing. The result has the same bits in every run.
  void estimate(const Body& body, std::span<double> looseness) noexcept;

  /// Begins an estimate that is divided into `steps` calls of step() of about equal cost, such as one per frame.
  /// begin() copies positions and spheres; the last step() returns the values that pose() and estimate() would return
  /// at the time of begin(), bit for bit. An estimator runs one such estimate at a time; pose() and begin() cancel it.
  /// positions: as for pose(). body: must exist, with the same tree, until the last step. Allocates nothing for bodies
  /// with at most as many nodes as reserve() was called for.
  void begin(const PositionView& positions, const Body& body, std::size_t steps) noexcept;
  /// Runs a step of the estimate that begin() began. The last step writes `looseness`, like estimate(), and returns
  /// true; the others return false, and so does a call without such an estimate, which does nothing.
  bool step(std::span<double> looseness) noexcept;
  /// Cancels the estimate that begin() began.
  void give_up() noexcept;
  /// Allocates the memory that begin() needs for a body with this number of nodes.
  void reserve(std::size_t nodes);

  /// Number of samples, a multiple of 16.
  std::size_t sample_count() const;
  /// The volume V at the positions of the last pose(), mesh units³.
  double volume() const;
  /// True if the mesh has an inside: if it is closed and oriented, with a volume other than 0. Otherwise only ratios of
  /// estimates have a meaning.
  bool has_volume() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Estimates the looseness of the level sets of a body in one call, with new samples: one value per level, from the
/// root. rest: the body's mesh at rest. positions: those of the body's last update. Throws std::invalid_argument like
/// the constructor of LoosenessEstimator, and for another number of positions than vertices.
std::vector<double> estimate_looseness(const MeshView& rest, const Body& body, const PositionView& positions);

}  // namespace morula
