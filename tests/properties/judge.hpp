// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Judge of cover: is a surface inside a union of balls? It asks points of the surface, in arithmetic of its own.
#pragma once

#include <cstdint>
#include <dice.hpp>
#include <optional>
#include <point.hpp>
#include <span>
#include <vector>

namespace oracle {

/// A point of the surface that is in no ball.
struct UncoveredPoint {
  std::size_t facet = 0;
  Point point;
  Real gap = 0;  ///< its distance from the nearest ball
};

struct CoverTally {
  std::size_t facets = 0;
  std::size_t proved = 0;   ///< facets cut into triangles each of which lies in one ball: no point of them is uncovered
  std::size_t samples = 0;  ///< points held against the balls
};

/// A point of a facet that is worth a look: weights of the second and third corner, not negative, at most 1 together.
struct Hint {
  std::size_t facet = 0;
  Real v = 0, w = 0;
};

/// How much a judge looks at.
struct Effort {
  std::size_t cuts = 160;     ///< of one facet, and a quarter of that for each ball that comes near it
  std::size_t scattered = 4;  ///< random points of each facet that the cuts did not prove, and of a few others
};

/// The uncovered point that is farthest from all balls, of those looked at.
///
/// A facet is halved again and again where no one ball holds all corners of a piece. What is left after a few cuts lies
/// where the union is thinnest, at the corners of cells; so the search goes by itself to the points that are uncovered
/// first. Random points come on top: inside, on edges, and on edges close to their ends.
///
/// Rounding. A point is w0 a + w1 b + w2 c with weights that are exact and add up to exactly 1, or the middle of two
/// such: it is on the facet but for 6 roundings of at most the largest coordinate A, however often halved (the error of
/// a middle is the mean of its ends' and one rounding more, so that 60 halvings in a row add 60: those are allowed,
/// too). A difference, three squares and a root add less than 8. In all below 2^7 epsilon (A + r), which is 2^-56 of
/// it: what is allowed. certify() evaluates corners in double, and radii are padded for that by 2^-48 of A.
std::optional<UncoveredPoint> find_uncovered(std::span<const Triangle> facets, std::span<const Ball> balls, Dice& dice,
                                             CoverTally& tally, const Effort& effort = {},
                                             std::span<const Hint> hints = {});

/// The distance from a point to the nearest ball: negative inside.
Real gap_of(const Point& point, std::span<const Ball> balls);

/// What find_uncovered() allows for at a point and ball whose coordinates are at most this.
inline Real allowance(Real largest_coordinate, Real radius) {
  return 0x1p7L * epsilon * (largest_coordinate + std::abs(radius));
}

}  // namespace oracle
