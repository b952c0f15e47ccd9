// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/exclusion_rule.hpp"

#include <algorithm>
#include <span>
#include <vector>

#include "surface/pairs/feature_filter.hpp"

namespace morula::detail {
namespace {

/// A breadth-first search along edges. It keeps its memory.
class RingSearch {
 public:
  /// Calls reached(v) for every vertex that is at most so many edges from one of `from`, each once and the nearest
  /// first, until it returns true. Returns whether it did.
  template <class Reached>
  bool run(const SurfaceTreeState& s, std::span<const std::uint32_t> from, std::uint32_t rings,
           const Reached& reached) {
    if (stamp_.size() < s.mesh.rest.size()) stamp_.resize(s.mesh.rest.size(), now_);
    if (++now_ == 0) {
      std::fill(stamp_.begin(), stamp_.end(), 0u);
      now_ = 1;
    }
    queue_.clear();
    for (const std::uint32_t v : from)
      if (take(v) && reached(v)) return true;
    std::size_t begin = 0;
    for (std::uint32_t ring = 0; ring < rings && begin < queue_.size(); ++ring)
      for (const std::size_t end = queue_.size(); begin < end; ++begin)
        for (std::uint32_t i = s.mesh.ring_begin[queue_[begin]]; i < s.mesh.ring_begin[queue_[begin] + 1]; ++i)
          if (take(s.mesh.ring[i]) && reached(s.mesh.ring[i])) return true;
    return false;
  }

 private:
  bool take(std::uint32_t v) {
    if (stamp_[v] == now_) return false;
    stamp_[v] = now_;
    queue_.push_back(v);
    return true;
  }

  std::vector<std::uint32_t> stamp_, queue_;
  std::uint32_t now_ = 0;
};

}  // namespace

ExclusionTest::ExclusionTest(const SurfaceTreeState& surface, const ExclusionRule& rule)
    // mutant exclusion-rounding: `0x1p-40` -> `0`
    : surface_(surface), rule_(rule), rounding_(0x1p-40 * (surface.rest_reach + rule.rest_distance)) {}

bool ExclusionTest::are_neighbors(const FeaturePair& pair) const {
  if (rule_.rings == 0) return false;
  const FeatureVertices a(surface_, feature_a(pair.kind), pair.a), b(surface_, feature_b(pair.kind), pair.b);
  thread_local RingSearch search;
  return search.run(surface_, std::span(a.begin(), a.end()), rule_.rings,
                    [&](std::uint32_t v) { return std::find(b.begin(), b.end(), v) != b.end(); });
}

bool ExclusionTest::are_near_at_rest(const FeaturePair& pair) const {
  return rule_.rest_distance > 0 && are_within_at_rest(surface_, pair, rule_.rest_distance);
}

// are_within_at_rest() compares the rounded distance of two points of the features, which is off by less than 2^-46 of
// the largest coordinate: up to the allowance here, it is no more than the extent of both boxes together. Differences
// of coordinates, and lengths of them, are off by 2^-50 of themselves, which is less yet.
bool ExclusionTest::are_surely_near(const Box& a, const Box& b) const {
  if (!(rule_.rest_distance > 0)) return false;
  const Vec3 across = max(a.upper - b.lower, b.upper - a.lower);
  // mutant exclusion-sure: `length` -> `0.5 * length`
  return length(across) <= rule_.rest_distance - rounding_;
}

}  // namespace morula::detail
