// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Lazy boxes: boxes of a surface that follows a body, made by a query for the blocks that it visits.
//
// Why no pair is lost. Let features f of a and g of b have points p and q no farther apart than the reach. Patches of
// leaves tile every facet, so p, which lies in some facet F that has f, lies in the part of F of some leaf, and the
// sphere of that leaf contains it, since the pose covers; likewise the sphere of one of b's leaves contains q. These
// two spheres are no farther apart than the reach, nor are those of any two nodes above them, and the walk errs on the
// near side: it comes to that pair of leaves. That is true of every facet that p lies in. A feature is listed by one
// block, which has some facet F with the feature in it; p lies in that F, so the block is among those of the leaf that
// owns the part of F at p. Its box is made of all its vertices, as an update makes it, and so are those of groups
// above, which hold the boxes of all blocks that are made. The pairs that the search finds among them are compared
// exactly, as for all surfaces.
#pragma once

#include <cstdint>
#include <morula/parallel/workers.hpp>
#include <optional>
#include <vector>

#include "surface/boxes/tree_state.hpp"

namespace morula::detail {

class LazyBoxes {
 public:
  /// No block is requested yet.
  void start(const SurfaceTreeState& s);
  void want_all();
  /// Requests the blocks of a leaf.
  void want(std::uint32_t leaf);
  /// Makes the boxes of the requested blocks; all other boxes are empty. extent: a bound of the coordinates of all
  /// boxes of the whole surface, if not all are requested.
  const SurfaceBoxes& make(Workers& workers, std::optional<double> extent = {});

 private:
  const SurfaceTreeState* state_ = nullptr;
  SurfaceBoxes boxes_;
  std::vector<std::uint8_t> needs_leaf_, needs_block_, has_slot_;
  std::vector<std::uint32_t> slots_;
  std::vector<std::vector<std::uint32_t>> groups_;  // by level, the groups that are not empty
};

/// The boxes of two surfaces, or of one with itself, for a query of features that are no farther apart than the reach.
class QueryBoxes {
 public:
  /// A query of one surface with itself if b is a. by_spheres: leave out blocks that are farther apart by their
  /// spheres.
  void start(const SurfaceTreeState& a, const SurfaceTreeState& b, double reach, bool by_spheres, Workers& workers);
  const SurfaceBoxes& a() const { return *a_; }
  const SurfaceBoxes& b() const { return *b_; }

 private:
  LazyBoxes lazy_a_, lazy_b_;
  const SurfaceBoxes *a_ = nullptr, *b_ = nullptr;
};

}  // namespace morula::detail
