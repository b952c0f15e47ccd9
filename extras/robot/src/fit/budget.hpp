// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The division of a number of spheres among the links of a robot.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace morula::robot {

/// Outside volume of a link with 1, 2, 8 and 32 spheres, measured cheaply; between and beyond these it is assumed to
/// fall as a power of the number.
struct Demand {
  static constexpr std::array<std::size_t, 4> counts{1, 2, 8, 32};
  std::array<double, 4> outside{};
  std::size_t links = 1;  ///< number of links that share the set
  std::size_t fixed = 0;  ///< spheres that the link has in any case; a link without a mesh takes no others
  bool has_mesh = true;

  double at(std::size_t count) const;
};

/// One sphere each, then each further sphere to the link where it removes most volume. The sum over links is at most
/// `total` if one sphere each is.
std::vector<std::size_t> share_spheres(std::span<const Demand> demands, std::size_t total);

/// The mesh of a link, for its share by size.
struct MeshSize {
  double area = 0;        ///< area of its box, 0 or more
  std::size_t links = 1;  ///< number of links that share the set
};

/// One sphere each, then each further sphere to the link where the power 3/4 of the area, divided by the number of
/// spheres plus 1/2, is largest. The sum over links is at most `total` if one sphere each is; no link gets fewer if the
/// total is larger. The shares depend on ratios of areas only.
std::vector<std::size_t> share_by_size(std::span<const MeshSize> sizes, std::size_t total);

}  // namespace morula::robot
