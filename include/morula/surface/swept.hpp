// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Swept pairs: features that may meet within a step in which all vertices move on straight lines, and their times.
#pragma once

#include <memory>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/surface_tree.hpp>
#include <vector>

namespace morula {

struct SweptPair : FeaturePair {
  /// Time before which no impact occurs: 0 to 1, never later than the true time.
  double time = 0;
};

struct SweptOptions {
  /// Distance at which features count as meeting, mesh units; finite, not negative.
  double distance = 0;
  /// List every pair with near swept boxes in candidates(), like a broad phase.
  bool candidates_only = false;
  PairFilter filter{};
  Budget budget{};
  Clock clock{};
};

/// Swept query: all pairs of a vertex and a facet, and of two edges, that may meet within a step. It keeps its memory.
///
/// Conservative: a pair is skipped only if a chain of directions proves that it stays apart. Along a fixed direction
/// the gap between two features is the least of linear functions of time, so it is positive between two times at which
/// it is positive. Along a direction that rotates evenly it is the least of quadratic functions, bounded by their
/// Bernstein coefficients. Each direction is that of the nearest points at the end of the previous one, and rounding
/// counts against the pair. Features that pass each other within about 2^-44 of their size may be found although they
/// miss.
class SweptQuery {
 public:
  /// Throws std::invalid_argument for a distance that is negative or not finite, and for a negative budget.
  explicit SweptQuery(SweptOptions options = {});
  ~SweptQuery();
  SweptQuery(SweptQuery&&) noexcept;
  SweptQuery& operator=(SweptQuery&&) noexcept;
  void set_options(SweptOptions options);
  const SweptOptions& options() const;

  /// Finds the pairs. Surfaces that were updated by positions alone stand still.
  SurfaceQueryStatus run(const SurfaceTree& surface, Workers& workers = serial_workers());
  SurfaceQueryStatus run(const SurfaceTree& a, const SurfaceTree& b, Workers& workers = serial_workers());
  /// Continues like ProximityQuery::resume(); also rejected with other_options for another candidates_only.
  SurfaceQueryStatus resume(Workers& workers = serial_workers());

  /// Pairs in the order of (kind, a, b), each once; the same for any number of workers and interruptions.
  std::span<const SweptPair> pairs() const;
  /// With `candidates_only`: candidates in the order of the search, the same for any number of workers; pairs() then
  /// keeps the result of an earlier run.
  std::span<const FeaturePair> candidates() const;
  const std::vector<OpenFacets>& open() const;
  /// Share of the step that all vertices can move without an impact among the tested pairs: the earliest time, 1
  /// without impacts.
  double collision_free_step() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Last time up to which one vertex (or edge) and one facet (or edge) are proven to stay farther apart than `distance`,
/// 0 to 1; above 1 if they do throughout. points: 1 and 3, or 2 and 2, at both ends of the step. distance: mesh units.
double time_of_impact(std::span<const Vec3> a_from, std::span<const Vec3> a_to, std::span<const Vec3> b_from,
                      std::span<const Vec3> b_to, double distance = 0);

}  // namespace morula
