// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/haptic/tool_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace morula::detail {
namespace {

std::array<Vec3, 3> cholesky(const std::array<Vec3, 3>& a) {
  std::array<Vec3, 3> l{};
  l[0].x = std::sqrt(a[0].x);
  l[1].x = a[1].x / l[0].x, l[1].y = std::sqrt(a[1].y - l[1].x * l[1].x);
  l[2].x = a[2].x / l[0].x, l[2].y = (a[2].y - l[2].x * l[1].x) / l[1].y;
  l[2].z = std::sqrt(a[2].z - l[2].x * l[2].x - l[2].y * l[2].y);
  return l;
}

Vec3 lower_transposed(const std::array<Vec3, 3>& l, const Vec3& v) {
  return v.x * l[0] + v.y * l[1] + v.z * l[2];
}
Vec3 solve_lower(const std::array<Vec3, 3>& l, const Vec3& v) {
  const double x = v.x / l[0].x, y = (v.y - l[1].x * x) / l[1].y;
  return {x, y, (v.z - l[2].x * x - l[2].y * y) / l[2].z};
}
Vec3 solve_lower_transposed(const std::array<Vec3, 3>& l, const Vec3& v) {
  const double z = v.z / l[2].z, y = (v.y - l[2].y * z) / l[1].y;
  return {(v.x - l[1].x * y - l[2].x * z) / l[0].x, y, z};
}

}  // namespace

// Masses are volumes relative to the largest ball. A tool on a line gets a little inertia about it, so that its
// rotation about the line is determined: it follows the device.
ToolShape::ToolShape(std::span<const Sphere> balls) {
  double largest = 0;
  for (const Sphere& ball : balls) largest = std::max(largest, ball.radius);
  const auto mass = [&](double radius) {
    const double share = largest > 0 ? radius / largest : 1;
    return share * share * share;
  };
  double total = 0;
  for (const Sphere& ball : balls) total += mass(ball.radius);
  for (const Sphere& ball : balls) center_ += (mass(ball.radius) / total) * ball.center;
  std::array<Vec3, 3> sum{};
  for (const Sphere& ball : balls) {
    const Vec3 a = ball.center - center_;
    arms_.push_back(a), radii_.push_back(ball.radius);
    arm_reach_ = std::max(arm_reach_, length(a) * (1 + 0x1p-50));
    reach_ = std::max(reach_, (length(a) + ball.radius) * (1 + 0x1p-50));
    const double share = mass(ball.radius) / total, own = 0.4 * ball.radius * ball.radius + squared_length(a);
    sum[0] += share * (Vec3{own, 0, 0} - a.x * a);
    sum[1] += share * (Vec3{0, own, 0} - a.y * a);
    sum[2] += share * (Vec3{0, 0, own} - a.z * a);
  }
  // The square of a smaller reach underflows. Such a tool is a point, whose rotation is free.
  const double least = reach_ > 0x1p-480 ? 1e-4 * reach_ * reach_ : 1;
  sum[0].x += least, sum[1].y += least, sum[2].z += least;
  lower_ = cholesky(sum);
}

void ToolShape::place(const ToolPose& pose, std::vector<Vec3>& centers) const {
  const RigidTransform rows = pose.rotation.rows();
  centers.resize(size());
  for (std::size_t k = 0; k < size(); ++k) centers[k] = ball(k, rows, pose);
}

double ToolShape::turn_of_sag(double sag) const {
  return arm_reach_ > 0 ? std::sqrt(8 * sag / arm_reach_) : std::numeric_limits<double>::infinity();
}

Motion ToolShape::to_metric(const RigidMotion& m, const RigidTransform& rows) const {
  const Vec3 shift = rows.inverse_rotate(m.shift), turn = lower_transposed(lower_, rows.inverse_rotate(m.turn));
  return {shift.x, shift.y, shift.z, turn.x, turn.y, turn.z};
}

RigidMotion ToolShape::from_metric(const Motion& m, const RigidTransform& rows) const {
  return {rows.rotate({m[0], m[1], m[2]}), rows.rotate(solve_lower_transposed(lower_, {m[3], m[4], m[5]}))};
}

Motion ToolShape::row(std::size_t ball, const Vec3& normal, const RigidTransform& rows) const {
  const Vec3 n = rows.inverse_rotate(normal), turn = solve_lower(lower_, cross(arms_[ball], n));
  return {n.x, n.y, n.z, turn.x, turn.y, turn.z};
}

Vec3 ToolShape::inertia(const Vec3& turn, const RigidTransform& rows) const {
  const Vec3 v = lower_transposed(lower_, rows.inverse_rotate(turn));
  return rows.rotate({dot(lower_[0], v), dot(lower_[1], v), dot(lower_[2], v)});
}

}  // namespace morula::detail
