// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Looseness of a body's current spheres, estimated from samples of its surface: cheap enough for a running loop, where
// counting voxels (accuracy/looseness.hpp) is not.
#pragma once

#include <cstddef>
#include <memory>
#include <morula/update/body.hpp>
#include <span>
#include <vector>

namespace morula {

/// E = Σ A (h + H h² + K h³/3) / V over samples of the surface: A is a sample's area, h how far one gets from it along
/// the outward direction before leaving the spheres of the level that contain it, H and K the mean and Gauss curvature
/// there (Steiner's formula), V the volume of the object. Between facing parts of the surface each side counts up to
/// the middle.
///
/// Mostly within 5 % of the voxel measure up to a looseness of 1.5, within 15 % in all poses of the tests, deformed and
/// rough bodies among them; 20 % was seen once, on a limb stretched to twice its length.
/// Bodies that lie through each other read too loose, up to several times: what they share counts in each.
/// Surface that no sphere contains counts as perfectly tight: read looseness beside the certificate. An open mesh has
/// no inside: both sides count, and V is the volume of the ball with the mesh's area; only ratios mean something then.
class LoosenessEstimator {
 public:
  static constexpr std::size_t default_samples = 1024;

  /// Places samples evenly over the surface at rest; they stay on their facets. Copies what it needs.
  /// sample_count: 64…2^20, rounded up to a multiple of 16; the error falls slowly with it, the cost linearly.
  /// Throws std::invalid_argument for a mesh that is not usable or has no area, and for a count out of range.
  explicit LoosenessEstimator(const MeshView& rest, std::size_t sample_count = default_samples);
  ~LoosenessEstimator();
  LoosenessEstimator(LoosenessEstimator&&) noexcept;
  LoosenessEstimator& operator=(LoosenessEstimator&&) noexcept;

  /// Moves the samples: once per frame that is estimated. positions: one per vertex of the mesh, mesh units, finite.
  /// No allocation. Cost: linear in facets (the volume) and samples.
  void pose(const PositionView& positions) noexcept;

  /// Looseness of every level set of a body at the same positions, from the root; object volumes. As many as
  /// `looseness` has room for; levels deeper than the tree repeat its last. The root's is exact where it contains the
  /// object. No allocation; the same bits on every run.
  void estimate(const Body& body, std::span<double> looseness) noexcept;

  /// The same in `steps` calls of step() that cost about the same, in as many frames: begin() copies positions and
  /// spheres, and the last step() has the figures that pose() and estimate() would have given then, bit for bit. One at
  /// a time; pose() and begin() give up what is under way. body: keeps its tree until the last step. No allocation for
  /// bodies of at most `nodes` nodes, once reserve(nodes) was called.
  void begin(const PositionView& positions, const Body& body, std::size_t steps) noexcept;
  /// True with the last step, when `looseness` is set; nothing is done, and false, when none is under way.
  bool step(std::span<double> looseness) noexcept;
  void give_up() noexcept;
  void reserve(std::size_t nodes);

  std::size_t sample_count() const;
  /// V at the last pose, mesh units cubed.
  double volume() const;
  /// The mesh is closed: it has an inside, and looseness tells what spheres take up beside it.
  bool has_volume() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The same in one call, with samples placed anew: one figure per level set of body, from the root. positions: those of
/// the body's last update. Throws as LoosenessEstimator does, and for a wrong number of positions.
std::vector<double> estimate_looseness(const MeshView& rest, const Body& body, const PositionView& positions);

}  // namespace morula
