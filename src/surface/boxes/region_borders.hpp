// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Borders of the regions of a surface tree: where the facets below a box end. Made once, with the tree.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <span>
#include <vector>

namespace morula::detail {

/// The regions of one level: region r has the 8^(level + 1) facets from r 8^(level + 1) on, in the order of the tree.
///
/// An edge is inside of a region when two facets of the surface have it, one in each direction, and both are in the
/// region. All other edges of the region's facets are its border, each in the direction of its facet. They make loops,
/// closed, the region on the left of each: where one edge comes to a vertex, the next is the other side of the same
/// fan, which is the facets of the region about the vertex that are joined by inner edges. So a loop is at a vertex
/// once for each fan there, and so are loops together. A region without a border has none, nor has one whose border is
/// out of proportion to its facets, such as that of many separate ones.
struct RegionBorders {
  std::vector<std::uint32_t> loops_begin;  // region r has loops [loops_begin[r], loops_begin[r + 1])
  std::vector<std::uint32_t> slots_begin;  // loop k has the vertices in slots [slots_begin[k], slots_begin[k + 1])
  std::vector<std::uint32_t> slots;

  std::span<const std::uint32_t> loop(std::size_t k) const {
    return std::span(slots).subspan(slots_begin[k], slots_begin[k + 1] - slots_begin[k]);
  }
};

/// Of levels 1 to `levels`, of which the last has one region; level 0 stays empty. facets: in the order of the tree.
std::vector<RegionBorders> region_borders(std::span<const Facet> facets, std::span<const std::uint32_t> slot_of_vertex,
                                          std::size_t levels);

}  // namespace morula::detail
