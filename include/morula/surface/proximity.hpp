// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Proximity: pairs of features of two surfaces, or of one with itself, within a distance.
//
//   morula::SurfaceTree surface(mesh);
//   morula::ProximityQuery query({.distance = 0.01, .filter = {.rings = 2}});
//   if (!surface.update(positions) || !query.run(surface)) std::puts("rejected");
//   std::printf("%zu pairs of features are within 0.01\n", query.pairs().size());
#pragma once

#include <memory>
#include <morula/geometry/triangle.hpp>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/surface_tree.hpp>
#include <vector>

namespace morula {

struct ProximityPair : FeaturePair {
  double distance = 0;  ///< distance of point_a and point_b, mesh units
  /// Nearest points: weights of the feature's vertices, in the order of SurfaceTree::edges() for an edge and in its own
  /// order for a facet; exactly 0 for a vertex without influence. A vertex has {1, 0, 0}.
  Barycentric weights_a{}, weights_b{};
  Vec3 point_a{}, point_b{};
  /// Unit vector from a to b; zero if they touch.
  Vec3 direction() const { return distance > 0 ? (point_b - point_a) / distance : Vec3{}; }
};

struct ProximityOptions {
  double distance = 0;  ///< largest distance of a pair, mesh units; finite, not negative
  /// true: each pair of nearest features once. The facets and edges around a vertex that is nearest to an edge all find
  /// it; only the first of them is kept. false: every vertex-facet and edge-edge pair within the distance.
  bool nearest_features_once = false;
  PairFilter filter{};
  Budget budget{};
  Clock clock{};
};

/// Proximity query: repeated queries with kept memory. For one thread at a time; workers share its work.
///
/// Complete: every pair nearer than the given distance is found, up to 2^-46 of the largest coordinate, which is the
/// rounding error of distances far from the origin. A surface in a step is tested at its beginning.
class ProximityQuery {
 public:
  /// Throws std::invalid_argument for a distance that is negative or not finite, and for a negative budget.
  explicit ProximityQuery(ProximityOptions options = {});
  ~ProximityQuery();
  ProximityQuery(ProximityQuery&&) noexcept;
  ProximityQuery& operator=(ProximityQuery&&) noexcept;
  void set_options(ProximityOptions options);
  const ProximityOptions& options() const;

  /// Finds all pairs of one surface with itself, or of two, from the beginning. Trees are borrowed until the last
  /// resume(). Rejected with bad_option: masks of another number of facets.
  SurfaceQueryStatus run(const SurfaceTree& surface, Workers& workers = serial_workers());
  SurfaceQueryStatus run(const SurfaceTree& a, const SurfaceTree& b, Workers& workers = serial_workers());
  /// Continues after a budget ended the query, with a new budget. Rejected with no_front if no query was started, with
  /// other_frame if a surface has moved since, and with other_options for another distance than at the start.
  SurfaceQueryStatus resume(Workers& workers = serial_workers());

  /// Pairs in the order of (kind, a, b), each once. They are the same for any number of workers and interruptions.
  std::span<const ProximityPair> pairs() const;
  const std::vector<OpenFacets>& open() const;
  /// Distance that each vertex of surface a (of both, if a is tested with itself) may move before a pair can touch,
  /// while the others also stay within their distances: half the least distance of a pair of its facets and edges, and
  /// half the query's distance without pairs. It is reduced by the error of computed distances, down to 0. distances:
  /// one per vertex, mesh units. Requires a finished query that kept all pairs of its filter's rules, in the same
  /// frame. Pairs that share a vertex do not bound one another.
  void safe_distances(std::span<double> distances) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
