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
class SurfaceTree;

namespace detail {
struct SurfaceTreeState;
const SurfaceTreeState& state_of(const SurfaceTree& surface);
}  // namespace detail

/// A hierarchy of boxes, eight per node, over whole facets, eight per bottom node. It needs no sphere tree.
/// ProximityQuery, SweptQuery and SurfaceCrossingQuery use it.
///
/// Every edge and every vertex belongs to one bottom node with one of its facets, so a pair of features is found at
/// exactly one pair of bottom nodes. Boxes of bottom nodes and above follow every update; boxes of single facets, edges
/// and vertices are made when a query needs them.
class SurfaceTree {
 public:
  /// Sorts the facets by the given positions, and starts there. Copies the required data.
  ///
  /// rest: a mesh at rest; filters for distances at rest use its positions. Throws std::invalid_argument, naming the
  /// first offender, for meshes that require_usable() and require_usable_scale() reject. Cost: O(F log F) time, about
  /// 180 bytes per facet; PairFilter lists the memory of filters.
  explicit SurfaceTree(const MeshView& rest);
  /// A query on the surface keeps its memory until its next run; results and open() stay readable. After destruction
  /// and assignment resume() is rejected with other_frame.
  ~SurfaceTree();
  SurfaceTree(SurfaceTree&&) noexcept;
  SurfaceTree& operator=(SurfaceTree&&) noexcept;

  /// Moves the surface to the given positions: one per vertex, mesh units, in the world.
  ///
  /// The view's data is borrowed until the next update: queries read positions there. Rejected, with no change:
  /// wrong_vertex_count; non_finite_position for a vertex of a facet that is not finite or farther than 2^102 from the
  /// middle of the surface at rest. Allocates nothing. The result has the same bits for any number of workers. Cost:
  /// linear.
  Status update(const PositionView& positions, Workers& workers = serial_workers());
  /// Moves the surface to a step: vertex i moves from from[i] to to[i] on a straight line, in time 0 to 1. Boxes
  /// contain both ends.
  Status update(const PositionView& from, const PositionView& to, Workers& workers = serial_workers());

  /// Moves the surface to the present positions and the transform of a body. This call computes nothing; a query makes
  /// the boxes it needs for itself. For two surfaces that follow covering bodies, these are the boxes of blocks at
  /// which spheres of one body are near spheres of the other; in all other cases, those of all blocks. The query finds
  /// the same pairs as after an update. So a body without contact costs only the update of its spheres.
  ///
  /// The collider must be made from this surface's mesh; only its sphere state, transform and positions are borrowed,
  /// until the next update or follow. After a motion of the body, queries are rejected with surface_not_current.
  /// Rejected, with no change: colliders that askable() rejects; wrong_vertex_count; non_finite_position as in update.
  /// Throws std::invalid_argument for a body of other facets. Cost: none; linear for the first collider, for a collider
  /// with another cover, and in every frame for a body that does not cover. Allocates only in the first two cases.
  Status follow(const Collider& body);
  bool is_following() const;

  bool is_step() const;
  std::size_t vertex_count() const;
  std::span<const Facet> facets() const;
  /// Each pair of adjacent vertices of a facet, lower first; ascending. Facets with a repeated index also have edges.
  std::span<const std::array<std::uint32_t, 2>> edges() const;
  /// Number of vertices of facets whose rest position is that of an earlier one. Not 0 for a mesh in which adjacent
  /// facets do not share vertices, such as a glTF with hard edges or texture coordinates: queries of the surface with
  /// itself find pairs at distance 0 there. read_mesh() with a weld and weld_vertices() merge them. Cost: linear for
  /// the first call, none for later ones.
  std::size_t duplicate_vertices() const;
  /// Position of a vertex: at the beginning of a step, at its end, and at rest.
  Vec3 from(std::uint32_t vertex) const;
  Vec3 to(std::uint32_t vertex) const;
  Vec3 rest(std::uint32_t vertex) const;

  /// 64-bit FNV-1a over the boxes of all nodes. Throws std::invalid_argument if the body that the surface follows has
  /// moved.
  std::uint64_t hash() const;

 private:
  friend const detail::SurfaceTreeState& detail::state_of(const SurfaceTree& surface);
  std::shared_ptr<detail::SurfaceTreeState> state_;
};

}  // namespace morula
