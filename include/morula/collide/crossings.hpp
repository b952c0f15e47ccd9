// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The pairs of facets of two bodies that intersect.
#pragma once

#include <cstddef>
#include <memory>
#include <morula/collide/collider.hpp>
#include <morula/geometry/triangle_intersection.hpp>
#include <span>
#include <vector>

namespace morula {

struct Crossing {
  std::uint32_t facet_a, facet_b;
  Segment segment;  ///< result of intersection(), world coordinates
  bool operator==(const Crossing&) const = default;
};

/// Crossing query: repeated queries with kept memory, so that a query like earlier ones allocates nothing. For one
/// thread at a time.
class CrossingQuery {
 public:
  CrossingQuery();
  ~CrossingQuery();
  CrossingQuery(CrossingQuery&&) noexcept;
  CrossingQuery& operator=(CrossingQuery&&) noexcept;

  /// Finds all pairs of a facet of `a` and a facet of `b` that intersect(). The result is as complete as brute force if
  /// the spheres of both bodies cover (SphereState::covers); the spheres select the leaves that may meet.
  ///
  /// The verdict is about Collider::triangle: present positions, placed and rounded to double. It is exact; touching
  /// and coplanar facets count. Rejects a body whose last update was rejected, and positions of another frame than the
  /// body's; the result then stays as it was. Cost: 20 ns per facet read, 30 to 100 ns per pair tested.
  Status run(const Collider& a, const Collider& b);
  /// The same for pairs of the given nodes: a pair of facets is found if one pair of nodes owns parts of both. nodes:
  /// usually leaves; all pairs whose regions may meet. A facet that a node shares with other nodes is tested as a
  /// whole, so a pair may be found by nodes that do not own its common points. Nodes out of range are a bad_option.
  Status run(const Collider& a, const Collider& b, std::span<const NodePair> nodes);

  /// Crossings of the last run that was not rejected, in the order of (facet_a, facet_b), each pair once.
  std::span<const Crossing> pairs() const;
  /// Pairs of leaves that were compared. This and the next two counts are the same in every run.
  std::size_t leaf_pairs() const;
  std::size_t facets_read() const;   ///< facets read of both bodies, each once per node that owns a part of it
  std::size_t pairs_tested() const;  ///< pairs of facets tested exactly, because their boxes meet

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The same, once. Throws std::invalid_argument, with the message, if CrossingQuery rejects the input.
std::vector<Crossing> crossings(const Collider& a, const Collider& b);

namespace brute_force {
/// Brute force: all facets against all others, by intersect(). O(F²).
std::vector<Crossing> crossings(const Collider& a, const Collider& b);
}  // namespace brute_force

}  // namespace morula
