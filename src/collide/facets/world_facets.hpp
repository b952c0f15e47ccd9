// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The facets of leaves in the world; those of a leaf are computed at most once per query.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/collide/collider.hpp>
#include <vector>

namespace morula::detail {

struct WorldFacet {
  Triangle corners;
  Sphere sphere;  // a sphere that contains the corners
  std::uint32_t facet;
  double reach = 0;  // upper bound along a direction: see WorldFacets::reach
};

/// A sphere that contains a triangle: the center counts as exact; distances from it are off by 3 u, and by less than
/// 2^-510 where squares underflow, for which 2^-500 is allowed here and in gap_below.
inline Sphere sphere_about(const Triangle& t) {
  const Vec3 center = (t[0] + t[1] + t[2]) * (1.0 / 3.0);
  const double farthest =
      std::max({squared_distance(t[0], center), squared_distance(t[1], center), squared_distance(t[2], center)});
  // mutant facet-sphere: `* (1 + 0x1p-49) +` -> `+`
  return {center, std::sqrt(farthest) * (1 + 0x1p-49) + 0x1p-500};
}

inline WorldFacet world_facet(const Collider& collider, std::uint32_t facet) {
  const Triangle corners = collider.triangle(facet);
  return {corners, sphere_about(corners), facet, 0};
}

class WorldFacets {
 public:
  struct Range {
    std::size_t begin, end;
  };

  /// Begins a new query: forgets all facets and keeps the memory.
  void start(const Collider& collider) {
    collider_ = &collider;
    facets_.clear();
    ranges_.resize(std::max(ranges_.size(), collider.tree().node_count()));
    if (++query_ == 0) std::fill(ranges_.begin(), ranges_.end(), Known{}), query_ = 1;
  }
  Range of_leaf(std::uint32_t leaf) {
    Known& known = ranges_[leaf];
    if (known.query != query_) {
      known = {query_, {facets_.size(), 0}, 0, 0};
      for (const std::uint32_t facet : collider_->facets(leaf)) facets_.push_back(world_facet(*collider_, facet));
      known.range.end = facets_.size();
    }
    return known.range;
  }
  const WorldFacet& operator[](std::size_t i) const { return facets_[i]; }

  /// Sets the reach of each facet of a leaf and returns the largest. measure(triangle) returns it; `version`, not 0,
  /// identifies a measure: each is computed once per leaf.
  template <class Measure>
  double reach(std::uint32_t leaf, std::uint32_t version, const Measure& measure) {
    const Range range = of_leaf(leaf);
    Known& known = ranges_[leaf];
    if (known.version == version) return known.reach;
    known.version = version;
    known.reach = -std::numeric_limits<double>::infinity();
    for (std::size_t i = range.begin; i < range.end; ++i)
      known.reach = std::max(known.reach, facets_[i].reach = measure(facets_[i].corners));
    return known.reach;
  }

 private:
  struct Known {
    std::uint32_t query = 0;
    Range range{};
    std::uint32_t version = 0;
    double reach = 0;
  };
  const Collider* collider_ = nullptr;
  std::vector<WorldFacet> facets_;
  std::vector<Known> ranges_;
  std::uint32_t query_ = 0;
};

}  // namespace morula::detail
