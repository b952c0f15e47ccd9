// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Swept pairs: features that may meet within a step in which all vertices move on straight lines, and when.
#pragma once

#include <memory>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/surface_tree.hpp>
#include <vector>

namespace morula {

struct SweptPair : FeaturePair {
  /// No impact comes before: 0 to 1, never later than the truth.
  double time = 0;
};

struct SweptOptions {
  /// An impact is when features are no farther apart than this. Mesh units, finite, not negative.
  double distance = 0;
  /// Every pair whose swept boxes are near, as candidates(): what a broad phase gives.
  bool candidates_only = false;
  PairFilter filter{};
  Budget budget{};
  Clock clock{};
};

/// Swept query: all pairs of a vertex and a facet, and of two edges, that may meet within a step. Keeps its memory.
///
/// Conservative: a pair is left out only when a chain of directions proves that it stays apart. Along a fixed direction
/// the gap between two features is the least of linear functions of time, so it is positive between two times at which
/// it is; along a direction that turns evenly it is the least of quadratic ones, bounded by their Bernstein
/// coefficients. Each direction is that of the nearest points where the one before ended, and all of it counts rounding
/// against the pair. Features that pass within some 2^-44 of their size are found though they miss.
class SweptQuery {
 public:
  /// Throws std::invalid_argument for a distance that is negative or not finite, and for a negative budget.
  explicit SweptQuery(SweptOptions options = {});
  ~SweptQuery();
  SweptQuery(SweptQuery&&) noexcept;
  SweptQuery& operator=(SweptQuery&&) noexcept;
  void set_options(SweptOptions options);
  const SweptOptions& options() const;

  /// Surfaces that were updated by positions alone stand still.
  SurfaceQueryStatus run(const SurfaceTree& surface, Workers& workers = serial_workers());
  SurfaceQueryStatus run(const SurfaceTree& a, const SurfaceTree& b, Workers& workers = serial_workers());
  /// As ProximityQuery::resume(); refused with other_options also for another candidates_only.
  SurfaceQueryStatus resume(Workers& workers = serial_workers());

  /// In the order of (kind, a, b), each once; the same for any number of workers and interruptions.
  std::span<const SweptPair> pairs() const;
  /// With `candidates_only`: in the order found, the same for any number of workers; pairs() are those of an earlier
  /// run.
  std::span<const FeaturePair> candidates() const;
  const std::vector<OpenFacets>& open() const;
  /// Which share of the step all vertices may go with no impact among what was found and compared: the earliest time, 1
  /// without any.
  double collision_free_step() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The last time up to which one vertex (or edge) and one facet (or edge) are proven to stay more than `distance`
/// apart, 0 to 1; more than 1 when they do throughout. points: 1 and 3, or 2 and 2, at both ends of the step.
double time_of_impact(std::span<const Vec3> a_from, std::span<const Vec3> a_to, std::span<const Vec3> b_from,
                      std::span<const Vec3> b_to, double distance = 0);

}  // namespace morula
