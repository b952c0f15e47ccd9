// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scan conversion of a triangle: lines of a lattice along one axis, row by row.
#pragma once

#include <algorithm>
#include <cmath>
#include <morula/geometry/triangle.hpp>

namespace morula::detail {

/// Lines run along axis w at u = i + offset, v = j + offset; rows of equal v.
struct LineLattice {
  int u, v, w;  ///< axes of the lattice
  double offset;
  int count_u;
  int row_begin, row_end;  ///< range of rows to scan

  /// First line at or above a position, within [0, count].
  int first_at_or_above(double position, int count) const {
    return static_cast<int>(std::clamp(std::ceil(position - offset), 0.0, static_cast<double>(count)));
  }
};

/// Calls cross(i, j, w, leaves) for each line that passes the triangle; leaves: a way up the axis through it leaves the
/// object that it bounds.
///
/// A corner on a row counts as below it and an edge that meets a line as left of it, for every triangle that has that
/// corner or edge; edges are cut from their lower end for either triangle: so a line enters a closed mesh as often as
/// it leaves it, for any rounding. Corners must be finite.
template <class Cross>
void scan_triangle(const Triangle& t, const LineLattice& lines, const Cross& cross) {
  struct Passage {
    double u, w;
  };
  const int u_axis = lines.u, v_axis = lines.v, w_axis = lines.w;
  const int row_begin = std::max(
      lines.row_begin, lines.first_at_or_above(std::min({t[0][v_axis], t[1][v_axis], t[2][v_axis]}), lines.row_end));
  const int row_end = lines.first_at_or_above(std::max({t[0][v_axis], t[1][v_axis], t[2][v_axis]}), lines.row_end);
  for (int j = row_begin; j < row_end; ++j) {
    const double row = j + lines.offset;
    const auto pass = [&](const Vec3& a, const Vec3& b) {
      const bool a_lower = a[v_axis] < b[v_axis];
      const Vec3& lower = a_lower ? a : b;
      const Vec3& upper = a_lower ? b : a;
      const double s = (row - lower[v_axis]) / (upper[v_axis] - lower[v_axis]);
      return Passage{lower[u_axis] + s * (upper[u_axis] - lower[u_axis]),
                     lower[w_axis] + s * (upper[w_axis] - lower[w_axis])};
    };
    Passage up{}, down{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &from = t[k], &to = t[(k + 1) % 3];
      const bool from_below = from[v_axis] <= row, to_below = to[v_axis] <= row;
      if (from_below && !to_below) up = pass(from, to);
      if (!from_below && to_below) down = pass(from, to);
    }
    // A triangle that faces up the axis has its upward edge on the right.
    const bool leaves = down.u < up.u;
    const Passage& left = leaves ? down : up;
    const Passage& right = leaves ? up : down;
    const int end = lines.first_at_or_above(right.u, lines.count_u);
    for (int i = lines.first_at_or_above(left.u, lines.count_u); i < end; ++i)
      cross(i, j, left.w + (i + lines.offset - left.u) / (right.u - left.u) * (right.w - left.w), leaves);
  }
}

}  // namespace morula::detail
