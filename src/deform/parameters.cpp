// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "deform/parameters.hpp"

#include <charconv>
#include <stdexcept>

namespace morula {
using namespace detail;
namespace {

constexpr double most_turning_degrees = 36000;  // sin_cos is exact enough up to 1000 radians; this is 628

// Not a number is in no range.
void require(const std::string& what, double value, double lowest, double highest) {
  if (value >= lowest && value <= highest) return;
  throw std::invalid_argument(what + " " + format_number(value) + " is not in " + format_number(lowest) + "…" +
                              format_number(highest));
}

void require(const std::string& what, const Vec3& value, double lowest, double highest) {
  for (int axis = 0; axis < 3; ++axis) require(what + " " + axis_name(axis), value[axis], lowest, highest);
}

struct RequireInRange {
  void operator()(const Stretch& s) const {
    require("stretch factor", s.factor, 0.001, 1000);
    require("stretch shrink", s.shrink, -1, 2);
  }
  void operator()(const Twist& t) const {
    require("twist degrees", t.degrees, -most_turning_degrees, most_turning_degrees);
  }
  void operator()(const Bend& b) const { require("bend degrees", b.degrees, -360, 360); }
  void operator()(const Poke& p) const {
    require("poke center", p.center, -10, 10);
    require("poke push", p.push, -10, 10);
    require("poke radius", p.radius, 0.001, 10);
  }
  void operator()(const Noise& n) const {
    require("noise amplitude", n.amplitude, 0, 1);
    require("noise wavelength", n.wavelength, 0.01, 10);
  }
  void operator()(const Rotate& r) const {
    require("rotate degrees", r.degrees, -most_turning_degrees, most_turning_degrees);
  }
};

std::string with_axis(const std::string& text, Axis axis) {
  return axis == Axis::automatic ? text : text + " " + axis_name(static_cast<int>(axis));
}

struct Describe {
  std::string operator()(const Stretch& s) const { return with_axis("stretch " + format_number(s.factor), s.axis); }
  std::string operator()(const Twist& t) const { return with_axis("twist " + format_number(t.degrees), t.axis); }
  std::string operator()(const Bend& b) const { return with_axis("bend " + format_number(b.degrees), b.axis); }
  std::string operator()(const Poke& p) const { return "poke " + format_number(length(p.push)); }
  std::string operator()(const Noise& n) const { return "noise " + format_number(n.amplitude); }
  std::string operator()(const Rotate& r) const { return with_axis("rotate " + format_number(r.degrees), r.axis); }
};

}  // namespace

void detail::require_in_range(const Deformation& deformation) {
  std::visit(RequireInRange{}, deformation);
}

std::string detail::format_number(double value) {
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 6);
  return std::string(text, end.ptr);
}

std::string detail::axis_name(int axis) {
  return std::string(1, "xyz"[axis]);
}

std::string describe(const Deformation& deformation) {
  return std::visit(Describe{}, deformation);
}

}  // namespace morula
