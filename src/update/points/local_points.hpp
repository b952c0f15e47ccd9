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

class LocalPoints {
 public:
  LocalPoints(const MeshView& rest, const Cover& cover, const Ownership& ownership);

  struct Frame {
    bool finite = true;                ///< otherwise the points are of no use and nothing else here is set
    std::size_t first_bad_vertex = 0;  ///< lowest mesh vertex that is not finite or out of range
    Vec3 origin;
    Rounding rounding;
  };
  /// Reads every used vertex once and moves the cut points. Afterwards points() belongs to the frame returned.
  Frame move(const PositionView& positions, Workers& workers) noexcept;

  /// Would these positions have the origin of the frame before? Then what did not move need not be read again.
  bool keeps_origin(const PositionView& positions) const noexcept { return origin_of(positions) == origin_; }
  /// The same frame as move() where only vertices in these ranges differ from the frame before, which was finite and
  /// had this origin. Cost: what is in the ranges, and a few operations per block of the rest.
  Frame move_changed(const PositionView& positions, std::span<const VertexRange> changed) noexcept;
  /// Blocks of vertices that the last move_changed was told of, how many vertices it read and cut points it moved.
  const Marks& changed_blocks() const { return changed_blocks_; }
  std::size_t changed_vertices() const { return changed_vertices_; }
  std::size_t changed_cut_points() const { return changed_cut_points_; }
  std::size_t block_count() const { return (vertex_count_ + vertices_per_block - 1) / vertices_per_block; }
  /// visit(block) for each that a point depends on: its own, or those of a cut point's vertices.
  template <class Visit>
  void each_block(std::uint32_t point, const Visit& visit) const {
    constexpr auto block = static_cast<std::uint32_t>(vertices_per_block);
    if (point < vertex_count_) return visit(point / block);
    const std::size_t cut = point - vertex_count_;
    if (cut < edge_cuts_.size()) {
      for (const std::uint32_t p : edge_cuts_[cut].point) visit(p / block);
    } else {
      for (const std::uint32_t p : inner_cuts_[cut - edge_cuts_.size()].point) visit(p / block);
    }
  }

  /// Where origin_near() puts the origin at rest from, and the size it is given.
  const Vec3& rest_origin() const { return rest_origin_; }
  double size() const { return size_; }

  /// Vertices in the ownership's order, then cut points.
  std::span<const LocalPoint> points() const { return points_; }
  std::size_t vertex_count() const { return vertex_count_; }
  std::size_t cut_point_count() const { return edge_cuts_.size() + inner_cuts_.size(); }
  /// Point of a mesh vertex that facets use.
  std::uint32_t point_of(std::uint32_t vertex) const { return mesh_order_ ? vertex : point_of_[vertex]; }

 private:
  static constexpr std::uint32_t no_point = 0xffffffffu;
  /// Do facets use the vertex?
  bool is_used(std::size_t vertex) const {
    return mesh_order_ ? vertex < vertex_count_ : point_of_[vertex] != no_point;
  }
  std::size_t first_bad_vertex(const PositionView& positions, const Vec3& origin) const noexcept;
  Vec3 origin_of(const PositionView& positions) const noexcept;
  void mark(const VertexRange& range) noexcept;
  void narrow_stretch(const PositionView& positions, std::size_t stretch) noexcept;
  Frame finished_frame(const PositionView& positions) const noexcept;
  void move_cut_points(Workers& workers) noexcept;
  void move_cuts(std::size_t begin, std::size_t end) noexcept;

  std::size_t vertex_count_;
  bool mesh_order_;                      // point i is mesh vertex i; the next is empty then
  std::vector<std::uint32_t> point_of_;  // of each vertex of the mesh; no_point where no facet uses it
  // The first point has the largest weight; each other one is `weight` of the way from it.
  std::vector<EdgeCut> edge_cuts_;    // points vertex_count_ …
  std::vector<InnerCut> inner_cuts_;  // … and after those
  std::vector<LocalPoint> points_;
  // Vertices that are narrowed at once: those of the mesh that facets use, in its order. Of each stretch the largest
  // |coordinate|; infinity when something in it is not finite.
  std::vector<VertexRange> stretches_;
  std::vector<float> stretch_largest_;
  BlockLists cuts_of_block_;
  Marks changed_stretches_, changed_blocks_, changed_cuts_;
  std::size_t changed_vertices_ = 0, changed_cut_points_ = 0;
  Vec3 origin_;       // of the last frame
  Vec3 rest_origin_;  // the center of the rest box
  Vec3 guide_rest_;   // the vertex that the origin moves with
  std::uint32_t guide_ = 0;
  double weight_slack_ = 0;
  double size_ = 0;  // of the rest box, its largest side
};

}  // namespace morula::detail
