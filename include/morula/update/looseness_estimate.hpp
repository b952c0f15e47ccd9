// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Looseness of a body's current spheres, estimated from samples of its surface: cheap enough for every frame, unlike
// counting voxels (accuracy/looseness.hpp).
#pragma once

#include <cstddef>
#include <memory>
#include <morula/update/body.hpp>
#include <span>
#include <vector>

namespace morula {

/// E = Σ A (h + H h² + K h³/3) / V over samples of the surface: A is the area of a sample; h is the distance from it
/// along the outward direction to the end of the level's spheres that contain it; H and K are the mean and Gauss
/// curvature there (Steiner's formula); V is the volume of the object. Between facing parts of the surface each side
/// counts up to the middle.
///
/// The estimate is mostly within 5 % of the voxel measure up to a looseness of 1.5, and within 15 % in all poses of the
/// tests, including deformed and rough bodies. The largest known error is 20 %, on a limb stretched to twice its
/// length. Bodies that intersect themselves read too loose, up to several times, because the shared volume counts in
/// each part. Surface outside all spheres counts as perfectly tight, so looseness should be read with the certificate.
/// An open mesh has no inside: both sides count, and V is the volume of the ball with the mesh's area; only ratios are
/// meaningful then.
class LoosenessEstimator {
 public:
  static constexpr std::size_t default_samples = 1024;

  /// Places samples evenly on the surface at rest; they stay on their facets. Copies the required data.
  /// sample_count: 64…2^20, rounded up to a multiple of 16; the error falls slowly with it, the cost grows linearly.
  /// Throws std::invalid_argument for a mesh that is not usable or has no area, and for a count out of range.
  explicit LoosenessEstimator(const MeshView& rest, std::size_t sample_count = default_samples);
  ~LoosenessEstimator();
  LoosenessEstimator(LoosenessEstimator&&) noexcept;
  LoosenessEstimator& operator=(LoosenessEstimator&&) noexcept;

  /// Moves the samples; called once per estimated frame. positions: one per vertex of the mesh, mesh units, finite.
  /// Allocates nothing. Cost: linear in facets (the volume) and samples.
  void pose(const PositionView& positions) noexcept;

  /// Looseness of every level set of a body at the same positions, from the root; in object volumes. Fills all of
  /// `looseness`; levels deeper than the tree repeat its last. The root's value is exact if the root contains the
  /// object. Allocates nothing; the same bits in every run.
  void estimate(const Body& body, std::span<double> looseness) noexcept;

  /// Starts an estimate in `steps` calls of step() of about equal cost, for as many frames. begin() copies positions
  /// and spheres, and the last step() has the results that pose() and estimate() give at begin(), bit for bit. Only one
  /// estimate runs at a time; pose() and begin() cancel it. body: keeps its tree until the last step. Allocates nothing
  /// for bodies of at most `nodes` nodes after reserve(nodes).
  void begin(const PositionView& positions, const Body& body, std::size_t steps) noexcept;
  /// Runs a step. Returns true at the last step, which sets `looseness`; returns false and does nothing if no estimate
  /// is running.
  bool step(std::span<double> looseness) noexcept;
  void give_up() noexcept;
  void reserve(std::size_t nodes);

  std::size_t sample_count() const;
  /// Volume V at the last pose, mesh units³.
  double volume() const;
  /// True if the mesh is closed: it then has an inside, and looseness measures the volume outside it.
  bool has_volume() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The estimate in one call, with new samples: one value per level set of body, from the root. positions: those of the
/// body's last update. Throws like LoosenessEstimator, and for a wrong number of positions.
std::vector<double> estimate_looseness(const MeshView& rest, const Body& body, const PositionView& positions);

}  // namespace morula
