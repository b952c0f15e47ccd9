// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Distance of two bodies' surfaces: bounds that hold, with the points that show the upper one.
//
//   morula::DistanceQuery query;                                     // keeps its memory from frame to frame
//   const morula::DistanceBounds near = query.run(a, b, {.stop_above = 0.5});
//   if (!near.status) std::puts(message(near.status).c_str());
//   if (!near.farther) std::printf("%g between facets %u and %u\n", near.upper, near.a.facet, near.b.facet);
//   const morula::DistanceBounds once = morula::distance(a, b);      // throws where the query refuses
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <morula/collide/budget.hpp>
#include <morula/collide/collider.hpp>
#include <morula/geometry/triangle.hpp>

namespace morula {

struct DistanceOptions {
  /// Down to the nearest pair of facets. false: the lower bound is that of the leaf spheres, and only the facets of the
  /// nearest pair of leaves are looked at.
  bool to_facets = true;
  double tolerance = 0;  ///< stop when upper - lower is not more
  /// Stop after so many pair tests, of spheres or facets, and those of one leaf; or after some time, by `clock`, looked
  /// at before each leaf and every 64 tests.
  Budget budget{};
  /// "Tell me only if nearer than": stop when lower is above.
  double stop_above = std::numeric_limits<double>::infinity();
  /// "Tell me as soon as you know that they are as near as this": stop when upper is not above.
  double stop_below = 0;
  /// Begin with the facets of the last answer, where the bodies are the same. That changes the work. Answers that run
  /// to the end keep their upper bound and points to the bit, and their lower bound but for rounding; answers that end
  /// early (budget, tolerance, thresholds, surfaces that cross) may be others.
  bool warm_start = true;
  Clock clock{};  ///< of a budget of time; none: std::chrono::steady_clock
};

struct [[nodiscard]] DistanceBounds {
  Status status;
  /// lower <= distance <= upper, in real numbers, of the surfaces with the vertices of Collider::vertex. Both 0 when a
  /// facet of one meets a facet of the other (exact verdict).
  double lower = 0, upper = 0;
  /// Surface points, upper or less apart up to rounding (when crossing, one point).
  SurfacePoint a{}, b{};
  bool crossing = false;   ///< a facet of one meets a facet of the other
  bool farther = false;    ///< proved to be farther apart than stop_above
  bool complete = false;   ///< ended as asked: the nearest facets, the tolerance, a threshold; false: by the budget
  bool certified = false;  ///< SphereState::covers of both; else lower is not a proof
  std::size_t sphere_tests = 0, facet_tests = 0;  ///< work done
};

/// Asks again and again without allocation, once it has seen the bodies.
///
/// Best first over pairs of nodes: the pair of spheres that may be nearest is split next, of its larger sphere. The
/// distance is that of the surfaces: a body inside another without contact is as far as its walls are. The interior is
/// asked for by InsideQuery. Open surfaces are as good as closed ones.
/// Cost: 15...30 ns per test of spheres, about 0.5 us per pair of facets; memory 16 bytes per pair waiting and 120 per
/// facet looked at.
class DistanceQuery {
 public:
  DistanceQuery();
  ~DistanceQuery();
  DistanceQuery(DistanceQuery&&) noexcept;
  DistanceQuery& operator=(DistanceQuery&&) noexcept;

  /// A fault is reported in the status; lower is then 0, upper infinite and nothing else is set.
  DistanceBounds run(const Collider& a, const Collider& b, const DistanceOptions& options = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The same, once. Throws std::invalid_argument, in words, for what DistanceQuery refuses.
DistanceBounds distance(const Collider& a, const Collider& b, const DistanceOptions& options = {});

}  // namespace morula
