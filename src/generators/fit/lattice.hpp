// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Oriented lattices over points: their occupied cells, and the fewest circumspheres of these that contain all points.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/box.hpp>
#include <span>
#include <vector>

#include "geometry/enclosing/farthest.hpp"

namespace morula::detail {

/// Orthonormal axes.
using Axes = std::array<Vec3, 3>;

/// Principal axes of points, largest spread first; the coordinate axes when there is no spread.
Axes principal_axes(std::span<const Vec3> points);

/// The axes turned by 45° about one of them.
Axes turned_by_45_degrees(const Axes& axes, int axis);

/// Points in the coordinates of some axes.
std::vector<Vec3> in_axes(const Axes& axes, std::span<const Vec3> points);
Vec3 out_of_axes(const Axes& axes, const Vec3& local);

/// A lattice in the coordinates of some axes: cell (i, j, k) spans origin + (i, j, k) · edge to origin + (i + 1, …) ·
/// edge.
struct Lattice {
  Vec3 origin;
  Vec3 edge;
  double cell_radius() const { return 0.5 * length(edge); }
};

/// Points that are compared with one lattice after the other.
class LatticePoints {
 public:
  /// points: at least one. Copied.
  explicit LatticePoints(std::span<const Vec3> points);
  const Box& box() const { return box_; }

  /// Centers of the cells that points lie in, in the order of first use. Returns false, with the first of them, if they
  /// are more than `most`. lattice: no point before its origin, and few cells to the points' box: there is a bit for
  /// each.
  bool occupied_cells(const Lattice& lattice, std::size_t most, std::vector<Vec3>& centers) const;

  /// A greedy choice of centers whose spheres of this radius contain all points: most new points first, lowest index
  /// among equals. Points in no sphere are ignored; there are none if the centers are those of the points' cells. If
  /// the choice takes more than `most`, the first most + 1 of them are returned.
  std::vector<std::uint32_t> greedy_cover(std::span<const Vec3> centers, double radius, std::size_t most) const;

 private:
  DoublePointColumns from(std::size_t first, std::size_t count) const {
    return {x_.data() + first, y_.data() + first, z_.data() + first, count};
  }
  std::vector<double> x_, y_, z_;
  Box box_;
};

}  // namespace morula::detail
