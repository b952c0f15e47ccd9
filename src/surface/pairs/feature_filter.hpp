// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A PairFilter prepared for the surfaces of a query, and the points of features: all vertices, and the nearest points
// of two features.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/proximity.hpp>
#include <span>
#include <vector>

#include "surface/boxes/tree_state.hpp"
#include "surface/pairs/excluded_pairs.hpp"

namespace morula::detail {

enum class Feature : std::uint8_t { vertex, edge, facet };
inline Feature feature_a(PairKind kind) {
  return kind == PairKind::vertex_facet ? Feature::vertex
         : kind == PairKind::edge_edge  ? Feature::edge
                                        : Feature::facet;
}
inline Feature feature_b(PairKind kind) {
  return kind == PairKind::facet_vertex ? Feature::vertex
         : kind == PairKind::edge_edge  ? Feature::edge
                                        : Feature::facet;
}

/// The one to three vertices of a feature.
class FeatureVertices {
 public:
  FeatureVertices(const SurfaceTreeState& s, Feature feature, std::uint32_t number) {
    if (feature == Feature::vertex) {
      vertex_[0] = number, size_ = 1;
    } else if (feature == Feature::edge) {
      vertex_[0] = s.mesh.edges[number][0], vertex_[1] = s.mesh.edges[number][1], size_ = 2;
    } else {
      vertex_ = s.mesh.facets[number], size_ = 3;
    }
  }
  std::size_t size() const { return size_; }
  std::uint32_t operator[](std::size_t i) const { return vertex_[i]; }
  const std::uint32_t* begin() const { return vertex_.data(); }
  const std::uint32_t* end() const { return vertex_.data() + size_; }

 private:
  std::array<std::uint32_t, 3> vertex_{};
  std::size_t size_ = 0;
};

/// The nearest points of a vertex and a facet, in either order, or of two edges. points: 1 and 3, 3 and 1, or 2 and 2.
ProximityPair nearest_points(const FeaturePair& pair, std::span<const Vec3> a, std::span<const Vec3> b);
/// Whether two features of one surface are within a distance at rest. The distance of two facets is the least of their
/// vertices, edges and facets; 0 where they cross.
bool are_within_at_rest(const SurfaceTreeState& s, const FeaturePair& pair, double distance);

/// are_within_at_rest() for one distance; boxes and vertices decide most pairs.
class RestTest {
 public:
  RestTest() = default;
  /// rounding: the allowance of ExclusionTest.
  RestTest(double distance, double rounding);
  bool is_near(const SurfaceTreeState& s, const FeaturePair& pair) const;

 private:
  double distance_ = 0;
  double surely_near_ = -1;                                        // squared
  double surely_apart_ = std::numeric_limits<double>::infinity();  // squared
};

class FeatureFilter {
 public:
  /// Throws std::invalid_argument, naming the option, for an option that is out of range by itself.
  static void require_usable(const PairFilter& filter);
  /// Prepares the filter; for one surface with itself if b is a. ok, or bad_option for masks that do not fit the
  /// surfaces. makes_table: whether the table of neighbors is made here, as far as it is missing; else the search makes
  /// its rows.
  Status start(const PairFilter& filter, const SurfaceTreeState& a, const SurfaceTreeState& b, Features features,
               bool makes_table, Workers& workers);
  /// The pairs that the search drops without a call of accepts(), as far as it finds them; null if there are none.
  const ExcludedPairs* excluded() const { return excluded_.get(); }
  /// Whether a pair that shares no vertex is kept. are_neighbors_known: the search has dropped all neighbors of
  /// `rings`.
  bool accepts(const FeaturePair& pair, bool are_neighbors_known) const {
    return (accepts_all_ && are_neighbors_known) || accepts_one(pair, are_neighbors_known);
  }

 private:
  /// Masks of features: the bits of all facets that have a vertex or an edge.
  struct Masks {
    std::span<const std::uint32_t> facet_category, facet_mask;
    std::vector<std::uint32_t> vertex_of, vertex_with, edge_of, edge_with;
    void start(const FacetMasks& masks, const SurfaceTreeState& s);
    bool are_given() const { return !facet_category.empty() || !facet_mask.empty(); }
    std::uint32_t of(Feature feature, std::uint32_t number) const;
    std::uint32_t with(Feature feature, std::uint32_t number) const;
  };
  bool accepts_one(const FeaturePair& pair, bool are_neighbors_known) const;

  const PairFilter* filter_ = nullptr;
  const SurfaceTreeState *a_ = nullptr, *b_ = nullptr;
  Masks masks_a_, masks_b_;
  std::shared_ptr<const ExcludedPairs> excluded_;  // for one surface with itself, if the filter excludes any pair
  bool accepts_all_ = false;
  RestTest rest_test_;
  bool tests_rest_ = false;
};

}  // namespace morula::detail
