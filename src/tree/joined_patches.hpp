// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Convex patches of one facet as fewer: so a needle does not fall into more patches at every cut.
#pragma once

#include <cstdint>
#include <morula/geometry/triangle.hpp>
#include <span>
#include <vector>

namespace morula::detail {

/// Joins convex patches of one facet if their union is convex. Reuse the object to avoid allocation.
class PatchJoiner {
 public:
  /// A convex polygon, by the numbers of its corners: those of all patches, in the order in which they were added.
  struct Polygon {
    std::vector<std::uint32_t> corners;
    double area;                                          // in barycentric coordinates
    double lowest_b1, highest_b1, lowest_b2, highest_b2;  // the box around it
  };

  void clear();
  /// corners: corners of a convex polygon, counter-clockwise.
  void add(std::span<const Barycentric> corners);
  std::size_t size() const { return polygons_.size(); }

  /// Returns as few polygons as pairwise joining leaves, and no more than were added. A joined polygon is the convex
  /// hull of its patches, exactly, and its corners are corners of theirs: it owns no corner that was not owned, and a
  /// sphere that contains the patches contains it. Its area is the sum of theirs, up to rounding, so nothing is covered
  /// twice. Patches that are joined with none keep their corners unchanged.
  /// Cost: quadratic in the number of patches.
  std::span<const Polygon> join();

 private:
  bool join_all();
  bool join_two(std::size_t first, std::size_t second);
  void take_corners(const Polygon& polygon);
  double take_hull();
  Polygon polygon_of(std::vector<std::uint32_t> corners, double area) const;

  std::vector<Barycentric> corners_;
  std::vector<Polygon> polygons_;
  std::vector<std::uint32_t> points_, hull_;
};

}  // namespace morula::detail
