// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The loops of generators that wide registers speed up: lines of OutsideGrid, owners of points by power, reach of
// seeds, and tests of reducers over samples. One source, fit_kernels.inl, is compiled for each kind of processor, and
// the kind is chosen at run time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/sphere.hpp>
#include <span>

#include "geometry/enclosing/farthest.hpp"

namespace morula::detail {

/// Empty space along a line up to w into a cell: min(before + slope · max(0, w − start), after).
struct alignas(16) GridStep {
  float before, start, slope, after;
};

/// Empty space on a cell's middle line: from `start`, `slope` a cell, up to `total`.
struct OutsideCell {
  float start, slope, total;
};

/// The lines of an axis, row by row. Line u of row v has its first cell at (v · across + u) · along.
struct GridLines {
  const GridStep* steps;  // 3 · along more than the last line ends at may be read
  int along, across, rows;
};
/// A ball in the axes of GridLines; cells.
struct LineBall {
  float along, across, row, radius;
};

/// Lines side by side whose steps are to be computed.
struct OpenLines {
  const OutsideCell* cells;             // cells of the first line; one float more than the last cell needed may be read
  std::size_t along;                    // cells of a line, and steps
  const std::uint8_t* over;             // not 0 in cells that balls have
  std::size_t over_across, over_along;  // distances in `over`: of a line and the next, and of a cell and the next
  GridStep* steps;
  std::size_t count;
};

/// The ball with the least power at each point, so far.
struct PowerOwners {
  float* power;
  std::uint32_t* owner;
};

/// Balls in columns. count: a multiple of ball_columns_step.
struct BallColumns {
  const double* x;
  const double* y;
  const double* z;
  const double* square;  // square of the radius
  std::size_t count;
};
inline constexpr std::size_t ball_columns_step = 8;

/// Cells of a lattice: (i, j, k) spans origin + (i, j, k) / per_edge to origin + (i + 1, …) / per_edge, and has the
/// number (i · count[1] + j) · count[2] + k.
struct LatticeCells {
  Vec3 origin, per_edge;
  std::array<std::int32_t, 3> count;
};

struct FitKernels {
  /// Outside volume of a ball along all lines: four sums, over every fourth line of each row, row by row.
  float (*outside)(const GridLines& lines, const LineBall& ball);
  /// Computes the steps of cells [begin, end) of several lines. overlap_weight: the weight of cells that balls have.
  /// go_on: sums begin with that of the cell before the first, else with nothing.
  void (*make_steps)(const OpenLines& lines, std::size_t begin, std::size_t end, float overlap_weight, bool go_on);
  /// Ball `number`, squared radius `square`, takes the points where its power is less, or equal to that of a ball with
  /// a higher number.
  void (*offer)(const PointColumns& points, const Vec3f& center, float square, std::uint32_t number,
                const PowerOwners& owners);
  /// Bit i of words of 64: numbers[i] is at most `limit`. Bits from `count` on are 0.
  void (*at_most)(const float* numbers, std::size_t count, float limit, std::uint64_t* bits);
  /// Like at_most, for doubles that are not NaN.
  void (*at_most_in_double)(const double* numbers, std::size_t count, double limit, std::uint64_t* bits);
  /// Squared distances of points from a center. Sums are in the order x, y, z.
  void (*squared_distances_in_double)(const DoublePointColumns& points, const Vec3& center, double* squares);
  /// The greatest distance that a point of the ball, going along its direction, travels before it leaves the ball; at
  /// least 0. points: in the ball, up to rounding. directions: as many unit vectors.
  double (*farthest_exit)(const DoublePointColumns& points, const DoublePointColumns& directions, const Sphere& ball);
  /// The number of the cell that each point lies in.
  void (*cell_numbers)(const DoublePointColumns& points, const LatticeCells& cells, std::int32_t* numbers);
  /// Bit i of words of 64: bytes[i] is `wanted`. Bits from `count` on are 0.
  void (*equal)(const std::uint8_t* bytes, std::size_t count, std::uint8_t wanted, std::uint64_t* bits);
  /// Bit i of words of 64: ball i has less power than the given one at one of the corners at least. corners: x, y, z
  /// and that power.
  void (*with_less_power)(const BallColumns& balls, const double (*corners)[4], std::size_t count, std::uint64_t* bits);
};

/// The kernels that this processor can run, narrowest first. All give the same bits.
std::span<const FitKernels> all_fit_kernels();
/// The widest kernels that this processor can run.
const FitKernels& fit_kernels();

}  // namespace morula::detail
