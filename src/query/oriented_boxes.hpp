// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Four boxes side by side, each in axes of its own, and lower bounds of their distances from a point. A box that lies
// along a flat patch of a surface holds little other space. If much of the surface is nearly as near as the nearest
// point, as from the center of an inscribed ball, boxes along the coordinates leave twenty times as many facets to be
// tested.
#pragma once

#include <array>
#include <limits>
#include <morula/geometry/box.hpp>
#include <morula/geometry/triangle.hpp>
#include <span>

#include "simd/float4.hpp"

namespace morula::detail {

/// Coordinates about the center of a mesh's box, in which the longest side of the box is 1/2 to 1 unless the mesh is
/// almost a point.
struct Units {
  Vec3 origin;
  double scale = 1;               // a power of two
  double largest_coordinate = 0;  // largest |coordinate| of the mesh, in its own coordinates
  static constexpr double near = 1024;

  Units() = default;
  explicit Units(const Box& box);
  Vec3 of(const Vec3& p) const { return (p - origin) * scale; }
};

struct alignas(64) OrientedBoxes {
  static constexpr int count = 4;
  float axis[3][3][count];  // unit axes: axis, coordinate, box
  float lower[3][count];    // lower bounds along the axes, from the center
  float upper[3][count];
  float center[3];  // common center, in Units
  float far_share;  // factor of squared distances in double that makes them no more than the true ones
};

/// Boxes about the facets of a patch, in the axes of the patch's own box and from its center.
struct alignas(16) FacetBoxes {
  float lower[3][OrientedBoxes::count];
  float upper[3][OrientedBoxes::count];
};

/// Makes boxes that contain every computed closest point of their facets, and more; see NearDistances.
class BoxMaker {
 public:
  /// all: a box that contains all facets of the boxes, in mesh coordinates.
  BoxMaker(const Units& units, const Box& all);
  /// Sets box k to one along the coordinates. It contains the computed closest points already.
  void set(int k, const Box& box);
  /// Sets box k to one along a patch of facets, perpendicular to its area vector, which is the sum of the facets'. If
  /// that is too short for a direction, the box lies along the coordinates.
  void set(int k, std::span<const Triangle> patch, const Vec3& area_vector);
  const OrientedBoxes& boxes() const { return boxes_; }
  /// Boxes about each facet of the patch to which box k was set; no more than FacetBoxes holds.
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

/// Squared distances in Units from a point to four boxes: no more than the computed squared distances (closest_point),
/// times the square of units.scale, from that point to the facets in the boxes. It serves points that are at most
/// Units::near along each axis.
class NearDistances {
 public:
  using Scalar = float;
  NearDistances(const Units& units, const Vec3& p) : p_(units.of(p)) {}
  /// A float that is no less.
  static float limit(double squared) {
    constexpr float most = std::numeric_limits<float>::max(), least = std::numeric_limits<float>::min();
    // Rounding takes less from a large value than the product adds, and less from a small one than the sum adds.
    // mutant box-limit-rounded: `* (1 + 0x1p-22f) +` -> `+ 0 *`
    return squared < 0x1p120 ? static_cast<float>(squared) * (1 + 0x1p-22f) + least : most;
  }

  // Proof that these are no more: let x be the computed closest point of a facet, D its distance from p, q = p -
  // center, r the reach of all boxes from their center, all in Units, and a_i a box's axes, as floats. Rounding moves q
  // by 2^-24 |q| and 2^-52 |p|, three products and their sum are off by 3.01 * 2^-24 |q|: heights a_i q are off by less
  // than 2^-21.9 |q| + 2^-52 |p|, where |q| <= D + r. The boxes are padded by the part of r and by the distance of x
  // from the exact facet (BoxMaker), so a gap is at most |a_i (q - x)| + 2^-21.9 D, apart from a last rounding of 2^-24
  // of itself. The axes are unit and at right angles up to 2^-22, so they lengthen q - x by at most 1.5 * 2^-22 D, and
  // three gaps together are at most (1 + (0.25 + 1.5 + 1.9) * 2^-22) D. The square has a factor less than 1 + 7.4 *
  // 2^-22, with the rounding of squares and sums less than 1 + 9 * 2^-22.
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
  /// Squared distances to facets of box k. The proof holds for them as well: axes, center and pad are those of the box.
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

/// The same for all other points, in double, since in floats both ends of the mesh would be equally far.
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

/// Calls visit(distances) with the distances for p.
template <class Visit>
auto with_distances(const Units& units, const Vec3& p, const Visit& visit) {
  return max_norm(units.of(p)) <= Units::near ? visit(NearDistances(units, p)) : visit(FarDistances(units, p));
}

}  // namespace morula::detail
