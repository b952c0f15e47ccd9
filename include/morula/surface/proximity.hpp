// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Proximity: pairs of features of two surfaces, or of one with itself, that are within a distance.
//
//   morula::SurfaceTree surface(mesh);
//   morula::ProximityQuery query({.distance = 0.01, .filter = {.rings = 2}});
//   if (!surface.update(positions) || !query.run(surface)) std::puts("refused");
//   std::printf("%zu pairs of features are within 0.01\n", query.pairs().size());
#pragma once

#include <memory>
#include <morula/geometry/triangle.hpp>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/surface_tree.hpp>
#include <vector>

namespace morula {

struct ProximityPair : FeaturePair {
  double distance = 0;  ///< of point_a and point_b, mesh units
  /// Nearest points: weights of the feature's vertices, of an edge in the order of SurfaceTree::edges(), of a facet in
  /// its own; exactly 0 for a vertex that has no part. A vertex has {1, 0, 0}.
  Barycentric weights_a{}, weights_b{};
  Vec3 point_a{}, point_b{};
  /// From a to b, of unit length; zero where they touch.
  Vec3 direction() const { return distance > 0 ? (point_b - point_a) / distance : Vec3{}; }
};

struct ProximityOptions {
  double distance = 0;  ///< mesh units, finite, not negative
  /// Each pair of nearest features once: a vertex nearest to an edge is found by facets and edges around it, and is
  /// kept for the first of them alone. Else every vertex-facet and edge-edge pair that is near enough.
  bool nearest_features_once = false;
  PairFilter filter{};
  Budget budget{};
  Clock clock{};
};

/// Proximity query: asks again and again, and keeps its memory. For one thread at a time; workers share its work.
///
/// Complete: every pair nearer than the given distance is found, but for 2^-46 of the largest coordinate, by which
/// distances may be off that are computed from coordinates far from the origin. Surfaces that are in a step are asked
/// where it begins.
class ProximityQuery {
 public:
  /// Throws std::invalid_argument for a distance that is negative or not finite, and for a negative budget.
  explicit ProximityQuery(ProximityOptions options = {});
  ~ProximityQuery();
  ProximityQuery(ProximityQuery&&) noexcept;
  ProximityQuery& operator=(ProximityQuery&&) noexcept;
  void set_options(ProximityOptions options);
  const ProximityOptions& options() const;

  /// All pairs of one surface with itself, or of two, from the beginning. Trees are borrowed until the last resume().
  /// Refused with bad_option: masks of another number of facets.
  SurfaceQueryStatus run(const SurfaceTree& surface, Workers& workers = serial_workers());
  SurfaceQueryStatus run(const SurfaceTree& a, const SurfaceTree& b, Workers& workers = serial_workers());
  /// Goes on where a budget ended it, with a new one. Refused with no_front when nothing was started, with other_frame
  /// when a surface has moved since, and with other_options for another distance than it began with.
  SurfaceQueryStatus resume(Workers& workers = serial_workers());

  /// In the order of (kind, a, b), each once. The same for any number of workers and however often it was interrupted.
  std::span<const ProximityPair> pairs() const;
  const std::vector<OpenFacets>& open() const;
  /// How far each vertex of surface a (of both, when a is asked with itself) may move, whatever the others within their
  /// own bounds do, before a pair can touch: half the least distance of a pair that its facets and edges have, and half
  /// the query's distance where there is none. It is less by what computed distances may be off, and 0 where that is
  /// all there is. distances: one per vertex. Only of a finished query with all pairs kept by its filter's rules, and
  /// of the frame that it was asked in; pairs that share a vertex do not bound one another.
  void safe_distances(std::span<double> distances) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
