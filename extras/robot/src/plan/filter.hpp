// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Single-precision tests of sixteen configurations at a time. They divide cases into contacts, gaps and doubtful ones,
// with an allowance that exceeds all rounding; double decides the doubtful ones.
//
// Coordinates are those of the world less the position of the robot's base, so a base far from the origin costs no
// accuracy. Let X bound, for a test, the |coordinates| of all translations and box centers that it uses, plus distances
// of spheres from their links' origins, radii and half lengths. With u = 2^-24, and all sums in the order of the code:
//   a coordinate of a placed center    is off by 6.1 u X: conversions of pose and center, products, three sums
//   a difference of two centers        by 12.2 u X, plus u of itself, at most 2 X: as a vector below 25 u X
//   a box's local coordinate           by 16 u X (the difference from its center, as a vector), 17.3 u X (its rotation)
//                                      and 5 u X (half length, subtraction), as a vector below 67 u X
//   squares and reach                  change the compared lengths by 5 u of at most 7 X
// So the compared length, the distance less the sum of radii, is off by less than 110 u X. The allowance is 128 u X.
// The positions in double, from which the others start, are off by less than 2^-46 of the coordinates of the world,
// which is also added; so is 1e-18, far above the roots of float's smallest numbers, for squares that vanish. X is at
// most 1e15, so no square overflows.
#pragma once

#include <cstddef>
#include <morula/geometry/sphere.hpp>

namespace morula::robot {

inline constexpr std::size_t filter_block = 16;  ///< configurations that are tested together
inline constexpr double filter_largest = 1e15;   ///< largest X
inline constexpr double filter_least = 1e-18;

/// The allowance. size: X. world: a bound of the |coordinates| in the world.
inline float filter_allowance(double size, double world) {
  // mutant filter-allowance: `0x1p-17 * size` -> `0x1p-25 * size`
  return static_cast<float>(0x1p-17 * size + 0x1p-46 * world + filter_least);
}

/// A center in each of the configurations.
struct alignas(64) PlacedCenter {
  float x[filter_block], y[filter_block], z[filter_block];
};
/// The spheres of a group in each configuration; the first is around the others.
struct PlacedGroup {
  const PlacedCenter* centers;
  const float* radii;
  std::size_t count;  ///< spheres, the first included
};
/// The pose of a link in each configuration: rows of the rotation, each with a coordinate of the translation.
struct alignas(64) PlacedLink {
  float entries[12][filter_block];
};
struct FilterBox {
  float rows[3][3];  ///< of the transposed rotation
  float center[3], half[3];
};

/// Configurations, one per bit.
struct LaneSets {
  unsigned near = 0;      ///< contacts and doubtful cases
  unsigned contacts = 0;  ///< contacts beyond doubt
};

/// wanted: the configurations to test; results may lack those that are contacts already.
struct FilterKernels {
  void (*place)(const PlacedLink& link, const Spheref* spheres, std::size_t count, PlacedCenter* centers);
  LaneSets (*groups)(const PlacedGroup& a, const PlacedGroup& b, float allowance, unsigned wanted);
  LaneSets (*box)(const PlacedGroup& group, const FilterBox& box, float allowance, unsigned wanted);
  LaneSets (*sphere)(const PlacedGroup& group, const Spheref& sphere, float allowance, unsigned wanted);
  /// Near to a box along the axes by the sphere around the group. An obstacle in the box may be far away.
  unsigned (*bounds)(const PlacedGroup& group, const float* lower, const float* upper, float allowance,
                     unsigned wanted);
};

/// The widest kernels that this processor can run.
const FilterKernels& filter_kernels();

}  // namespace morula::robot
