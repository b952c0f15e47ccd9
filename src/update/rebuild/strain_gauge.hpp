// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Strain gauge: the strain between two poses at the scale of spheres, from lengths the size of leaves. It predicts at
// once which of several trees fits a pose, before any of them is updated.
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
  static constexpr std::size_t most = 256;  ///< most lengths

  /// Chooses lengths within the leaves of a tree that was made for this pose, a few for each.
  StrainGauge(const MeshView& posed, const SphereTree& tree, const Cover& cover);

  std::size_t length_count() const { return pairs_.size(); }
  /// Writes as many lengths as there are, at these positions, over the mean one at the pose that the tree was made for;
  /// not finite if positions are not.
  void measure(const PositionView& positions, std::span<float> lengths) const noexcept;
  /// Strain from the pose that the tree was made for to these positions.
  double strain(const PositionView& positions) const noexcept;
  /// Root of the mean square of half (x − 1 / x) over the lengths, with x the ratio of a length of `now` to the same of
  /// `before`; lengths that are shorter in `now` count less. That is about the mean strain between them. It is 0 for
  /// the same pose, however it is rotated and wherever it lies; NaN if a length is not finite.
  static double strain(std::span<const float> now, std::span<const float> before) noexcept;

 private:
  struct Pair {
    std::uint32_t from, to;
  };
  std::vector<Pair> pairs_;
  double mean_length_ = 1;  // mean length at the pose that the tree was made for
  std::vector<float> at_build_;
};

}  // namespace morula::detail
