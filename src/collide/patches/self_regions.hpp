// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The region of a closed surface that lies inside itself, as oriented boundary pieces of its parts in facets; and the
// patches and sides into which it falls.
//
// Let w be the winding number in space. Across the surface, along the outer normal, it falls from w + 1 to w, so
// w (w - 1) / 2 falls by w, the number outside. By the divergence theorem, for the vector field F with div F = 1,
//   integral of w (w - 1) / 2 over space = integral of (number outside) F . n over the surface
// and, as in patch_integrals.hpp, when vertices move, the number outside times the normal motion is the change per
// area: the derivative with respect to a vertex is the integral of (number outside) L n. So with the number outside as
// weight, the chains of patch_regions.hpp, and all sums over their pieces, are those of the self-overlap: a segment of
// F and G belongs to the chain of F in its direction, since outside F the number is larger by 1 behind G, and to that
// of G in the opposite direction; the sum of all chains is 0. The formulas hold for numbers below 0, too: there
// w (w - 1) / 2 counts the overlap of the outside with itself, of which 1 - w is the winding number.
//
// A curve that ends in a vertex v: the number outside changes around v. In each facet it is known at the edges, and
// the segments that end in v add up to the difference.
#pragma once

#include <morula/collide/contact_patches.hpp>
#include <vector>

#include "collide/patches/patch_regions.hpp"
#include "collide/patches/self_loops.hpp"
#include "collide/patches/self_winding.hpp"

namespace morula::detail {

/// A closed surface, and an edge of each of its parts that are connected by edges.
struct SelfSurface {
  explicit SelfSurface(const Collider& body);
  ClosedSurface closed;
  Components parts;                      ///< by edges
  std::vector<std::uint32_t> part_edge;  ///< no_edge for a facet without edges
  SelfTree tree;
};

/// side[0] and side[1] are the two sides of the patches. Both lie on one body.
class SelfRegions : public PatchRegions {
 public:
  /// The facets of both sides of an earlier result, each in any order. A side continues one with which it has more
  /// facets in common.
  struct Earlier {
    std::span<const PatchFacet> a, b;
  };
  void find(const Collider& body, const SelfSurface& surface, const SelfLoops& loops, const Earlier& earlier);

 private:
  struct Incidence {
    std::uint32_t facet, segment;
  };
  void start(const SelfLoops& loops);
  void sort(const SelfLoops& loops);
  void find_numbers(const SelfSurface& surface, const SelfLoops& loops);
  void spread(const SelfLoops& loops, std::uint32_t edge, int number);
  std::uint32_t on_sheet(const SelfLoops& loops, std::uint32_t node, std::uint32_t facet) const;
  std::span<const Incidence> segments_of(std::uint32_t facet) const;
  int step_at(const SelfLoops& loops, std::uint32_t facet, std::uint32_t vertex) const;
  int jumps_of(const SelfLoops& loops, std::uint32_t edge) const;
  void add_cut_facets(const SelfLoops& loops);
  void add_edge(const SelfLoops& loops, std::uint32_t facet, std::size_t k);
  void assign_patches(const SelfLoops& loops);
  void choose_sides(const Earlier& earlier);
  void distribute();

  std::vector<Incidence> incidences_;      // ascending
  std::vector<std::uint32_t> cut_begin_;   // by cut facet: its first incidence
  std::vector<std::uint32_t> number_run_;  // by edge: the run that has set its number
  std::vector<int> number_;                // outside the edge at its first vertex
  // Two elements for each of the sets: sets are on different sides if the first of one is joined with the second of
  // the other; then the elements 2 r and 2 r + 1 of a patch that has no sides are joined.
  DisjointSets sides_{0};
  std::vector<std::uint8_t> side_of_;       // by root
  std::vector<std::uint8_t> has_no_sides_;  // by root
  std::vector<std::int32_t> earlier_;       // by facet: parts on a's side less parts on b's
};

}  // namespace morula::detail
