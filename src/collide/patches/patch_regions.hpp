// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The region of each of two bodies that lies inside the other, as oriented boundary pieces of its parts in facets; and
// the patches into which the regions fall.
//
// Let w be the winding number of body b. It is constant on a connected part of a's surface that the loops bound, and
// changes by LoopNode::jump at a node. For a facet F of a, the chain C(F) has, as pieces: each segment of F once, in
// its direction on F; and each part of an edge of F between neighboring nodes or ends, with the value of w there as
// weight. C(F) is the boundary of F weighted with w, and it is closed: at a node, the jump of w along the edge equals
// what the segment begins or ends. An edge's pieces are the same for its facets, in opposite directions, and a
// segment's are the same for F and the facet of b. So the sum of all chains of both bodies is 0, whatever the rounded
// points of nodes are, even if rounding exchanges nodes of an edge: then pieces between them get other weights, and
// their sum stays.
#pragma once

#include <cstdint>
#include <morula/collide/collider.hpp>
#include <span>
#include <utility>
#include <vector>

#include "collide/patches/closed_surface.hpp"
#include "collide/patches/contact_loops.hpp"
#include "collide/patches/facet_holes.hpp"
#include "geometry/disjoint_sets.hpp"

namespace morula::detail {

/// The part of a facet in one patch.
struct FacetPart {
  std::uint32_t patch, facet;
  std::uint32_t begin, end;  ///< its pieces; for a whole facet the three sides of the facet
};

/// One body's surface.
struct SurfaceRegion {
  const Collider* body;
  const ClosedSurface* surface;
  bool is_a;
  std::vector<BoundaryPiece> pieces;
  std::vector<FacetPart> parts;  ///< ascending by patch, then by facet

  void start(const Collider& collider, const ClosedSurface& closed, bool first);

  /// A facet that is wholly inside, and the winding number there.
  struct Whole {
    std::uint32_t facet;
    int winding;
  };
  // By vertex, edge, facet or component: the run that set the value last, and the value.
  std::vector<std::uint32_t> vertex_run, edge_run, facet_run, element_run, component_run;
  std::vector<int> winding;
  std::vector<std::uint32_t> element, edge_begin, edge_end;
  std::vector<std::uint8_t> is_cut;
  std::uint32_t now = 0;
  std::vector<std::uint32_t> edge_nodes;      // nodes of this body's edges, by edge, then along it
  std::vector<std::uint32_t> facet_segments;  // segments by this body's facet
  std::vector<std::uint32_t> queue;           // vertices whose winding number is known
  std::vector<Whole> wholes;

  std::span<const std::uint32_t> nodes_of(std::uint32_t edge) const {
    if (edge_run[edge] != now) return {};
    return std::span(edge_nodes).subspan(edge_begin[edge], edge_end[edge] - edge_begin[edge]);
  }
};

/// The patches of a pair of bodies.
class PatchRegions {
 public:
  SurfaceRegion side[2];
  /// Points about the origin: nodes of loops, then vertices of regions.
  std::vector<Vec3> points;
  std::size_t patch_count = 0;
  std::vector<std::size_t> crossing_counts;  ///< number of nodes by patch

  const Vec3& origin() const { return origin_; }

  /// Returns ok, or inside_out for a winding number below 0.
  Status find(const Collider& a, const ClosedSurface& surface_a, const Collider& b, const ClosedSurface& surface_b,
              const ContactLoops& loops, const Vec3& origin);

  std::uint32_t& patch_at(const BoundaryPiece& piece) { return patch_of_[sets_.root(piece.from)]; }

 protected:  // also for SelfRegions
  void sort_loops(SurfaceRegion& s, const ContactLoops& loops);
  bool find_windings(SurfaceRegion& s, const Collider& other, const ContactLoops& loops);
  bool spread(SurfaceRegion& s, const ContactLoops& loops, std::uint32_t vertex, int winding);
  void add_cut_facets(SurfaceRegion& s, const ContactLoops& loops);
  void add_edge(SurfaceRegion& s, const ContactLoops& loops, std::uint32_t facet, std::size_t k);
  void add_whole_facets(SurfaceRegion& s);
  void add_piece(SurfaceRegion& s, const BoundaryPiece& piece);
  std::uint32_t element_of(SurfaceRegion& s, std::uint32_t vertex);
  void join_holes(const SurfaceRegion& s, const FacetPart& part);
  void assign_patches(const ContactLoops& loops);
  void join_cavities();
  /// groups: number of values in patch_of_.
  void split_parts(SurfaceRegion& s, std::size_t groups);
  void number_patches();

  DisjointSets sets_{0};
  std::vector<std::uint32_t> patch_of_;  // by root
  ShiftedWinding location_;
  Vec3 origin_;
  // For sort_loops().
  struct NodeOfEdge {
    double along;
    std::uint32_t edge, facet, node;
  };
  std::vector<NodeOfEdge> nodes_of_edges_;
  std::vector<std::uint64_t> facet_keys_;
  // For number_patches() and split_parts().
  struct Lowest {
    std::uint32_t facet[2], patch;
  };
  std::vector<Lowest> lowest_;
  std::vector<std::uint32_t> number_;
  std::vector<std::size_t> counts_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order_;
  std::vector<BoundaryPiece> sorted_;
  FacetHoles holes_;
  std::vector<std::pair<double, double>> volumes_;  // by patch, with their rounding errors
};

}  // namespace morula::detail
