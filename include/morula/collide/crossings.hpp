// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The pairs of facets of two bodies that really intersect.
#pragma once

#include <cstddef>
#include <memory>
#include <morula/collide/collider.hpp>
#include <morula/collide/node_pair.hpp>
#include <morula/geometry/triangle_intersection.hpp>
#include <span>
#include <vector>

namespace morula {

struct Crossing {
  std::uint32_t facet_a, facet_b;
  Segment segment;  ///< of intersection(), in the world
  bool operator==(const Crossing&) const = default;
};

/// Crossing query: asks again and again, and keeps its memory, so that a query like those before it allocates nothing.
/// For one thread at a time.
class CrossingQuery {
 public:
  CrossingQuery();
  ~CrossingQuery();
  CrossingQuery(CrossingQuery&&) noexcept;
  CrossingQuery& operator=(CrossingQuery&&) noexcept;

  /// Finds all pairs of a facet of `a` and one of `b` that intersect(). Complete, as brute force is, when the spheres
  /// of both bodies cover (SphereState::covers); the spheres tell which leaves may meet.
  ///
  /// The verdict is about Collider::triangle: the positions as they are, placed, rounded to double, and nothing else;
  /// it is exact, touching and coplanar facets count. Refused, with the result left as it was: a body whose last update
  /// was refused, and positions that are not those of the body's present frame.
  /// Cost: 20 ns per facet read, 30 to 100 ns per pair tested.
  Status run(const Collider& a, const Collider& b);
  /// The same where a pair of the given nodes owns something of both. nodes: leaves, commonly; all whose regions may
  /// meet. Of facets that a node shares with others, all is looked at, so a pair may be found by nodes that do not hold
  /// its common points. Nodes that do not exist are a bad_option.
  Status run(const Collider& a, const Collider& b, std::span<const NodePair> nodes);

  /// Of the last run that was not refused: in the order of (facet_a, facet_b), each pair once.
  std::span<const Crossing> pairs() const;
  /// Work done, the same on every run.
  std::size_t leaf_pairs() const;
  std::size_t facets_read() const;   ///< of both bodies, each once per node that has a part of it
  std::size_t pairs_tested() const;  ///< exactly: those whose boxes meet

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The same, once. Throws std::invalid_argument, in words, for what CrossingQuery refuses.
std::vector<Crossing> crossings(const Collider& a, const Collider& b);

namespace brute_force {
/// All facets against all others, by intersect(). O(F²).
std::vector<Crossing> crossings(const Collider& a, const Collider& b);
}  // namespace brute_force

}  // namespace morula
