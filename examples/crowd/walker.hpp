// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A walker of tubes with eleven bones: a spine, a head, two arms and two legs of two bones each.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/morula.hpp>
#include <numbers>
#include <vector>

namespace crowd {

using namespace morula;

/// A rotation about an axis through a point.
inline AffineTransform rotation_about(const Vec3& point, const Vec3& axis, double angle) {
  const RigidTransform r = RigidTransform::from_axis(axis, angle);
  AffineTransform t{{r.rotate({1, 0, 0}), r.rotate({0, 1, 0}), r.rotate({0, 0, 1})}, {}};
  t.translation = point - t.linear(point);
  return t;
}

class Walker {
 public:
  Mesh mesh;
  Skin skin{.bone_count = 11, .begin = {0}};

  /// around, rings: vertices of a ring of each of the six tubes, 3 or more, and rings, 2 or more.
  explicit Walker(std::uint32_t around = 12, std::uint32_t rings = 14) : around_(around), rings_(rings) {
    // Bones: pelvis 0, chest 1, head 2, then upper and lower arms 3 to 6, upper and lower legs 7 to 10.
    add_tube({0, 0.85, 0}, {0, 1.5, 0}, 0.16, {0, 1});
    add_tube({0, 1.45, 0}, {0, 1.8, 0}, 0.11, {1, 2});
    for (const int side : {0, 1}) {
      const double x = side == 0 ? 1 : -1;
      const auto arm = static_cast<std::uint32_t>(3 + 2 * side), leg = arm + 4;
      add_tube({0.16 * x, 1.42, 0}, {0.78 * x, 1.42, 0}, 0.06, {arm, arm + 1});
      add_tube({0.1 * x, 0.9, 0}, {0.1 * x, 0, 0}, 0.08, {leg, leg + 1});
    }
  }

  /// Transforms relative to rest. phase: of the stride, radians. lively: 0 for a calm walk to 1 for leaps with arms
  /// thrown about.
  void pose(double phase, double lively, std::vector<AffineTransform>& bones) const {
    const double stride = 0.6 * sin_cos(phase).sin;
    bones.resize(skin.bone_count);
    // The pelvis moves with the stride and leaps: the body leaves its place at rest.
    bones[0] = {};
    bones[0].translation = {0, 0.6 * lively * (1 - sin_cos(2 * phase).cos), 2.5 * lively * sin_cos(phase).cos};
    bones[1] = bones[0] * rotation_about({0, 1.1, 0}, {1, 0, 0}, 0.3 * lively);
    bones[2] = bones[1] * rotation_about({0, 1.55, 0}, {0, 1, 0}, 0.8 * stride);
    for (const int side : {0, 1}) {
      const double x = side == 0 ? 1 : -1, swing = x * stride;
      const auto arm = static_cast<std::size_t>(3 + 2 * side), leg = arm + 4;
      const double down = -1.4 + 2.6 * lively * (0.5 + 0.5 * sin_cos(2 * phase + x).sin);
      bones[arm] = bones[1] * rotation_about({0.16 * x, 1.42, 0}, {1, 0, 0}, swing) *
                   rotation_about({0.16 * x, 1.42, 0}, {0, 0, 1}, down * x);
      bones[arm + 1] = bones[arm] * rotation_about({0.47 * x, 1.42, 0}, {0, 1, 0}, -0.8 * x * (0.5 + lively));
      bones[leg] = bones[0] * rotation_about({0.1 * x, 0.9, 0}, {1, 0, 0}, -swing);
      bones[leg + 1] = bones[leg] * rotation_about({0.1 * x, 0.45, 0}, {1, 0, 0}, std::max(0.0, 1.2 * swing));
    }
  }

 private:
  // Closed, of two bones; the weights go over from one to the other in the middle third.
  void add_tube(const Vec3& from, const Vec3& to, double radius, std::array<std::uint32_t, 2> bones) {
    const std::uint32_t around = around_, rings = rings_;
    const Vec3 along = normalized(to - from);
    const Vec3 side = normalized(cross(along, std::abs(along.x) > 0.5 ? Vec3{0, 0, 1} : Vec3{1, 0, 0}));
    const Vec3 up = cross(along, side);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const auto add = [&](double share, double thickness, double angle) {
      const auto turn = sin_cos(angle);
      mesh.positions.push_back(from + (to - from) * share + side * (thickness * turn.cos) +
                               up * (thickness * turn.sin));
      const double second = std::clamp(3 * share - 1, 0.0, 1.0);
      for (const std::size_t k : {0, 1})
        if (const double weight = k == 0 ? 1 - second : second; weight > 0)
          skin.bones.push_back(bones[k]), skin.weights.push_back(weight);
      skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
    };
    add(0, 0, 0);
    for (std::uint32_t r = 0; r < rings; ++r)
      for (std::uint32_t k = 0; k < around; ++k) {
        const double share = (r + 0.5) / rings, round = std::min({1.0, share * 8, (1 - share) * 8});
        add(share, radius * std::sqrt(round * (2 - round)), 2 * std::numbers::pi * k / around);
      }
    add(1, 0, 0);
    const auto at = [&](std::uint32_t r, std::uint32_t k) { return first + 1 + r * around + k % around; };
    for (std::uint32_t k = 0; k < around; ++k) mesh.facets.push_back({first, at(0, k + 1), at(0, k)});
    for (std::uint32_t r = 0; r + 1 < rings; ++r)
      for (std::uint32_t k = 0; k < around; ++k) {
        mesh.facets.push_back({at(r, k), at(r + 1, k + 1), at(r + 1, k)});
        mesh.facets.push_back({at(r, k), at(r, k + 1), at(r + 1, k + 1)});
      }
    for (std::uint32_t k = 0; k < around; ++k)
      mesh.facets.push_back({at(rings - 1, k), at(rings - 1, k + 1), first + 1 + rings * around});
  }

  std::uint32_t around_, rings_;
};

}  // namespace crowd
