// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "plan/motion_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/reproducible.hpp>

namespace morula::robot {
namespace {

constexpr double unit = 0x1p-53;

double value_at(const MotionFrame& joint, double coordinate) {
  return joint.factor * coordinate + joint.offset;
}

}  // namespace

void interpolate(std::span<const double> from, std::span<const double> to, double time, std::span<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = time == 1 ? to[i] : from[i] + time * (to[i] - from[i]);
}

MotionBounds::MotionBounds(const MotionBodies& bodies, const RigidTransform& base)
    : bodies_(bodies),
      frames_(bodies.frames.size()),
      sums_(bodies.chains.size()),
      placed_(bodies.nodes.size()),
      relative_(bodies.pairs.size()),
      placed_in_(bodies.nodes.size(), 0),
      related_in_(bodies.pairs.size(), 0) {
  frames_[0].rows = base.rows;
  frames_[0].at = base.translation;
  // Rotations that are not exact stretch lengths by as much as they deviate, and the axes of joints with them. All sums
  // below are of positive terms, of fewer than a thousand roundings each.
  deviation_ = 16 * (bodies.deviation + deviation_from_rigid(base));
  slack_ = 1 + 1e-12 + deviation_;
}

void MotionBounds::set_edge(std::span<const double> from, std::span<const double> to) {
  from_ = from, to_ = to;
  double lengths = length(frames_[0].at) + bodies_.reach, angles = 0;
  for (std::size_t f = 1; f < bodies_.frames.size(); ++f) {
    const MotionFrame& joint = bodies_.frames[f];
    const double farthest = std::max(std::abs(from[joint.coordinate]), std::abs(to[joint.coordinate]));
    const double value = std::abs(joint.factor) * farthest + std::abs(joint.offset);
    if (joint.slides)
      lengths += joint.length * value;
    else
      angles += value;
  }
  reach_ = slack_ * lengths;
  // A place is a product of a matrix for each joint, and sums of vectors of at most `reach_`. A matrix is off by less
  // than 32 units for its entries and products, and by 8 units of its angle for the roundings of that angle; the same
  // holds for the check of one configuration, which places links by its own steps. Velocities are differences of terms
  // of at most angles × reach_, and assume exact rotations.
  const double joints = static_cast<double>(bodies_.frames.size()) + 4;
  // mutant robot-motion-rounding: `unit * (128` -> `0 * (128`
  allowance_ = reach_ * (unit * (128 * joints + 64 * angles) + deviation_ * (1 + angles));
}

void MotionBounds::set_part(double middle, double half) {
  ++part_;
  for (std::size_t f = 1; f < frames_.size(); ++f) {
    const MotionFrame& joint = bodies_.frames[f];
    const Frame& parent = frames_[joint.parent];
    Frame& own = frames_[f];
    const double start = from_[joint.coordinate], change = to_[joint.coordinate] - start;
    const double value = value_at(joint, start + middle * change);
    const double delta = joint.factor * change * half;
    std::array<Vec3, 3> local = joint.fixed;
    Vec3 origin = joint.origin;
    if (joint.slides) {
      const Vec3 moved = value * joint.axis;
      origin += Vec3{dot(local[0], moved), dot(local[1], moved), dot(local[2], moved)};
    } else {
      const SinCos turn = sin_cos(value);
      for (std::size_t i = 0; i < 3; ++i) local[i] += turn.sin * joint.odd[i] + (1 - turn.cos) * joint.even[i];
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& row = parent.rows[i];
      own.rows[i] = row.x * local[0] + row.y * local[1] + row.z * local[2];
      own.at[static_cast<int>(i)] = dot(row, origin) + parent.at[static_cast<int>(i)];
    }
    own.axis = {dot(own.rows[0], joint.axis), dot(own.rows[1], joint.axis), dot(own.rows[2], joint.axis)};
    own.angle = std::abs(delta);
    own.angles = parent.angles + (joint.slides ? 0 : own.angle);
    own.turn = joint.slides ? parent.turn : parent.turn + delta * own.axis;
    own.slide = parent.slide + delta * (joint.slides ? own.axis : cross(own.at, own.axis));
  }
}

void MotionBounds::measure(std::uint32_t index) {
  const MotionBody& body = bodies_.bodies[index];
  const Vec3 p = placed_[body.root].center;
  Sums sums;
  for (std::uint32_t i = body.first; i < body.first + body.joints; ++i) {
    const std::uint32_t f = bodies_.chains[i];
    const MotionFrame& joint = bodies_.frames[f];
    const Frame& frame = frames_[f];
    const double before = frames_[joint.parent].angles;
    if (joint.slides) {
      const double moved = frame.angle * joint.length;
      sums.arms += moved;
      sums.bends += moved * 2 * before;
      sums.first += moved;
    } else {
      const double arm = length(cross(frame.axis, p - frame.at)) + body.spread, far = arm + sums.first;
      sums.arms += frame.angle * far;
      // mutant robot-motion-bend: `far * frame.angle` -> `0 * frame.angle`
      sums.bends += far * frame.angle * (frame.angle + 2 * before);
      // mutant robot-motion-first: `* arm` -> `* 0.5 * arm`
      sums.first += std::min(frame.angle, 2.0) * arm;
    }
    sums_[i] = sums;
  }
}

MotionBounds::Relative MotionBounds::bounds_of(const MotionBody& body, std::uint32_t joints) const {
  if (joints == 0) return {};
  const std::uint32_t last = body.first + joints - 1;
  const Frame& base = frames_[bodies_.frames[bodies_.chains[last]].parent];
  const Sums& sums = sums_[last];
  // Joints below the last one that counts are not of the double sum.
  const double bends = std::max(0.0, sums.bends - 2 * base.angles * sums.arms) + 1e-14 * sums.bends;
  return {.bend = 0.5 * slack_ * bends, .first = slack_ * sums.first};
}

void MotionBounds::place(std::uint32_t index) {
  placed_in_[index] = part_;
  const MotionNode& node = bodies_.nodes[index];
  const MotionBody& body = bodies_.bodies[node.body];
  const Frame& frame = frames_[body.frame];
  const Vec3& p = node.sphere.center;
  Placed& own = placed_[index];
  own.center = Vec3{dot(frame.rows[0], p), dot(frame.rows[1], p), dot(frame.rows[2], p)} + frame.at;
  own.velocity = frame.slide + cross(frame.turn, own.center);
  own.speed = length(own.velocity) * (1 + 1e-12);
  if (index == body.root) {
    measure(node.body);
    const Relative bounds = bounds_of(body, body.joints);
    own.bend = bounds.bend, own.first = bounds.first;
  } else {
    const Placed& root = placed(body.root);
    own.bend = root.bend, own.first = root.first;
  }
}

void MotionBounds::relate(std::uint32_t index) {
  related_in_[index] = part_;
  const MotionPair& pair = bodies_.pairs[index];
  const MotionBody &a = bodies_.bodies[pair.a], &b = bodies_.bodies[pair.b];
  placed(a.root), placed(b.root);
  const Relative of_a = bounds_of(a, pair.joints_a), of_b = bounds_of(b, pair.joints_b);
  relative_[index] = {.bend = of_a.bend + of_b.bend, .first = of_a.first + of_b.first};
}

double MotionBounds::Placed::bound() const {
  return std::min(speed + bend, first);
}

}  // namespace morula::robot
