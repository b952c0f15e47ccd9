// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Crossings: the pairs of facets of two bodies that intersect, exactly.
#pragma once

#include <cstddef>
#include <memory>
#include <morula/collide/collider.hpp>
#include <morula/geometry/triangle_intersection.hpp>
#include <span>
#include <vector>

namespace morula {

/// A facet of a and a facet of b that intersect.
struct Crossing {
  std::uint32_t facet_a, facet_b;
  Segment segment;  ///< result of intersection() of the two triangles, world coordinates
  bool operator==(const Crossing&) const = default;
};

/// Finds crossings again and again. It keeps its memory, so a run that needs no more than earlier ones allocates
/// nothing. Only one thread may use it at a time.
class CrossingQuery {
 public:
  CrossingQuery();
  ~CrossingQuery();
  CrossingQuery(CrossingQuery&&) noexcept;
  CrossingQuery& operator=(CrossingQuery&&) noexcept;

  /// Finds all pairs of a facet of `a` and a facet of `b` that intersect. Spheres select the pairs of leaves whose
  /// facets are compared, so the result is complete if the spheres of both bodies cover (SphereState::covers).
  ///
  /// The test is exact for the triangles that Collider::triangle returns: present positions under the collider's
  /// transform, rounded to double. Facets that touch or are coplanar and overlap count. Rejects a body that queries
  /// reject, a collider without facets, and positions of another frame than the spheres; pairs() then stays as it was.
  /// Cost: about 20 ns per facet read and 30 to 100 ns per pair tested.
  Status run(const Collider& a, const Collider& b);
  /// Finds the pairs of facets of which some pair of `nodes` owns parts: the first node a part of the facet of `a`, the
  /// second a part of the facet of `b`. nodes: usually pairs of leaves, such as those of a query for contacts. A facet
  /// is tested as a whole, so nodes may find a pair whose common points they do not own. Rejects nodes out of range
  /// (bad_option), and like run(a, b).
  Status run(const Collider& a, const Collider& b, std::span<const NodePair> nodes);

  /// The crossings of the last run that was not rejected, each once, ascending by facet_a, then by facet_b. Valid until
  /// the next run.
  std::span<const Crossing> pairs() const;
  /// Number of pairs of leaves, or of given nodes, whose facets were compared. This and the next two counts are the
  /// same for the same input.
  std::size_t leaf_pairs() const;
  std::size_t facets_read() const;  ///< number of facets read of both bodies, each once per node that owns a part of it
  std::size_t pairs_tested() const;  ///< number of pairs of facets that were tested exactly, because their boxes meet

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The pairs of CrossingQuery::run(a, b), for a single call. Throws std::invalid_argument, with the message of the
/// status, for input that it rejects.
std::vector<Crossing> crossings(const Collider& a, const Collider& b);

namespace brute_force {
/// The same pairs without spheres, for tests: compares every facet of a with every facet of b. Throws like
/// morula::crossings(). Cost: O(F²) for F facets.
std::vector<Crossing> crossings(const Collider& a, const Collider& b);
}  // namespace brute_force

}  // namespace morula
