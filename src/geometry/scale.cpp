// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <cmath>
#include <morula/geometry/scale.hpp>
#include <stdexcept>
#include <string>

namespace morula {
namespace {

// Fixed notation would print 0.000000 for very small numbers and 300 digits for very large ones.
std::string short_text(double x) {
  std::array<char, 32> digits;
  constexpr int figures = 3;
  const auto written =
      std::to_chars(digits.data(), digits.data() + digits.size(), x, std::chars_format::general, figures);
  return {digits.data(), written.ptr};
}

}  // namespace

void require_usable_scale(const MeshView& mesh) {
  const double largest = largest_coordinate(mesh);
  if (largest == 0 || (largest >= least_usable_scale && largest <= greatest_usable_scale)) return;
  throw std::invalid_argument("the mesh's largest coordinate is " + short_text(largest) +
                              ", and squares of its lengths would " + (largest < 1 ? "vanish" : "overflow") +
                              ": scale the mesh so that its largest coordinate is between " +
                              short_text(least_usable_scale) + " and " + short_text(greatest_usable_scale));
}

bool has_usable_scale(const Sphere& sphere) {
  // Comparisons that fail for NaN.
  const auto fits = [](double x) { return std::abs(x) <= greatest_usable_scale; };
  return fits(sphere.center.x) && fits(sphere.center.y) && fits(sphere.center.z) && sphere.radius >= 0 &&
         fits(sphere.radius);
}

double scaled_length(const Vec3& v) {
  // In this range no relevant term underflows or overflows, and the bits are those of the scaled sum: a square below
  // the least normal number is too small compared with the others to change how their sum is rounded.
  const double squared = squared_length(v);
  if (squared > 0x1p-800 && squared < 0x1p800) return std::sqrt(squared);
  const double largest = max_norm(v);
  if (!(largest > 0) || !is_finite(v)) return length(v);
  // Scales by a power of two, which changes no digit.
  const int exponent = std::ilogb(largest);
  const auto scaled = [&](double x) { return std::ldexp(x, -exponent); };
  return std::ldexp(length(Vec3{scaled(v.x), scaled(v.y), scaled(v.z)}), exponent);
}

}  // namespace morula
