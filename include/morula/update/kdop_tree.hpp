// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes and k-DOPs in the place of spheres: the same tree, the same ownership, for comparison.
#pragma once

#include <morula/update/body.hpp>

namespace morula {

/// A mesh with its tree and cover, whose nodes have k-DOPs instead of spheres [klosowski1998]: k / 2 slabs of fixed
/// directions, between which everything lies that the node owns. 6-DOPs are axis-aligned boxes.
///
/// As with Body and its rule `exact`, every node contains the patches that it owns, in every frame: slabs are convex.
/// Other than spheres, an inner node is exactly the union of its children. [klosowski1998] tumbles slabs of rigid
/// bodies along their hulls; here they are made anew from the positions of each frame.
class KDopTree {
 public:
  /// k: 6, 14 (and the corners of the cube), 18 (and its edges) or 26 (both).
  ///
  /// Copies what it needs and starts at rest. Throws std::invalid_argument for another k and where Body does.
  /// Cost: linear in the corners of the cover.
  KDopTree(const MeshView& mesh, const CoveredTree& model, int k, Workers& workers = serial_workers());
  ~KDopTree();
  KDopTree(KDopTree&&) noexcept;
  KDopTree& operator=(KDopTree&&) noexcept;

  /// Moves all nodes of all levels to the given positions: one per mesh vertex, in mesh order and units.
  ///
  /// Bounds are rounded outwards, so rounding cannot lose an owned point. The same status, and the same refusals, as
  /// Body::update. No allocation. Same bits for any number of workers. Cost: linear in vertices + cut points + owned
  /// corners.
  UpdateStatus update(const PositionView& positions, Workers& workers = serial_workers()) noexcept;

  int k() const;
  std::size_t node_count() const;
  /// One per slab, k / 2 in all, components −1, 0 or 1: not of unit length.
  std::span<const Vec3> directions() const;
  /// Bounds of a node, one per slab. It is where lower[i] ≤ directions()[i] · (x − origin()) ≤ upper[i] for all i, mesh
  /// units × the length of the direction. Read them between updates.
  std::span<const float> lower(std::uint32_t node) const;
  std::span<const float> upper(std::uint32_t node) const;
  Vec3 origin() const;
  /// Spheres around the k-DOPs' boxes, over the same tree, as queries ask them: they cover. Looser than a Body's, since
  /// a sphere around a box is; what they are for is asking k-DOPs the questions that bodies are asked.
  PosedSpheres posed() const;
  /// The same for the present frame, into those of an earlier one. No allocation.
  void pose(PosedSpheres& spheres) const;
  /// 64-bit FNV-1a over origin and bounds.
  std::uint64_t hash() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
