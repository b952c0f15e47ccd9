// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features, which are vertices, edges and facets: the results of queries on surface trees, the filters that
// skip pairs, and the status of queries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <morula/collide/budget.hpp>
#include <morula/geometry/status.hpp>
#include <span>
#include <tuple>
#include <vector>

namespace morula {

/// The kinds of the two features of a pair: the first is of surface a, the second of surface b. Queries for distances
/// find the first three kinds.
enum class PairKind : std::uint8_t {
  vertex_facet,  ///< with edge_edge the only kinds for one surface with itself
  facet_vertex,
  edge_edge,
  facet_facet,  ///< pairs of queries for crossings
};

/// Two features by their numbers: a vertex or facet of the mesh, or an edge of SurfaceTree::edges(). Numbers stay the
/// same as long as the tree exists, so kind, a and b identify a pair in all frames.
struct FeaturePair {
  PairKind kind{};
  std::uint32_t a = 0, b = 0;
  bool operator==(const FeaturePair&) const = default;
  auto operator<=>(const FeaturePair&) const = default;
};

/// Groups of facets, one bit per group. Facets i of a and j of b are compared if category[i] & mask[j] and category[j]
/// & mask[i] are both not 0. Edges and vertices are compared if any two facets to which they belong are.
struct FacetMasks {
  std::vector<std::uint32_t> category{}, mask{};  ///< one number per facet each; empty: all bits set for all facets
};

/// The pairs that a query skips. A query of one surface with itself always skips pairs that share a vertex.
///
/// Pairs that `rings` and `rest_distance` skip cost little: a search does not descend below pairs of nodes of which
/// every pair is skipped, and it tests up to 64 pairs at once. `rings` need a table of at most 512 bytes per facet: the
/// first query without a budget makes it; a query with a budget makes the rows that it comes to, within its budget in
/// time. If the table would be larger, or the rings about any eight adjacent facets have more than 4,096 vertices, the
/// rest of the pairs are tested one by one, each in the time of a search through its rings. `rest_distance` needs the
/// features at rest in floats: the first query makes them in linear time, about 110 bytes per facet, for all distances.
/// The surface tree keeps them, and the tables of the last four filters.
struct PairFilter {
  /// For one surface with itself: skips pairs of which two vertices are at most this number of edges apart. 0: skips
  /// only pairs that share a vertex.
  std::uint32_t rings = 0;
  /// For one surface with itself: skips pairs that are at most this far apart at rest, mesh units; finite, 0 or more. 0
  /// skips none.
  double rest_distance = 0;
  /// For one surface with itself: true skips pairs whose features belong to one component (components_by_vertices).
  bool same_component = false;
  FacetMasks masks_a{}, masks_b{};  ///< groups of the facets of a and b; one surface with itself uses masks_a for both
  /// Filter: returns true to keep a pair; empty keeps all. A query calls it for pairs whose boxes are near, on several
  /// threads at once. It must return the same value for the same pair every time.
  std::function<bool(const FeaturePair&)> accepts{};
};

/// A rejection, or the progress of the call. If the call is not finished, its results are correct but not all, and
/// open() of the query lists the facets with missing pairs.
struct [[nodiscard]] SurfaceQueryStatus : Status {
  bool finished = false;       ///< true: the results are complete
  std::size_t box_tests = 0;   ///< number of tests of boxes in this call
  std::size_t candidates = 0;  ///< number of pairs of features with near boxes, in all calls since start()
};

/// Facets of a and of b that an unfinished query has not compared with each other, in part or at all. Every missing
/// pair consists of such facets, their edges or their vertices.
struct OpenFacets {
  std::span<const std::uint32_t> a, b;
};

}  // namespace morula
