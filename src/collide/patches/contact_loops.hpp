// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The loops in which two closed surfaces cross, in general position: nodes, where an edge of one body passes through a
// facet of the other, and oriented segments between them.
//
// Let F be a facet of a with normal n, G one of b with normal m, and d = n x m. The part of F inside b lies where the
// points are behind G, in direction -m + n (n . m) = n x d: to the left of d. So the boundary of that part, which runs
// counter-clockwise about n, contains the segment F ∩ G in the direction d. By symmetry, the boundary of the part of G
// inside a contains it in the direction -d. An edge of F that goes into b along this boundary begins a piece of it, so
// the segment ends there, and it begins where an edge of F leaves b; for edges of G and body a it is the other way.
#pragma once

#include <cstdint>
#include <morula/collide/collider.hpp>
#include <span>
#include <vector>

#include "collide/facets/facet_crossings.hpp"
#include "collide/patches/closed_surface.hpp"
#include "geometry/exact_predicates.hpp"

namespace morula::detail {

/// A point where an edge of one body passes through a facet of the other.
struct LoopNode {
  std::uint32_t edge, facet;
  double along;       ///< position on the edge: 0 at its first vertex, 1 at its second
  int jump;           ///< 1 if the edge goes into the other body in the order of its vertices, -1 if it comes out
  std::uint8_t side;  ///< 0 for an edge of a, 1 for an edge of b
};

/// The intersection of two facets, in direction (normal of facet_a) x (normal of facet_b).
struct LoopSegment {
  std::uint32_t facet_a, facet_b;
  std::uint32_t from, to;  ///< nodes
};

/// Finds the node of an edge and a facet.
class LoopNodeTable {
 public:
  void clear();
  /// The place of the node's index; `none` in it if the node is new.
  std::uint32_t& operator[](std::uint64_t key);
  static constexpr std::uint32_t none = 0xffffffffu;

 private:
  struct Slot {
    std::uint64_t key;
    std::uint32_t batch, node;
  };
  void grow();
  Slot& slot_of(std::uint64_t key);

  std::vector<Slot> slots_ = std::vector<Slot>(1024, Slot{0, 0, none});
  std::uint32_t now_ = 1;
  std::size_t used_ = 0;
};

class ContactLoops {
 public:
  std::vector<LoopNode> nodes;
  std::vector<Vec3> points;           ///< of nodes, about the origin
  std::vector<LoopSegment> segments;  ///< ascending by facet_a, then by facet_b

  /// pairs: all pairs of facets with a common point, ascending. Pairs that only touch have no segment. meter: null: no
  /// limit. Returns false if its time ends the call.
  bool find(const Collider& a, const ClosedSurface& surface_a, const Collider& b, const ClosedSurface& surface_b,
            std::span<const FacetPairKey> pairs, const Vec3& origin, Meter* meter);

 private:
  struct FacetPair;
  void add(const FacetPair& pair);
  std::uint32_t node(const FacetPair& pair, std::size_t side, std::size_t k, std::size_t next);

  LoopNodeTable table_[2];  // by side
  Vec3 origin_;
};

}  // namespace morula::detail
