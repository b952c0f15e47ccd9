// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// How many spheres each link of a robot gets of a common number.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace morula::robot {

/// Outside volume of a link with 1, 2, 8 and 32 spheres, looked at cheaply; between and beyond these it is taken to
/// fall as a power of the number.
struct Demand {
  static constexpr std::array<std::size_t, 4> counts{1, 2, 8, 32};
  std::array<double, 4> outside{};
  std::size_t links = 1;  ///< that share the set
  std::size_t fixed = 0;  ///< spheres that the link has anyway; with no mesh beside them it takes no more
  bool has_mesh = true;

  double at(std::size_t count) const;
};

/// One each, then one after the other to where it takes away most. The sum over links is at most `total` where one
/// each is.
std::vector<std::size_t> share_spheres(std::span<const Demand> demands, std::size_t total);

}  // namespace morula::robot
