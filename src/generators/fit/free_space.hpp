// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Free space: the space outside the object and outside all other balls, about one ball that is to be moved a little.
//
// It is stored as intervals on lines of all three axes, exact along each line: a layer much thinner than the distance
// of lines still counts, while OutsideGrid assigns a whole cell to the ball that contains its middle. Axes are weighted
// as there.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <vector>

#include "generators/fit/object_lines.hpp"

namespace morula::detail {

/// Coordinates are lattice cells of the lines from the middle of the space. Volumes are proportional to mesh units. The
/// radii of all balls are reduced by the lines' tolerance, except for is_inside().
class FreeSpace {
 public:
  /// around: where balls may be. spacing: requested distance between lines, mesh units; at least a lattice cell.
  /// others: the balls whose space is not free. Nothing is borrowed.
  FreeSpace(const ObjectLines& lines, const Sphere& around, double spacing, std::vector<Sphere> others);

  Vec3f to_cells(const Vec3& p) const;
  Vec3 from_cells(const Vec3f& p) const;
  double cell() const { return cell_; }
  bool is_inside(const Vec3f& center, float radius) const;  ///< the ball is where balls may be
  /// Volume of a ball in the free space. The ball must be inside. Costs above `enough` may be returned as any number
  /// above it.
  float cost(const Vec3f& center, float radius, float enough = std::numeric_limits<float>::infinity()) const;

 private:
  // Intervals in columns. Their number is a multiple of the register width; the last ones are padding with weight 0.
  struct Segments {
    std::vector<float> u, v, begin, end, weight;
    void add(float line_u, float line_v, double from, double to, float counts);
  };
  struct Ball {  // in lattice cells; along the current axis, and across it
    double along, u, v, radius;
  };
  struct Interval {
    double begin, end;
  };
  void trace(const ObjectLines& lines, int axis, std::span<const Ball> others);
  void trace_line(const ObjectLines& lines, int axis, int u, int v, double half, std::span<const Ball> row);

  Vec3 middle_;
  double radius_, cell_;
  float tolerance_;  // in lattice cells
  Vec3 in_lattice_;
  int stride_;
  std::array<Segments, 3> segments_;
  std::vector<Interval> apart_;  // scratch
};

}  // namespace morula::detail
