// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Strain gauge: how far a pose is from the one that an ownership was built for, as its spheres feel it, from lengths
// within its leaves. It tells at once which of several ownerships fits a pose, before any of them is updated.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/positions.hpp>
#include <morula/tree/cover.hpp>
#include <vector>

namespace morula::detail {

class StrainGauge {
 public:
  /// Measures nothing: no strain anywhere.
  StrainGauge() = default;
  /// Lengths within the leaves of a tree built for this pose, a few for each, at most `most`. Leaves of another tree
  /// feel other lengths: parts of the body that go apart are in one of its leaves, perhaps, and in two of another's.
  StrainGauge(const Mesh& pose, const CoveredTree& built, std::size_t most);

  std::size_t length_count() const { return pairs_.size(); }
  /// Root of the mean square of half (x − 1 / x) over the lengths, x being one at these positions over the same when
  /// built, and those that are shorter now counting less: about the mean strain since. Nought for the same pose,
  /// however it is turned and wherever it lies; not a number where a length is not finite.
  double strain(const PositionView& positions) const noexcept;

 private:
  struct Pair {
    std::uint32_t from, to;
    float at_build, shortest;  // no length counts as shorter than that: two vertices may come together
  };
  std::vector<Pair> pairs_;
};

}  // namespace morula::detail
