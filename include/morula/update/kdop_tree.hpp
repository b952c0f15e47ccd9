// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes and k-DOPs instead of spheres, over the same tree and the same regions, for comparison.
#pragma once

#include <morula/update/body.hpp>

namespace morula {

/// A mesh with its tree and cover, whose nodes have k-DOPs instead of spheres [klosowski1998]: k / 2 slabs of fixed
/// directions that contain the node's region. 6-DOPs are axis-aligned boxes.
///
/// Every node contains the patches that it owns in every frame, like a Body with the rule `exact`, because slabs are
/// convex. Unlike a sphere, an inner node is exactly the union of its children. [klosowski1998] tumbles slabs of rigid
/// bodies along their hulls; this class computes them from the positions of each frame.
class KDopTree {
 public:
  /// k: 6, 14 (adds the corners of the cube), 18 (adds its edges) or 26 (adds both).
  ///
  /// Copies the required data and starts at rest. Throws std::invalid_argument for another k, and for the same input as
  /// Body. Cost: linear in the corners of the cover.
  KDopTree(const MeshView& mesh, const CoveredTree& model, int k, Workers& workers = serial_workers());
  ~KDopTree();
  KDopTree(KDopTree&&) noexcept;
  KDopTree& operator=(KDopTree&&) noexcept;

  /// Moves all nodes of all levels to the given positions: one per mesh vertex, in mesh order and units.
  ///
  /// Bounds are rounded outward, so rounding cannot lose an owned point. Returns the same status and rejects the same
  /// input as Body::update. Allocates nothing. The result has the same bits for any number of workers. Cost: linear in
  /// vertices + cut points + owned corners.
  UpdateStatus update(const PositionView& positions, Workers& workers = serial_workers()) noexcept;

  int k() const;
  std::size_t node_count() const;
  /// One direction per slab, k / 2 in all, with components −1, 0 or 1: not of unit length.
  std::span<const Vec3> directions() const;
  /// Bounds of a node, one per slab, mesh units × the length of the direction. The node is the set of x with lower[i] ≤
  /// directions()[i] · (x − origin()) ≤ upper[i] for all i. They must not be read during an update.
  std::span<const float> lower(std::uint32_t node) const;
  std::span<const float> upper(std::uint32_t node) const;
  Vec3 origin() const;
  /// Spheres around the k-DOPs' boxes, over the same tree, for queries: they cover. They are looser than a Body's,
  /// because a sphere encloses a box. They allow the same queries on k-DOPs as on bodies.
  PosedSpheres posed() const;
  /// Writes the spheres of the present frame into spheres of an earlier one. Allocates nothing.
  void pose(PosedSpheres& spheres) const;
  /// 64-bit FNV-1a over origin and bounds.
  std::uint64_t hash() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
