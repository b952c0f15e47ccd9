// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Height fields: regions of a surface that cannot cross themselves, because along an axis they lie over a plane once.
//
// Claim: let all facets of a region with a border (tree_state.hpp) run counter-clockwise when one coordinate is
// dropped, all of them strictly; let no two edges of the border touch there except at a vertex that they share; if
// loops pass a vertex more than once, let the sectors on their left have no direction in common; and let no loop that
// runs counter-clockwise lie within another that does. Then no two facets of the region that share no vertex have a
// common point.
//
// Proof. Let q be a point of the plane on no projected edge, and N(q) the number of projected facets that it is in.
// Each winds round q once or not at all, counter-clockwise. Inner edges are traversed once in each direction, so the
// loops of the border together wind round q N(q) times. If they pass a vertex more than once, let them take a short
// cut: along an arc about the vertex within the sector on their left, as near as q allows. The sectors have no
// direction in common, so the arcs do not touch, and all loops are simple. A simple loop winds round q once if q is
// inside, by its own direction, else not at all. Two counter-clockwise loops with q inside, which do not touch, would
// lie one within the other; so at most one is there, and N(q) <= 1.
//
// Let facets F and G, which share no vertex, have a point x in common. It is a point a of the surface in F, and another
// point b in G: points of the surface as a complex, where facets meet in common vertices and edges alone. Projected,
// both are at p. If all of a neighborhood of p is covered by facets that have a, none of which is G, then points near
// p inside of G have N >= 2. That is so if a is inside of F; or on an edge with a facet on either side, neither of
// which is G, since both have a vertex in common with F, or are F; or a vertex about which some facets close a fan,
// since a fan that turns one way all along closes no sooner than after a whole turn. Else a is on the border: on an
// edge of it, or at a vertex with fans that are all open, whose sides are edges of the border. So is b, likewise. But
// edges of the border that pass p share a vertex there. So a is b, which F and G do not share.
//
// This is normal-cone culling [volino1994] with an axis as the direction: so the whole test is decided by signs of
// orientations in the plane, without rounding.
#pragma once

#include <cstdint>
#include <morula/parallel/workers.hpp>
#include <vector>

#include "surface/boxes/tree_state.hpp"

namespace morula::detail {

class HeightFields {
 public:
  HeightFields();
  ~HeightFields();
  HeightFields(HeightFields&&) noexcept;
  HeightFields& operator=(HeightFields&&) noexcept;

  /// Starts without any known height field. boxes: the boxes of the present pose.
  void start(const SurfaceTreeState& s, const SurfaceBoxes& boxes);
  /// Tests the regions of all levels.
  void find_all(Workers& workers);
  /// Tests one region.
  void find(std::size_t level, std::uint32_t region);
  /// Whether a region is known to be a height field; false for a region that was not tested.
  bool is_one(std::size_t level, std::uint32_t region) const {
    return level < levels_.size() && region < levels_[level].size() && levels_[level][region].is_field;
  }

 private:
  /// Bit k: seen along axis k all facets run counter-clockwise; bit k + 3: clockwise.
  using Directions = std::uint8_t;
  struct Region {
    Directions directions = 0;
    bool is_field = false;
  };
  class Border;  // the memory of one worker

  void find_directions(std::uint32_t first_block, std::uint32_t last_block);
  Directions common_directions(std::size_t level, std::uint32_t region) const;
  bool has_simple_border(std::size_t level, std::uint32_t region, Directions directions, Border& border) const;

  const SurfaceTreeState* state_ = nullptr;
  const SurfaceBoxes* boxes_ = nullptr;
  std::vector<std::vector<Region>> levels_;  // by level; level 0: blocks, whose borders are not tested
  std::vector<Border> borders_;
};

}  // namespace morula::detail
