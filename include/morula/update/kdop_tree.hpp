// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// k-DOPs, such as axis-aligned boxes, instead of spheres: for comparison, over the same tree and the same regions.
#pragma once

#include <morula/update/body.hpp>

namespace morula {

/// A mesh with its tree and cover, whose nodes have k-DOPs instead of spheres [klosowski1998]. A k-DOP is the
/// intersection of k / 2 slabs of fixed directions; a slab is the space between two parallel planes. A 6-DOP is an
/// axis-aligned box.
///
/// In every frame the k-DOP of every node contains the patches that the node owns, like the spheres of a Body with the
/// rule `exact`: it contains their corners, and k-DOPs are convex. The bounds of an inner node are the least and the
/// largest of its children's. They are as tight as bounds computed from the node's own corners; a sphere around child
/// spheres is looser than a sphere around the corners. [klosowski1998] updates k-DOPs of rigid bodies that rotate; this
/// class computes them from the positions of each frame.
class KDopTree {
 public:
  /// k: 6 (directions of the three axes), 14 (also those through the corners of a cube), 18 (through the middles of its
  /// edges instead) or 26 (through both).
  ///
  /// Copies the required data and starts at rest. Throws std::invalid_argument for another k; if mesh and model do not
  /// belong together; and for coordinates that Body rejects. Cost: linear in the corners of the cover.
  KDopTree(const MeshView& mesh, const CoveredTree& model, int k, Workers& workers = serial_workers());
  ~KDopTree();
  KDopTree(KDopTree&&) noexcept;
  KDopTree& operator=(KDopTree&&) noexcept;

  /// Updates the k-DOPs of all nodes to the given positions: one per mesh vertex, in mesh order and units.
  ///
  /// Bounds are rounded outward, so rounding cannot lose a point that a node owns. Rejects another number of positions
  /// and the coordinates that Body::update() rejects; the last good bounds then stay. Allocates nothing. The result has
  /// the same bits for any number of workers. Cost: linear in vertices + cut points + owned corners.
  UpdateStatus update(const PositionView& positions, Workers& workers = serial_workers()) noexcept;

  /// Number of planes of a k-DOP: twice the number of slabs.
  int k() const;
  std::size_t node_count() const;
  /// The direction of each slab, k / 2 in all. Components are −1, 0 or 1, so a direction is 1, √2 or √3 long.
  std::span<const Vec3> directions() const;
  /// The lower bounds of a node, one per slab, mesh units × length of the direction. The node's k-DOP is the set of
  /// points x with lower(node)[i] ≤ directions()[i] · (x − origin()) ≤ upper(node)[i] for all i. Do not read bounds
  /// during an update.
  std::span<const float> lower(std::uint32_t node) const;
  /// The upper bounds of a node, like lower().
  std::span<const float> upper(std::uint32_t node) const;
  /// The origin of the bounds, in mesh coordinates; updates move it with the body.
  Vec3 origin() const;
  /// Spheres over the same tree for the queries that take bodies: each is the sphere around the axis-aligned box of a
  /// node's k-DOP, so they cover. They are looser than the spheres of a Body. Only one thread may call posed() or
  /// pose() at a time.
  PosedSpheres posed() const;
  /// Updates the result of an earlier posed() of this tree to the present frame. Allocates nothing.
  void pose(PosedSpheres& spheres) const;
  /// 64-bit FNV-1a over origin and all bounds: equal for equal bits.
  std::uint64_t hash() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
