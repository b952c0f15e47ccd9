// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rule by which pairs of features of one surface are excluded, and the test of a single pair.
#pragma once

#include <cstdint>
#include <morula/geometry/box.hpp>
#include <morula/surface/feature_pairs.hpp>

#include "surface/boxes/feature_boxes.hpp"

namespace morula::detail {

/// The exclusions by PairFilter::rings and rest_distance.
struct ExclusionRule {
  std::uint32_t rings = 0;
  double rest_distance = 0;
  Features features = Features::all;
  bool excludes_any() const { return rings > 0 || rest_distance > 0; }
  bool operator==(const ExclusionRule&) const = default;
};

/// Whether a rule excludes a pair, decided for that pair alone. It is slow: it serves to make tables, and searches
/// without a table.
class ExclusionTest {
 public:
  ExclusionTest(const SurfaceTreeState& surface, const ExclusionRule& rule);
  bool excludes(const FeaturePair& pair) const { return are_near_at_rest(pair) || are_neighbors(pair); }
  bool are_near_at_rest(const FeaturePair& pair) const;
  /// Whether a vertex of the one is at most so many edges from a vertex of the other.
  bool are_neighbors(const FeaturePair& pair) const;
  /// The allowance for rounding of distances at rest, mesh units.
  double rounding() const { return rounding_; }
  /// Whether all features in these boxes are farther apart at rest; whether all are as near.
  bool are_surely_apart(const Box& a, const Box& b) const;
  bool are_surely_near(const Box& a, const Box& b) const;

 private:
  const SurfaceTreeState& surface_;
  ExclusionRule rule_;
  double rounding_;
};

}  // namespace morula::detail
