// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Vertices of a body at the last step of a proxy and at this one.
#pragma once

#include <memory>
#include <morula/collide/collider.hpp>
#include <vector>

namespace morula::detail {

class SurfaceMotion {
 public:
  /// Remembers the body's positions. It is the first step. body: in all calls without a transform.
  void start(const Collider& body);
  std::size_t vertex_count() const { return before_.size(); }
  std::size_t facet_count() const { return facet_count_; }

  /// The largest distance that a vertex of a facet has moved from the remembered positions to those of the body; 0,
  /// without reading them, if the body is in the same state. Keeps the remembered positions until accept().
  double compare(const Collider& body);
  Triangle before(const Facet& f) const { return {before_[f[0]], before_[f[1]], before_[f[2]]}; }
  Triangle after(const Facet& f) const { return {after_[f[0]], after_[f[1]], after_[f[2]]}; }
  /// Remembers the positions of the last compare(), which are the body's.
  void accept(const Collider& body);

 private:
  double copy_positions(const Collider& body);
  bool has_same_state(const Collider& body) const;

  // The state whose positions are remembered. The weak pointer keeps the numbers of a state that ended from meaning
  // another one.
  std::weak_ptr<const void> source_;
  std::uint64_t frame_ = 0;
  const std::byte* first_vertex_ = nullptr;

  std::size_t facet_count_ = 0;
  std::vector<std::uint32_t> used_;   // vertices of facets
  std::vector<Vec3> before_, after_;  // of all vertices; only those of facets are read
};

/// Corners that move on straight lines, at a share of the way.
inline Triangle between(const Triangle& from, const Triangle& to, double share) {
  return {from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share,
          from[2] + (to[2] - from[2]) * share};
}
/// The largest distance between a corner and the same one of the other triangle.
inline double largest_move(const Triangle& from, const Triangle& to) {
  return std::sqrt(
      std::max({squared_distance(from[0], to[0]), squared_distance(from[1], to[1]), squared_distance(from[2], to[2])}));
}

}  // namespace morula::detail
