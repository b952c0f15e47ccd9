// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Distance of two bodies' surfaces: guaranteed bounds, with the points that attain the upper one.
//
//   morula::DistanceQuery query;                                     // keeps its memory from frame to frame
//   const morula::DistanceBounds near = query.run(a, b, {.stop_above = 0.5});
//   if (!near.status) std::puts(message(near.status).c_str());
//   if (!near.farther) std::printf("%g between facets %u and %u\n", near.upper, near.a.facet, near.b.facet);
//   const morula::DistanceBounds once = morula::distance(a, b);      // throws if the query rejects the input
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <morula/collide/budget.hpp>
#include <morula/collide/collider.hpp>
#include <morula/geometry/triangle.hpp>

namespace morula {

struct DistanceOptions {
  /// true: search down to the nearest pair of facets. false: the lower bound is that of the leaf spheres, and only the
  /// facets of the nearest pair of leaves are tested.
  bool to_facets = true;
  double tolerance = 0;  ///< largest upper - lower of a complete result, mesh units
  /// Limit in pair tests, of spheres or facets, which one leaf may exceed; or in time by `clock`, which is read before
  /// each leaf and every 64 tests.
  Budget budget{};
  /// Stop when lower exceeds this distance, for callers that need only near bodies, mesh units.
  double stop_above = std::numeric_limits<double>::infinity();
  /// Stop when upper does not exceed this distance, for callers that only need to know that the bodies are near, mesh
  /// units.
  double stop_below = 0;
  /// Start with the facets of the last result if the bodies are the same. This changes the work. Results that run to
  /// the end keep their upper bound and points to the bit, and their lower bound up to rounding; results that end early
  /// (budget, tolerance, thresholds, surfaces that cross) may differ.
  bool warm_start = true;
  Clock clock{};  ///< clock of a budget of time; empty: std::chrono::steady_clock
};

struct [[nodiscard]] DistanceBounds {
  Status status;
  /// lower <= distance <= upper, in real numbers, for the surfaces with the vertices of Collider::vertex; mesh units.
  /// Both are 0 if a facet of one body meets a facet of the other (exact verdict).
  double lower = 0, upper = 0;
  /// Surface points with a distance of at most upper, up to rounding; one point if the surfaces cross.
  SurfacePoint a{}, b{};
  bool crossing = false;  ///< a facet of one body meets a facet of the other
  bool farther = false;   ///< the distance is proven to exceed stop_above
  /// Reached the nearest facets, the tolerance or a threshold; false: the budget ended the query.
  bool complete = false;
  bool certified = false;  ///< SphereState::covers of both bodies; if false, lower is not a proof
  std::size_t sphere_tests = 0, facet_tests = 0;  ///< numbers of tests
};

/// Distance query: repeated queries without allocation after the first one with the same bodies.
///
/// The search is best first over pairs of nodes: it splits the pair of spheres that may be nearest, at its larger
/// sphere. The distance is that of the surfaces: a body inside another without contact has the distance of the walls.
/// InsideQuery tests the interior. Surfaces may be open.
/// Cost: 15...30 ns per test of spheres, about 0.5 us per pair of facets; memory 16 bytes per waiting pair and 120 per
/// facet read.
class DistanceQuery {
 public:
  DistanceQuery();
  ~DistanceQuery();
  DistanceQuery(DistanceQuery&&) noexcept;
  DistanceQuery& operator=(DistanceQuery&&) noexcept;

  /// Computes the distance. The status reports a fault; lower is then 0, upper infinite, and all else keeps its
  /// default.
  DistanceBounds run(const Collider& a, const Collider& b, const DistanceOptions& options = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The same, once. Throws std::invalid_argument, with the message, if DistanceQuery rejects the input.
DistanceBounds distance(const Collider& a, const Collider& b, const DistanceOptions& options = {});

}  // namespace morula
