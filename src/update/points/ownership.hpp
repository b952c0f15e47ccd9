// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ownership of points: the cover's patches as lists of distinct points per leaf.
#pragma once

#include <morula/tree/cover.hpp>
#include <span>
#include <vector>

namespace morula::detail {

/// Throws std::invalid_argument unless mesh and tree are usable, mesh, tree and cover have the right sizes for each
/// other, every index is in range, regions are the disjoint unions of their children's, and the tree, if it has a mesh
/// hash, has that of this mesh.
void require_belonging(const MeshView& mesh, const CoveredTree& model);

/// Leaves in depth-first order, so that the leaves below any node are one range.
struct LeafOrder {
  std::vector<std::uint32_t> leaves;  ///< leaf nodes
  std::vector<std::uint32_t>
      begin;  ///< first leaf per node: the leaves below it (itself, for a leaf) are [begin, end) of `leaves`
  std::vector<std::uint32_t> end;
};
LeafOrder depth_first_leaves(const SphereTree& tree);

/// Points get new numbers: first the vertices that facets use, those of the first leaf first; then the cut points that
/// a leaf has to test, in the same order, those on mesh edges before those inside facets. So the points that a leaf
/// reads lie together.
struct Ownership {
  std::vector<std::uint32_t> vertices;    ///< mesh vertex of point i < vertices.size()
  std::vector<std::uint32_t> cut_points;  ///< cut points of the cover; entry k is point vertices.size() + k
  /// Leaf k of the leaf order owns points[begin[k] … begin[k + 1]), ascending, each once. A cut corner is left out when
  /// it lies in the convex hull of others that the leaf owns in the same facet, or within the tolerance of it: a sphere
  /// that contains these contains it, as facet_hull.hpp proves.
  std::vector<std::uint32_t> begin;
  std::vector<std::uint32_t> points;
  /// The uppermost level of each of `points`: the node of that level above the leaf tests the point there; so do all
  /// nodes between that one and the leaf. Empty if all nodes test all points of their leaves (see share_levels).
  std::vector<std::uint32_t> tested_from{};

  std::span<const std::uint32_t> of_leaf(std::size_t k) const {
    return std::span(points).subspan(begin[k], begin[k + 1] - begin[k]);
  }
  std::span<const std::uint32_t> tested_from_of_leaf(std::size_t k) const {
    if (tested_from.empty()) return {};
    return std::span(tested_from).subspan(begin[k], begin[k + 1] - begin[k]);
  }
};
bool is_on_edge(const CutPoint& cut_point);
/// needs_cut_points: one flag per leaf of the order; cut corners of others are left out altogether. tolerance: of
/// FacetHull::surround; a caller that gives one must have it in its error budget.
Ownership share_points(const MeshView& mesh, const Cover& cover, const LeafOrder& order,
                       std::span<const std::uint8_t> needs_cut_points, double tolerance);
/// The corners of the cover that the leaves from first_leaf to end_leaf - 1 of the order own, each once, ascending.
std::vector<std::uint32_t> corners_of(const Ownership& ownership, const Cover& cover, std::uint32_t first_leaf,
                                      std::uint32_t end_leaf);
/// Fills tested_from: a node tests each point once, in the first leaf below it that owns it, and only those cut points
/// that surround the others which its leaves test, within the tolerance of FacetHull::surround. All corners that it
/// owns then lie within twice the tolerance of the hull of the corners that it tests: leaves leave out within one, this
/// within another, and the distance to a hull is a convex function, so no corner of a patch is farther off.
void share_levels(const MeshView& mesh, const SphereTree& tree, const Cover& cover, const LeafOrder& order,
                  double tolerance, Ownership& ownership);

}  // namespace morula::detail
