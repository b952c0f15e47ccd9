// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The curves in which a closed surface crosses itself, in general position (self_predicates.hpp): nodes, where an edge
// passes through a facet, and oriented segments between them.
//
// Segments have the direction that contact_loops.hpp derives for two bodies; both facets are now of one surface. Facets
// with a common edge do not cross. Facets F and G with one common vertex v cross where the edge of one that is opposite
// to v passes through the other, in the segment from there to v: both meet the line of their planes in a segment that
// begins in v, and the shorter one ends on an edge. So curves are closed, or end in vertices whose fans cross
// themselves.
#pragma once

#include <cstdint>
#include <morula/collide/collider.hpp>
#include <span>
#include <vector>

#include "collide/patches/closed_surface.hpp"
#include "collide/patches/self_tree.hpp"
#include "geometry/exact_predicates.hpp"

namespace morula::detail {

/// A point where an edge passes through a facet, or a vertex in which a curve ends.
struct SelfNode {
  std::uint32_t edge;   ///< no_edge for a vertex
  std::uint32_t facet;  ///< or the vertex
  double along;         ///< position on the edge: 0 at its first vertex, 1 at its second
  int jump;             ///< 1 if the edge passes from the facet's outer to its inner side in the order of its vertices
  bool is_vertex() const { return edge == no_edge; }
};

/// The intersection of two facets, in direction (normal of facet_a) x (normal of facet_b).
struct SelfSegment {
  std::uint32_t facet_a, facet_b;
  std::uint32_t from, to;  ///< nodes
};

class SelfLoops {
 public:
  std::vector<Vec3> world;      ///< positions of all vertices
  std::vector<SelfNode> nodes;  ///< ascending by edge, then by facet
  std::vector<Vec3> points;     ///< of nodes, about the origin
  std::vector<SelfSegment> segments;
  Vec3 origin;

  /// tree: of the body's facets; brought up to date.
  void find(const Collider& body, const ClosedSurface& surface, SelfTree& tree);

 private:
  struct FacetPair;
  struct End {
    SelfNode node;
    std::uint32_t segment;
    bool is_to;
  };
  void find_pointed_fans();
  void test_fan(std::uint32_t vertex);
  void test(std::uint32_t facet_a, std::uint32_t facet_b, std::uint32_t common);
  SelfNode node_of(const FacetPair& pair, std::size_t side, std::size_t k, std::size_t next) const;
  void number_nodes();

  const Collider* body_ = nullptr;
  const ClosedSurface* surface_ = nullptr;
  std::vector<End> ends_;
  // By vertex: the sum of its facets' area vectors, and what find_pointed_fans() knows of its fan.
  struct Fan {
    Vec3 normal;
    std::uint32_t upward = 0;
    bool is_pointed = false;
  };
  std::vector<Fan> fans_;
};

}  // namespace morula::detail
