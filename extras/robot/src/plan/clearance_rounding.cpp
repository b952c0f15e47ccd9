// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "plan/clearance_rounding.hpp"

#include <algorithm>
#include <cmath>

namespace morula::robot {
namespace {

constexpr double rounding_unit = 0x1p-53;
// Below any usable length: covers what underflow does to squares.
constexpr double least = 0x1p-500;

// Spectral norm of a matrix, at most: |R Rᵀ - I| ≤ 3 × its largest entry.
double stretch_of(const RigidTransform& t) {
  const double deviation = deviation_from_rigid(t);
  if (deviation < 1) return std::sqrt(1 + 3 * deviation) * (1 + 4 * rounding_unit);
  double squared = 0;
  for (const Vec3& row : t.rows) squared += squared_length(row);
  return std::max(1.0, std::sqrt(squared) * (1 + 8 * rounding_unit));
}

}  // namespace

PoseRounding::PoseRounding(const ConfigurationQuery::Model& model) : model_(model), stretch_(model.link_names.size()) {
  stretch_[model.root] = stretch_of(model.base);
  for (const JointStep& step : model.steps) {
    length_of_origin_.push_back(length(step.origin.translation));
    length_of_axis_.push_back(length(step.axis));
    stretch_of_origin_.push_back(stretch_of(step.origin));
    stretch_[step.child] = stretch_[step.parent] * stretch_of_origin_.back() * (1 + 4 * rounding_unit);
  }
  for (const MovingSpheres& group : model.groups) {
    double far = 0;
    for (const Sphere& s : group.spheres) far = std::max(far, length(s.center));
    farthest_.push_back(far);
  }
}

// A product of 3 x 3 matrices with Frobenius norms of √3 × stretch is off by at most 9.1 units × the stretches; a pose
// applied to a vector of length L is off by at most 7 units × (stretch × L + its translation). A rotation by an angle v
// has entries with errors of at most 16 units, hence a norm of 48, besides the error of the angle itself: two roundings
// of factor × value + offset, and the reduction by multiples of π / 2, are within 8 units × the size of these terms.
// What follows doubles these sums, so that its own rounding does not matter.
double PoseRounding::largest(std::span<const double> values, std::span<const RigidTransform> poses,
                             std::span<Error> errors) const {
  errors[model_.root] = {};
  for (std::size_t i = 0; i < model_.steps.size(); ++i) {
    const JointStep& step = model_.steps[i];
    const bool turns = step.kind == Joint::Kind::revolute || step.kind == Joint::Kind::continuous;
    const bool slides = step.kind == Joint::Kind::prismatic;
    double size = 0;
    if (turns || slides) {
      size = std::abs(step.offset);
      if (step.coordinate != none) size += std::abs(step.factor * values[step.coordinate]);
    }
    const Error& before = errors[step.parent];
    const double stretch = stretch_[step.child];
    const double slide = slides ? size * length_of_axis_[i] : 0;
    const double arm = length_of_origin_[i] + slide;
    const Vec3& t = poses[step.child].translation;
    Error& after = errors[step.child];
    after.turned = before.turned * stretch_of_origin_[i] + rounding_unit * stretch * (turns ? 128 + 16 * size : 32);
    after.moved = before.moved + 2 * before.turned * stretch_of_origin_[i] * arm +
                  32 * rounding_unit * (stretch * arm + max_norm(t)) + least;
  }
  double largest = 0;
  for (std::size_t k = 0; k < model_.groups.size(); ++k) {
    const std::size_t link = model_.groups[k].link;
    const double far = stretch_[link] * farthest_[k];
    // mutant robot-clearance-turned: `2 * errors[link].turned * farthest_[k]` -> `0`
    const double moved = errors[link].moved + 2 * errors[link].turned * farthest_[k];
    largest = std::max(largest, moved + 16 * rounding_unit * (far + max_norm(poses[link].translation)));
  }
  return largest;
}

}  // namespace morula::robot
