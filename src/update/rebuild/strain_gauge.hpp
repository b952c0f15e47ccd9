// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Strain gauge: how far a pose is from another as spheres feel it, from lengths the size of leaves. It tells at once
// which of several ownerships fits a pose, before any of them is updated.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/positions.hpp>
#include <morula/tree/cover.hpp>
#include <span>
#include <vector>

namespace morula::detail {

class StrainGauge {
 public:
  /// Lengths within the leaves of a tree, a few for each, at most `most`.
  StrainGauge(const Mesh& rest, const CoveredTree& built, std::size_t most = 768);

  std::size_t length_count() const { return pairs_.size(); }
  /// As many lengths as there are, at these positions, over those at rest; not finite where positions are not.
  void measure(const PositionView& positions, std::span<float> lengths) const noexcept;
  /// Root of the mean square of half (x − 1 / x) over the lengths, x being one now over the same at_build, and those
  /// that are shorter now counting less: about the mean strain since an ownership was built. Nought for the same pose,
  /// however it is turned and wherever it lies; not a number where a length is not finite.
  static double strain(std::span<const float> now, std::span<const float> at_build) noexcept;

 private:
  struct Pair {
    std::uint32_t from, to;
    double at_rest;
  };
  std::vector<Pair> pairs_;
};

}  // namespace morula::detail
