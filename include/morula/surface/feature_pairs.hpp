// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features: the results of queries on surface trees, the filters of pairs, and the progress of queries.
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

/// The features of a pair: the first of surface a, the second of surface b.
enum class PairKind : std::uint8_t {
  vertex_facet,  ///< for one surface with itself, only this and edge_edge occur
  facet_vertex,
  edge_edge,
  facet_facet,  ///< for crossings
};

/// Two features by number: a vertex or facet of the mesh, or an edge of SurfaceTree::edges(). Numbers do not change
/// while a tree lives, so kind, a and b identify a pair in later frames.
struct FeaturePair {
  PairKind kind{};
  std::uint32_t a = 0, b = 0;
  bool operator==(const FeaturePair&) const = default;
  auto operator<=>(const FeaturePair&) const = default;
};

/// Groups of facets, one bit per group: facets i of a and j of b are compared if category[i] & mask[j] and category[j]
/// & mask[i] are not 0. Edges and vertices belong to all groups of their facets, and form a pair if one of these facets
/// does.
struct FacetMasks {
  std::vector<std::uint32_t> category{}, mask{};  ///< one per facet each; empty: all bits set
};

/// Pairs to skip. For one surface with itself, pairs that share a vertex are always skipped.
///
/// The first query with given `rings` and `rest_distance` makes a table of the pairs that these skip, which the surface
/// keeps: at most 512 bytes per facet, and the last four tables. If the table would be larger, every query tests these
/// pairs one by one.
struct PairFilter {
  /// Number of edges, for one surface with itself: skips pairs with two vertices at most this many edges apart. 0: only
  /// pairs that share a vertex.
  std::uint32_t rings = 0;
  /// Distance at rest, for one surface with itself, mesh units: skips pairs that are at most this far apart at rest. 0:
  /// none.
  double rest_distance = 0;
  /// Skips pairs of one component (components_by_vertices), for one surface with itself.
  bool same_component = false;
  FacetMasks masks_a{}, masks_b{};  ///< groups of both surfaces; for one surface with itself only masks_a is read
  /// Filter: returns true to keep a pair. Workers call it concurrently, for pairs whose boxes are near; it must give
  /// the same result for the same pair.
  std::function<bool(const FeaturePair&)> accepts{};
};

/// A rejection, or the progress of the call. Results found stay valid; open() lists the rest.
struct [[nodiscard]] SurfaceQueryStatus : Status {
  bool finished = false;
  std::size_t box_tests = 0;   ///< tests of this call
  std::size_t candidates = 0;  ///< pairs of features with near boxes, of all calls since the start
};

/// Facets of a and of b that an interrupted query has not compared: all missing pairs are of such facets, their edges
/// and their vertices.
struct OpenFacets {
  std::span<const std::uint32_t> a, b;
};

}  // namespace morula
