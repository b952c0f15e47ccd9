// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Only + − × ÷ and our own sine and cosine are used: the same bits everywhere.
#include <algorithm>
#include <cmath>
#include <morula/geometry/box.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/update/sample_motions.hpp>
#include <numbers>
#include <stdexcept>

#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

using std::numbers::pi;

Box box_along_x(std::span<const Vec3> rest) {
  Box box;
  for (const Vec3& p : rest) box.add(p);
  if (rest.empty() || !(box.extent().x > 0))
    throw std::invalid_argument("a sample motion needs positions that have a length along x");
  return box;
}

// Share from 0 to 1 over the frames; one frame alone is the first.
double share_of(std::size_t frame, std::size_t frame_count) {
  return frame_count < 2 ? 0.0 : static_cast<double>(frame) / static_cast<double>(frame_count - 1);
}

}  // namespace

Modes sample_modes(std::span<const Vec3> rest, std::size_t mode_count) {
  const StandardFloats standard;
  const Box box = box_along_x(rest);
  const double length = box.extent().x;
  Modes modes{rest.size(), mode_count, {}};
  modes.displacements.reserve(mode_count * rest.size());
  for (std::size_t j = 0; j < mode_count; ++j) {
    const std::size_t pair = j / 2, across = j % 2 == 0 ? 1 : 2;
    const auto half_waves = static_cast<double>(pair + 1);
    for (const Vec3& p : rest) {
      const auto [s, c] = sin_cos(half_waves * pi * ((p.x - box.lower.x) / length));
      const double slope = 0.1 * half_waves * pi * c;
      Vec3 u{-(p[across] - box.center()[across]) * slope, 0, 0};
      u[across] = 0.1 * length * s;
      modes.displacements.push_back(u);
    }
  }
  return modes;
}

std::vector<double> sample_coordinates(std::size_t mode_count, std::size_t frame_count) {
  const StandardFloats standard;
  std::vector<double> coordinates;
  coordinates.reserve(mode_count * frame_count);
  for (std::size_t frame = 0; frame < frame_count; ++frame)
    for (std::size_t j = 0; j < mode_count; ++j) {
      const double rate = static_cast<double>(j + 1);
      coordinates.push_back(sin_cos(2 * pi * rate * share_of(frame, frame_count)).sin / rate);
    }
  return coordinates;
}

Skin sample_skin(std::span<const Vec3> rest) {
  const StandardFloats standard;
  const Box box = box_along_x(rest);
  Skin skin{.bone_count = 2, .begin = {0}};
  for (const Vec3& p : rest) {
    const double share = (p.x - box.center().x) / box.extent().x;  // −1/2 … 1/2
    const double a = std::clamp(5 * share + 0.5, 0.0, 1.0);
    const double second = a * a * (3 - 2 * a);
    for (const std::uint32_t bone : {0u, 1u}) {
      const double weight = bone == 0 ? 1 - second : second;
      if (weight == 0) continue;
      skin.bones.push_back(bone);
      skin.weights.push_back(weight);
    }
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

std::vector<AffineTransform> sample_bones(std::span<const Vec3> rest, std::size_t frame_count) {
  const StandardFloats standard;
  const Vec3 joint = box_along_x(rest).center();
  std::vector<AffineTransform> transforms;
  transforms.reserve(2 * frame_count);
  for (std::size_t frame = 0; frame < frame_count; ++frame) {
    const double t = share_of(frame, frame_count);
    const auto [s, c] = sin_cos(pi / 3 * (1 - std::abs(2 * t - 1)));
    AffineTransform turn;
    turn.columns = {Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}};
    turn.translation = joint - turn.linear(joint);
    transforms.emplace_back();
    transforms.push_back(turn);
  }
  return transforms;
}

}  // namespace morula
