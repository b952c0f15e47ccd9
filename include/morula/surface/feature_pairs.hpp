// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features: what queries of surface trees find, which pairs they leave out, and how far they came.
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

/// Which features a pair has, of surface a and of surface b.
enum class PairKind : std::uint8_t {
  vertex_facet,  ///< of one surface with itself, this and edge_edge are all there are
  facet_vertex,
  edge_edge,
  facet_facet,  ///< of crossings
};

/// Two features by their numbers: a vertex of the mesh, a facet of it, an edge of SurfaceTree::edges(). Numbers do not
/// change while a tree lives, so a pair is known again in later frames by all three together.
struct FeaturePair {
  PairKind kind{};
  std::uint32_t a = 0, b = 0;
  bool operator==(const FeaturePair&) const = default;
  auto operator<=>(const FeaturePair&) const = default;
};

/// Who may meet whom, a bit per group: facets i of a and j of b are looked at when of[i] & with[j] and of[j] & with[i]
/// are not 0. Edges and vertices are of all groups of their facets and meet what one of them meets.
struct FacetMasks {
  std::vector<std::uint32_t> category{}, mask{};  ///< one per facet each; empty: all ones
};

/// Pairs that are left out. Of one surface with itself, pairs that share a vertex always are.
///
/// The pairs that `rings` and `rest_distance` leave out are a table, which the first query with these values makes and
/// the surface keeps: at most 512 bytes per facet, and the last four tables. Without a table, which would be larger,
/// every query tests those pairs one by one.
struct PairFilter {
  /// Of one surface with itself: pairs of which some two vertices are at most so many edges apart. 0: the same vertex.
  std::uint32_t rings = 0;
  /// Of one surface with itself: pairs that are this close at rest, mesh units. 0: none.
  double rest_distance = 0;
  /// Of one surface with itself: pairs of one piece, as components_by_vertices() finds them.
  bool same_component = false;
  FacetMasks masks_a{}, masks_b{};  ///< for one surface with itself a alone
  /// Keeps a pair when it returns true. Called by workers at the same time, for pairs whose boxes are near; must give
  /// the same answer for the same pair.
  std::function<bool(const FeaturePair&)> accepts{};
};

/// Refused, or how far it came. Whatever has been found so far stays found; what was not looked at is open().
struct [[nodiscard]] SurfaceQueryStatus : Status {
  bool finished = false;
  std::size_t box_tests = 0;   ///< done by this call
  std::size_t candidates = 0;  ///< pairs of features whose boxes are near, of all calls since the start
};

/// Facets of a and of b that an interrupted query has not compared: all pairs that are missing are of such facets, of
/// their edges and of their vertices.
struct OpenFacets {
  std::span<const std::uint32_t> a, b;
};

}  // namespace morula
