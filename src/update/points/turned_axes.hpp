// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Orthonormal axes that turn with three points.
#pragma once

#include <cmath>
#include <morula/geometry/vector.hpp>

namespace morula::detail {

/// Total, and the same for the same points. If the points do not define a direction, any perpendicular one is as good:
/// then all anchors lie on a line (or in a point), and only a remainder's share along the line and its length matter.
/// kernels.inl has the same operations for many at once.
class TurnedAxes {
 public:
  TurnedAxes(const Vec3f& p, const Vec3f& q, const Vec3f& r) {
    const Vec3f side = r - p;
    a_ = normalized(q - p);
    b_ = side - a_ * dot(a_, side);
    if (!(squared_length(b_) > parallel * squared_length(side))) {
      const Vec3f size{std::abs(a_.x), std::abs(a_.y), std::abs(a_.z)};
      const Vec3f least = size.x <= size.y && size.x <= size.z ? Vec3f{1, 0, 0}
                          : size.y <= size.z                   ? Vec3f{0, 1, 0}
                                                               : Vec3f{0, 0, 1};
      b_ = cross(a_, least);
    }
    // b is normalized twice: if it was a small difference, rounding has left it a share along a, and then distances
    // would change.
    b_ = normalized(b_, {0, 1, 0});
    b_ = normalized(b_ - a_ * dot(a_, b_), {0, 1, 0});
    c_ = cross(a_, b_);
  }
  static constexpr float parallel = 1e-12f;

  Vec3f coordinates(const Vec3& v) const { return Vec3f(Vec3{dot(v, Vec3(a_)), dot(v, Vec3(b_)), dot(v, Vec3(c_))}); }
  Vec3f place(const Vec3f& coordinates) const { return a_ * coordinates.x + b_ * coordinates.y + c_ * coordinates.z; }

 private:
  Vec3f a_, b_, c_;
};

}  // namespace morula::detail
