// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The points of a body about an origin that moves with it: the caller's positions narrowed to float, and cut points.
#pragma once

#include <morula/geometry/positions.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/tree/cover.hpp>
#include <vector>

#include "simd/float4.hpp"
#include "update/points/block_lists.hpp"
#include "update/points/kernels.hpp"
#include "update/points/marks.hpp"
#include "update/points/ownership.hpp"
#include "update/points/rounding.hpp"

namespace morula::detail {

/// The point of each mesh vertex: the ownership's numbers, and their inverse if it is not the identity.
class VertexNumbers {
 public:
  /// vertices: the mesh vertex of each point, as in Ownership.
  VertexNumbers(std::size_t mesh_vertex_count, std::span<const std::uint32_t> vertices);

  std::size_t count() const { return count_; }
  /// Point i is mesh vertex i.
  bool is_mesh_order() const { return point_of_.empty(); }
  /// Whether facets use the vertex.
  bool is_used(std::size_t vertex) const { return is_mesh_order() ? vertex < count_ : point_of_[vertex] != no_point; }
  /// Point of a vertex that facets use.
  std::uint32_t point_of(std::uint32_t vertex) const { return is_mesh_order() ? vertex : point_of_[vertex]; }
  /// Points of the vertices from this one on; not in the mesh's order.
  const std::uint32_t* points_from(std::uint32_t vertex) const { return &point_of_[vertex]; }

 private:
  static constexpr std::uint32_t no_point = 0xffffffffu;
  std::size_t count_;
  std::vector<std::uint32_t> point_of_;  // empty in the mesh's order; no_point for a vertex that no facet uses
};

/// Inputs of the computation of every frame's origin; the constructor of LocalPoints fills them, at rest.
struct OriginGuide {
  std::uint32_t vertex = 0;  ///< vertex that the origin moves with
  Vec3 vertex_rest;
  Vec3 rest_origin;  ///< center of the rest box: the argument of origin_near() for the origin at rest
  double size = 0;   ///< largest side of the rest box: the size for origin_near()

  Vec3 origin_of(const PositionView& positions) const noexcept;
};

/// Dependence of cut points on vertices; the constructor of LocalPoints fills it. The first point of each has the
/// largest weight; each other one is `weight` of the way from it.
struct LocalCuts {
  std::vector<EdgeCut> on_edges;    ///< cut points on edges: the points behind the vertices …
  std::vector<InnerCut> in_facets;  ///< cut points in facets: … and those behind these
  BlockLists of_block;              ///< cuts that depend on a block of vertices
  double weight_slack = 0;          ///< Rounding::weight_slack of the whole cover

  std::size_t size() const { return on_edges.size() + in_facets.size(); }
};

/// The set of changes of a partial update; each LocalPoints::move_changed() clears it first.
struct ChangedPoints {
  Marks stretches, blocks, cuts;
  std::size_t vertices = 0, cut_points = 0;  ///< numbers of vertices read and cut points moved

  void clear() noexcept {
    stretches.clear(), blocks.clear(), cuts.clear();
    vertices = cut_points = 0;
  }
};

class LocalPoints {
 public:
  LocalPoints(const MeshView& rest, const Cover& cover, const Ownership& ownership);

  struct Frame {
    bool finite = true;                ///< false: the points are meaningless and no other member is set
    std::size_t first_bad_vertex = 0;  ///< lowest mesh vertex that is not finite or out of range
    Vec3 origin;
    Rounding rounding;
  };
  /// Reads every used vertex once and moves the cut points. Afterwards points() belongs to the returned frame.
  Frame move(const PositionView& positions, Workers& workers) noexcept {
    return move_about(guide_.origin_of(positions), positions, workers);
  }
  /// The same about a given origin.
  Frame move_about(const Vec3& origin, const PositionView& positions, Workers& workers) noexcept;

  /// Whether these positions have the origin of the last frame. Then vertices that did not move need no second read.
  bool keeps_origin(const PositionView& positions) const noexcept { return guide_.origin_of(positions) == origin_; }
  /// Moves to the same frame as move() if only vertices in these ranges differ from the last frame, which must be
  /// finite and have this origin. Cost: linear in the ranges, and a few operations per block of the rest.
  Frame move_changed(const PositionView& positions, std::span<const VertexRange> changed) noexcept;
  /// Blocks of the vertices in the ranges of the last move_changed, and how many vertices it read and cut points it
  /// moved.
  const Marks& changed_blocks() const { return changed_.blocks; }
  std::size_t changed_vertices() const { return changed_.vertices; }
  std::size_t changed_cut_points() const { return changed_.cut_points; }
  std::size_t block_count() const { return (vertex_count() + vertices_per_block - 1) / vertices_per_block; }
  /// Calls visit(block) for each block that a point depends on: its own, or those of a cut point's vertices.
  template <class Visit>
  void each_block(std::uint32_t point, const Visit& visit) const {
    constexpr auto block = static_cast<std::uint32_t>(vertices_per_block);
    if (point < vertex_count()) return visit(point / block);
    const std::size_t cut = point - vertex_count();
    if (cut < cuts_.on_edges.size()) {
      for (const std::uint32_t p : cuts_.on_edges[cut].point) visit(p / block);
    } else {
      for (const std::uint32_t p : cuts_.in_facets[cut - cuts_.on_edges.size()].point) visit(p / block);
    }
  }

  /// Arguments of origin_near() for the origin at rest: the center of the rest box, and its size.
  const Vec3& rest_origin() const { return guide_.rest_origin; }
  double size() const { return guide_.size; }

  /// Vertices in the ownership's order, then cut points.
  std::span<const LocalPoint> points() const { return points_; }
  std::size_t vertex_count() const { return numbers_.count(); }
  std::size_t cut_point_count() const { return cuts_.size(); }
  /// Point of a mesh vertex that facets use.
  std::uint32_t point_of(std::uint32_t vertex) const { return numbers_.point_of(vertex); }

 private:
  // Steps of the constructor, in this order: blocks are listed from cuts and numbers.
  void add_stretches(std::size_t mesh_vertex_count);
  void add_cuts(const Cover& cover, const Ownership& ownership);
  void list_cuts_of_blocks();
  std::size_t first_bad_vertex(const PositionView& positions, const Vec3& origin) const noexcept;
  void mark(const VertexRange& range) noexcept;
  void narrow_stretch(const PositionView& positions, std::size_t stretch) noexcept;
  Frame finished_frame(const PositionView& positions) const noexcept;
  void move_cut_points(Workers& workers) noexcept;
  void move_cuts(std::size_t begin, std::size_t end) noexcept;

  VertexNumbers numbers_;
  LocalCuts cuts_;
  OriginGuide guide_;
  // Vertices that are narrowed at once: those of the mesh that facets use, in its order. The largest |coordinate| of
  // each stretch; infinity if a coordinate in it is not finite.
  std::vector<VertexRange> stretches_;
  std::vector<float> stretch_largest_;
  // Points of the last frame.
  std::vector<LocalPoint> points_;
  Vec3 origin_;
  ChangedPoints changed_;
};

}  // namespace morula::detail
