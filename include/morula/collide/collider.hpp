// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// One side of a collision query: a body, where it is, and what queries need of it beside its spheres.
#pragma once

#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/update/body.hpp>
#include <span>
#include <vector>

namespace morula {

/// Borrows mesh and body: both must outlive it, at the same addresses. Made once per body and ownership: a
/// RefittedBody needs another collider when its epoch changes.
class Collider {
 public:
  /// body must have been made from mesh. Throws std::invalid_argument when their sizes differ.
  /// Cost: linear in patches; memory 4 bytes per pair of leaf and facet.
  Collider(const Mesh& mesh, const Body& body);

  /// Where the body is from now on, on top of its deformation: x ↦ placement(x). Throws std::invalid_argument unless
  /// all is finite and deviation_from_rigid(placement) ≤ largest_rigid_deviation; nothing has changed then.
  void place(const RigidTransform& placement);
  const RigidTransform& placement() const { return placement_; }

  /// The positions that the body's last update was given. The view's data is borrowed until the next update; needed
  /// only by what looks at facets, and refused there when the body has been updated since. A body at rest that was
  /// never updated needs none: the mesh's serve. Throws std::invalid_argument for a wrong count.
  void set_positions(const PositionView& positions);
  /// In the body's own frame: as they were given, not placed.
  const PositionView& positions() const { return positions_; }
  /// Those of the body's present frame?
  bool has_current_positions() const { return positions_frame_ == body_->frame(); }

  const Body& body() const { return *body_; }
  const Mesh& mesh() const { return *mesh_; }

  /// Facets of which the node's region has a part. A leaf's are ascending, each once; an inner node's are those of the
  /// leaves below it, one leaf after the other.
  std::span<const std::uint32_t> facets(std::uint32_t node) const {
    return std::span(facets_).subspan(facet_begin_[node], facet_end_[node] - facet_begin_[node]);
  }
  /// A vertex where it is now: position, then placement, each rounded to double. These numbers are what exact verdicts
  /// are about.
  Vec3 vertex(std::uint32_t index) const { return placement_(positions_[index]); }
  Triangle triangle(std::uint32_t facet) const {
    const Facet& f = mesh_->facets[facet];
    return {vertex(f[0]), vertex(f[1]), vertex(f[2])};
  }

 private:
  const Mesh* mesh_;
  const Body* body_;
  RigidTransform placement_{};
  PositionView positions_;
  std::uint64_t positions_frame_ = 0;
  std::vector<std::uint32_t> facets_, facet_begin_, facet_end_;
};

}  // namespace morula
