// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/rounding.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "platform/decimal.hpp"

namespace morula::robot {

namespace {

/// A number as a decimal with so many digits after the point, towards the nearest.
double in_decimals(double value, int digits) {
  char text[64];
  const auto written = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, digits);
  double result = value;
  platform::read_number(text, written.ptr, result);
  return result == 0 ? 0 : result;
}

/// direction: 1 outward, −1 inward.
void round_spheres(std::vector<Sphere>& spheres, double direction) {
  const double extent = extent_of(spheres);
  if (!(extent > 0)) return;
  const int digits = std::clamp(7 - static_cast<int>(std::floor(std::log10(extent))), 0, 30);
  const double step = std::pow(10.0, -digits), allowance = float_allowance(extent);
  for (Sphere& s : spheres) {
    const Vec3 moved{in_decimals(s.center.x, digits), in_decimals(s.center.y, digits), in_decimals(s.center.z, digits)};
    s.radius = in_decimals(s.radius + direction * distance(s.center, moved) + direction * allowance + direction * step,
                           digits);
    s.center = moved;
  }
}

}  // namespace

double float_allowance(double extent) {
  // A float is off by 2⁻²⁴ of a number: of three coordinates and of the radius.
  // mutant robot-rounding: `3 * 0x1p-24` -> `-1`
  return 3 * 0x1p-24 * extent;
}

double extent_of(std::span<const Sphere> spheres) {
  double extent = 0;
  for (const Sphere& s : spheres) extent = std::max(extent, max_norm(s.center) + s.radius);
  return extent;
}

void round_outward(std::vector<Sphere>& spheres) {
  round_spheres(spheres, 1);
}

void round_inward(std::vector<Sphere>& spheres) {
  // mutant robot-inner-inward: `-1` -> `1`
  round_spheres(spheres, -1);
  spheres.erase(std::remove_if(spheres.begin(), spheres.end(), [](const Sphere& s) { return !(s.radius > 0); }),
                spheres.end());
}

}  // namespace morula::robot
