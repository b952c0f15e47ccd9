// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Free space: what is neither the object's nor another ball's, about one ball that is to be moved a little.
//
// It is kept in pieces of lines of all three axes, exact along each line: a layer much thinner than the way from line
// to line still counts, where OutsideGrid gives a cell to whoever holds its middle. Axes are weighted as there.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <vector>

#include "generators/fit/object_lines.hpp"

namespace morula::detail {

/// Coordinates are lattice cells of the lines from the middle of the space. Volumes are proportional to mesh units.
class FreeSpace {
 public:
  /// around: where balls may be. spacing: wanted between lines, mesh units; at least a lattice cell. others: the balls
  /// that have taken space in. Nothing is borrowed.
  FreeSpace(const ObjectLines& lines, const Sphere& around, double spacing, std::vector<Sphere> others);

  Vec3f to_cells(const Vec3& p) const;
  Vec3 from_cells(const Vec3f& p) const;
  double cell() const { return cell_; }
  bool is_inside(const Vec3f& center, float radius) const;  ///< the ball is where balls may be
  /// How much of the free space a ball takes in. It must be inside. Costs above `enough` may come back as any number
  /// above it.
  float cost(const Vec3f& center, float radius, float enough = std::numeric_limits<float>::infinity()) const;

 private:
  // Columns. As many pieces as registers take: those that fill up the last one weigh nothing.
  struct Pieces {
    std::vector<float> u, v, begin, end, weight;
    void add(float line_u, float line_v, double from, double to, float counts);
  };
  struct Ball {  // in lattice cells; along the axis in work, and across it
    double along, u, v, radius;
  };
  struct Interval {
    double begin, end;
  };
  void trace(const ObjectLines& lines, int axis, std::span<const Ball> others);
  void trace_line(const ObjectLines& lines, int axis, int u, int v, double half, std::span<const Ball> row);

  Vec3 middle_;
  double radius_, cell_;
  Vec3 in_lattice_;
  int stride_;
  std::array<Pieces, 3> pieces_;
  std::vector<Interval> apart_;  // scratch
};

}  // namespace morula::detail
