// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Four boxes side by side, each in axes of its own, and how far they are from a point at least. A box that lies along a
// flat patch of a surface holds little beside it. Where much of the surface is nearly as near as the nearest point, as
// from the center of a ball inside it, boxes along the coordinates leave twenty times as many facets to be looked at.
#pragma once

#include <array>
#include <limits>
#include <morula/geometry/box.hpp>
#include <morula/geometry/triangle.hpp>
#include <span>

#include "simd/float4.hpp"

namespace morula::detail {

/// Coordinates about the middle of a mesh, whose box's longest side is 1/2 to 1 in them unless it is all but a point.
struct Units {
  Vec3 origin;
  double scale = 1;               // a power of two
  double largest_coordinate = 0;  // of the mesh, in its own coordinates
  static constexpr double near = 1024;

  Units() = default;
  explicit Units(const Box& box);
  Vec3 of(const Vec3& p) const { return (p - origin) * scale; }
};

struct alignas(64) OrientedBoxes {
  static constexpr int count = 4;
  float axis[3][3][count];  // axis, coordinate, box
  float lower[3][count];    // along the axes, from the center
  float upper[3][count];
  float center[3];  // in Units
  float far_share;  // of squared distances in double, what is no more than the true one
};

/// Boxes about the facets of a patch, in the axes of the patch's own box and from its center.
struct alignas(16) FacetBoxes {
  float lower[3][OrientedBoxes::count];
  float upper[3][OrientedBoxes::count];
};

/// Makes boxes that contain what a computed closest point of their facets may be, and more, see NearDistances.
class BoxMaker {
 public:
  /// all: contains everything that boxes will be about, mesh coordinates.
  BoxMaker(const Units& units, const Box& all);
  /// A box along the coordinates. It contains the computed closest points already.
  void set(int k, const Box& box);
  /// A box along a patch of facets, at right angles to its area vector, which is the sum of the facets'. Where that is
  /// too short for a direction, the box lies along the coordinates.
  void set(int k, std::span<const Triangle> patch, const Vec3& area_vector);
  const OrientedBoxes& boxes() const { return boxes_; }
  /// Boxes about each facet of the patch that box k was set to; no more than there is room for.
  FacetBoxes facets_of(int k, std::span<const Triangle> patch) const;

 private:
  using Axes = std::array<std::array<float, 3>, 3>;
  Axes axes_along(std::span<const Triangle> patch, const Vec3& area_vector) const;
  Box along(const Axes& axes, std::span<const Triangle> patch) const;
  void set(int k, const Axes& axes, const Box& box);

  Units units_;
  OrientedBoxes boxes_{};
  Vec3 center_;
  double pad_ = 0;
};

/// Squared distances in Units from a point to four boxes: no more than the computed squared distances (closest_point)
/// from that point, times the square of units.scale, of the facets in them. This is for points that are at most
/// Units::near along each axis.
class NearDistances {
 public:
  using Scalar = float;
  NearDistances(const Units& units, const Vec3& p) : p_(units.of(p)) {}
  /// A number that is no less.
  static float limit(double squared) {
    constexpr float most = std::numeric_limits<float>::max(), least = std::numeric_limits<float>::min();
    // Of what is not small, rounding takes less than the product adds; of what is, less than the sum.
    // mutant box-limit-rounded: `* (1 + 0x1p-22f) +` -> `+ 0 *`
    return squared < 0x1p120 ? static_cast<float>(squared) * (1 + 0x1p-22f) + least : most;
  }

  // Why these are no more: let x be the computed closest point of a facet, D its distance from p, q = p - center, r the
  // reach of all boxes from their center, all in Units, and a_i a box's axes, as floats. Rounding moves q by 2^-24 |q|
  // and 2^-52 |p|, three products and their sum are off by 3.01 * 2^-24 |q|: heights a_i q are off by less than
  // 2^-21.9 |q| + 2^-52 |p|, where |q| <= D + r. The part of r, and how far x is from the exact facet, the boxes are
  // padded by (BoxMaker), so a gap is at most |a_i (q - x)| + 2^-21.9 D, but for a last rounding of 2^-24 of itself.
  // The axes are unit and at right angles up to 2^-22, so they lengthen q - x by at most 1.5 * 2^-22 D, and three gaps
  // together are at most (1 + (0.25 + 1.5 + 1.9) * 2^-22) D. Of the square that is less than 1 + 7.4 * 2^-22, with the
  // rounding of squares and sums less than 1 + 9 * 2^-22.
  void operator()(const OrientedBoxes& boxes, float* result) const {
    const std::array<float, 3> q = from_center(boxes);
    const Float4 x(q[0]), y(q[1]), z(q[2]);
    squared(
        [&](int a) {
          return x * Float4::load(boxes.axis[a][0]) + y * Float4::load(boxes.axis[a][1]) +
                 z * Float4::load(boxes.axis[a][2]);
        },
        boxes, result);
  }
  /// To facets of box k. What was said holds for them as well: axes, center and pad are those of the box.
  void operator()(const OrientedBoxes& boxes, int k, const FacetBoxes& facets, float* result) const {
    const std::array<float, 3> q = from_center(boxes);
    squared(
        [&](int a) {
          return Float4(q[0] * boxes.axis[a][0][k] + q[1] * boxes.axis[a][1][k] + q[2] * boxes.axis[a][2][k]);
        },
        facets, result);
  }

 private:
  std::array<float, 3> from_center(const OrientedBoxes& boxes) const {
    return {static_cast<float>(p_.x - static_cast<double>(boxes.center[0])),
            static_cast<float>(p_.y - static_cast<double>(boxes.center[1])),
            static_cast<float>(p_.z - static_cast<double>(boxes.center[2]))};
  }
  template <class Height, class Boxes>
  static void squared(const Height& height_along, const Boxes& boxes, float* result) {
    // mutant box-near-share: `1 - 0x1p-18f` -> `1`
    const Float4 sure(1 - 0x1p-18f), zero(0);
    Float4 sum(0);
    for (int a = 0; a < 3; ++a) {
      const Float4 height = height_along(a);
      const Float4 gap = max(max(Float4::load(boxes.lower[a]) - height, height - Float4::load(boxes.upper[a])), zero);
      sum = sum + gap * gap;
    }
    (sum * sure).store(result);
  }

  Vec3 p_;
};

/// The same for all other points: in double, since in floats one end of the mesh is as far as the other.
class FarDistances {
 public:
  using Scalar = double;
  FarDistances(const Units& units, const Vec3& p) : p_(units.of(p)) {}
  static double limit(double squared) { return squared; }
  void operator()(const OrientedBoxes& boxes, double* result) const;
  void operator()(const OrientedBoxes& boxes, int k, const FacetBoxes& facets, double* result) const;

 private:
  template <class Boxes>
  double squared(const OrientedBoxes& axes, int k, const Boxes& boxes, int which) const;

  Vec3 p_;
};

/// visit(distances): with those for p.
template <class Visit>
auto with_distances(const Units& units, const Vec3& p, const Visit& visit) {
  return max_norm(units.of(p)) <= Units::near ? visit(NearDistances(units, p)) : visit(FarDistances(units, p));
}

}  // namespace morula::detail
