// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres, boxes and k-DOPs over one tree and one cover, so that they can be compared.
#pragma once

#include <memory>
#include <morula/geometry/box.hpp>
#include <morula/update/body.hpp>
#include <string>
#include <vector>

namespace morula::bench {

/// What comes of walking down two trees side by side.
struct Pairs {
  std::size_t tests = 0;            ///< pairs of nodes that were looked at
  std::size_t touching_leaves = 0;  ///< pairs of leaves that overlap
  bool operator==(const Pairs&) const = default;
};

/// One bounding volume for every node of a tree, following the vertices.
class Volumes {
 public:
  virtual ~Volumes() = default;
  virtual UpdateStatus update(const PositionView& positions, Workers& workers) = 0;
  virtual std::uint64_t hash() const = 0;
  /// Does every node contain every corner that it owns?
  virtual bool covers(const PositionView& positions) const = 0;
  virtual bool contains(std::uint32_t node, const Vec3& point) const = 0;
  virtual Box box(std::uint32_t node) const = 0;
  virtual std::size_t bytes_per_node() const = 0;
  /// other: of the same kind, for the same tree. Pairs of nodes that overlap are divided, from the two roots down: the
  /// node of the upper level, of equals this tree's.
  virtual Pairs traverse(const Volumes& other) const = 0;
  /// Pairs of leaves that overlap, by trying all of them.
  virtual std::size_t touching_leaves(const Volumes& other) const = 0;
  /// Do inner nodes contain their children? Then traversal misses no pair of leaves that overlap; else it may pass over
  /// some whose parts of the surface are apart all the same.
  virtual bool is_nested() const = 0;
};

struct VolumeKind {
  std::string name;
  std::unique_ptr<Volumes> (*make)(const Mesh&, const CoveredTree&);  ///< keeps a reference to CoveredTree
};
/// Spheres by `exact` and by approach 2, boxes, 14-, 18- and 26-DOPs.
const std::vector<VolumeKind>& volume_kinds();

/// Volume inside some node and outside the object over the object's volume, by the points of a cubic lattice.
class SharedLattice {
 public:
  /// resolution: points along the longest side of `box`.
  SharedLattice(const Box& box, int resolution, const MeshView& mesh, Workers& workers);
  double looseness(const Volumes& volumes, std::span<const std::uint32_t> nodes) const;

 private:
  Vec3 point(int i, int j, int k) const;
  std::size_t number(int i, int j, int k) const;

  Vec3 first_;
  double edge_;
  std::array<int, 3> size_;
  std::vector<std::uint8_t> inside_;
  std::size_t inside_count_ = 0;
};

}  // namespace morula::bench
