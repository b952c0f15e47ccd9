// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The largest distance from a surface to a union of spheres, by branch and bound.
#pragma once

#include <cstdint>
#include <morula/query/power_diagram.hpp>
#include <vector>

namespace morula::detail {

/// Collects convex pieces of the surface and finds the largest gap(x) = min_i |x − c_i| − r_i on them.
///
/// Each |x − c_i| is convex, so on a triangle it is largest at a corner, and min_i max_corners |x − c_i| − r_i bounds
/// the gap from above: exactly so where one sphere is the nearest at all of the triangle. Triangles are halved along
/// their longest edge, the one with the highest bound first.
class LargestGap {
 public:
  /// diagram: borrowed. tolerance: distances are not told apart below it.
  LargestGap(const PowerDiagram& diagram, double tolerance) : diagram_(&diagram), tolerance_(tolerance) {}

  /// upper: the least growth that lets one sphere contain the polygon.
  void add(std::span<const Vec3> polygon, std::uint32_t facet, double upper);
  /// What another search found and still has to look at.
  void add(const LargestGap& other);
  /// Until the bounds are within relative 5e-7 (or a quarter of the tolerance) of each other, or the budget of
  /// 2²⁰ halvings is spent; the bounds hold in either case.
  void refine();

  double lower() const { return best_; }  ///< attained; minus infinity before anything was added
  double upper() const;
  std::uint32_t facet() const { return best_facet_; }  ///< where lower() is attained

 private:
  struct Piece {
    Triangle corners;
    std::uint32_t facet;
    double upper;
  };
  double wanted() const;  // pieces bounded by this need no further look
  void look_at(const Vec3& x, std::uint32_t facet);
  void push(const Piece& piece);

  const PowerDiagram* diagram_;
  double tolerance_;
  double best_ = -std::numeric_limits<double>::infinity();
  double dropped_ = -std::numeric_limits<double>::infinity();  // highest bound of a piece no longer looked at
  std::uint32_t best_facet_ = 0;
  std::vector<Piece> pieces_;  // heap, highest bound first
};

}  // namespace morula::detail
