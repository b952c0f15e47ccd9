// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Surface tree: boxes over the facets, edges and vertices of a mesh, for pairs of features of deforming surfaces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <morula/geometry/mesh_view.hpp>
#include <morula/geometry/status.hpp>
#include <morula/parallel/workers.hpp>
#include <optional>
#include <span>

namespace morula {

class Collider;

namespace detail {
struct SurfaceTreeState;
}

/// A hierarchy of boxes, eight to a node, over whole facets, eight to a bottom node. It needs no sphere tree. Queries
/// of features ask it: ProximityQuery, SweptQuery, SurfaceCrossingQuery.
///
/// Every edge and every vertex belongs to one bottom node that has a facet with it, so a pair of features is found
/// where two bottom nodes meet, and nowhere twice. Boxes of bottom nodes and above follow every update; those of single
/// facets, edges and vertices are made where a query goes.
class SurfaceTree {
 public:
  /// Sorts the facets by the given positions, and starts there. Copies what it needs.
  ///
  /// rest: a mesh at rest. Its positions stay known for filters that ask for distances at rest. Throws
  /// std::invalid_argument, naming the first offender, where require_usable() and require_usable_scale() do.
  /// Cost: O(F log F) time, some 180 bytes per facet; PairFilter has the memory of what filters add.
  explicit SurfaceTree(const MeshView& rest);
  /// A query that stands at the surface keeps its memory until it is asked again; results and open() stay readable.
  /// resume() is refused with other_frame, here and where another surface is assigned.
  ~SurfaceTree();
  SurfaceTree(SurfaceTree&&) noexcept;
  SurfaceTree& operator=(SurfaceTree&&) noexcept;

  /// Moves the surface to the given positions: one per vertex, mesh units, in the world.
  ///
  /// The view's data is borrowed until the next update: queries read positions there. Refused, with nothing changed:
  /// wrong_vertex_count; non_finite_position for a vertex that a facet uses and that is not finite or farther than
  /// 2^102 from the middle of the surface at rest. No allocation. Same bits for any number of workers. Cost: linear.
  Status update(const PositionView& positions, Workers& workers = serial_workers());
  /// Moves it to a step: vertex i goes from from[i] to to[i] on a straight line, in time 0 to 1. Boxes hold both ends.
  Status update(const PositionView& from, const PositionView& to, Workers& workers = serial_workers());

  /// Puts the surface where a body is: its positions, placed. Nothing is computed here. A query that then asks this
  /// surface makes the boxes it needs, for itself: of two surfaces that follow bodies which cover, those of blocks
  /// where spheres of one body are near spheres of the other; in all other cases those of all blocks. It finds the
  /// pairs that it finds after an update. So a body that touches nothing costs its update of spheres alone.
  ///
  /// The collider must have been made from this surface's mesh; only its pose, transform and positions are borrowed,
  /// until the next update or follow. Once the body has moved, queries refuse with surface_not_current. Refused, with
  /// nothing changed: what askable() refuses; wrong_vertex_count; non_finite_position as in update. Throws
  /// std::invalid_argument for a body of other facets. Cost: none; linear for the first collider, for one of another
  /// ownership, and in every frame for a body that does not cover. No allocation but for the first two.
  Status follow(const Collider& body);
  bool is_following() const;

  bool is_step() const;
  std::size_t vertex_count() const;
  std::span<const Facet> facets() const;
  /// Each pair of vertices that some facet has, lower first; ascending. Facets with a repeated index have edges, too.
  std::span<const std::array<std::uint32_t, 2>> edges() const;
  /// Where a vertex is: at the beginning of a step, at its end, and at rest.
  Vec3 from(std::uint32_t vertex) const;
  Vec3 to(std::uint32_t vertex) const;
  Vec3 rest(std::uint32_t vertex) const;

  /// 64-bit FNV-1a over the boxes of all nodes. Throws std::invalid_argument where a body that it follows has moved.
  std::uint64_t hash() const;
  const detail::SurfaceTreeState& state() const { return *state_; }

 private:
  std::shared_ptr<detail::SurfaceTreeState> state_;
};

}  // namespace morula
