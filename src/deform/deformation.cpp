// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Stretch, twist and bend after [barr1984]. Equal bits on all machines are promised: sine, cosine and power are our
// own, not the library's.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <morula/deform/deformation.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/scale.hpp>
#include <numbers>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr double most_turning_degrees = 36000;  // sin_cos is exact enough up to 1000 radians; this is 628

// At most six digits, the same in every locale: "90", "0.05", "1e-06".
std::string format_number(double value) {
  char text[32];
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 6);
  return std::string(text, end.ptr);
}

// "x", "y" or "z".
std::string axis_name(int axis) {
  return std::string(1, "xyz"[axis]);
}

// NaN is in no range.
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

// Throws std::invalid_argument naming the deformation, the parameter, its value and the range.
void require_in_range(const Deformation& deformation) {
  std::visit(RequireInRange{}, deformation);
}

constexpr double pi = std::numbers::pi;
constexpr double radians_per_degree = pi / 180;

// Measures of the rest mesh that deformations use.
struct Rest {
  MeshView mesh;
  Box box;
  Vec3 center;
  double diagonal;

  explicit Rest(const MeshView& m) : mesh(m), box(bounding_box(m)), center(box.center()), diagonal(box.diagonal()) {}
};

// The axis and the two across it, in the order that keeps orientation; x means x, y, z.
struct Axes {
  int along, across, third;

  Axes(Axis axis, const Rest& rest)
      : along(axis == Axis::automatic ? rest.box.longest_axis() : static_cast<int>(axis)),
        across((along + 1) % 3),
        third((along + 2) % 3) {}
};

// Unused vertices may have any values; values that are not finite stay unchanged.
template <class Move>
void move_each(std::vector<Vec3>& positions, Move&& move) {
  detail::InterruptPoller poll_interrupt(4096);
  for (Vec3& p : positions) {
    poll_interrupt();
    if (is_finite(p)) move(p);
  }
}

// base^exponent for base > 0: whole powers by multiplication, the binary digits of the rest by square roots, which
// every machine rounds alike. Exponents 0, ½ and 1 take at most one rounding.
double power(double base, double exponent) {
  if (exponent < 0) return 1 / power(base, -exponent);
  double result = 1;
  for (; exponent >= 1; exponent -= 1) result *= base;
  double root = base;
  for (; exponent > 0; exponent *= 2) {
    if (exponent >= 1) {
      result *= root;
      exponent -= 1;
    }
    root = std::sqrt(root);
  }
  return result;
}

void apply(const Stretch& stretch, const Rest& rest, double t, std::vector<Vec3>& positions) {
  const Axes axes(stretch.axis, rest);
  const double factor = 1 + t * (stretch.factor - 1);
  const double across = power(factor, -stretch.shrink);
  Vec3 scale{across, across, across};
  scale[axes.along] = factor;
  move_each(positions, [&](Vec3& p) {
    const Vec3 v = p - rest.center;
    p = rest.center + Vec3{scale.x * v.x, scale.y * v.y, scale.z * v.z};
  });
}

// Rotates p about the line through `center` along axes.along.
void turn(Vec3& p, const Axes& axes, const Vec3& center, const SinCos& angle) {
  const double v = p[axes.across] - center[axes.across], w = p[axes.third] - center[axes.third];
  p[axes.across] = center[axes.across] + (angle.cos * v - angle.sin * w);
  p[axes.third] = center[axes.third] + (angle.sin * v + angle.cos * w);
}

void apply(const Rotate& rotate, const Rest& rest, double t, std::vector<Vec3>& positions) {
  const Axes axes(rotate.axis, rest);
  const SinCos angle = sin_cos(t * rotate.degrees * radians_per_degree);
  move_each(positions, [&](Vec3& p) { turn(p, axes, rest.center, angle); });
}

double extent_along(const Axes& axes, const Rest& rest, const Deformation& deformation) {
  const double extent = rest.box.extent()[axes.along];
  if (extent > 0) return extent;
  throw std::invalid_argument(describe(deformation) + ": the mesh has no extent along " + axis_name(axes.along));
}

void apply(const Twist& twist, const Rest& rest, double t, std::vector<Vec3>& positions) {
  const Axes axes(twist.axis, rest);
  const double extent = extent_along(axes, rest, twist), first = rest.box.lower[axes.along];
  const double full_angle = t * twist.degrees * radians_per_degree;
  move_each(positions, [&](Vec3& p) {
    const double share = std::clamp((p[axes.along] - first) / extent, 0.0, 1.0);
    turn(p, axes, rest.center, sin_cos(full_angle * share));
  });
}

// Radians per unit of length.
double curvature(const Bend& bend, const Axes& axes, const Rest& rest, double t) {
  return t * bend.degrees * radians_per_degree / extent_along(axes, rest, bend);
}

// The bend maps a point at v across the axis to distance 1/k − v from the center of the arc: beyond it, space would be
// inverted.
void require_no_fold(const Bend& bend, const Rest& rest, double t, const std::vector<Vec3>& positions) {
  const Axes axes(bend.axis, rest);
  const double k = curvature(bend, axes, rest, t);
  double reach = 0;
  for (const Facet& f : rest.mesh.facets)
    for (const std::uint32_t v : f) {
      const double offset = positions[v][axes.across] - rest.center[axes.across];
      reach = std::max(reach, k < 0 ? -offset : offset);
    }
  if (std::abs(k) * reach < 1) return;
  const double limit = extent_along(axes, rest, bend) / reach / radians_per_degree;
  // Rounded to three decimals, downwards and strictly below the limit, so that the named angle works.
  const double works = (std::ceil(limit * 1000) - 1) / 1000;
  throw std::invalid_argument("bend of " + format_number(t * bend.degrees) + " degrees along " + axis_name(axes.along) +
                              ": the body reaches " + format_number(reach) +
                              " across the axis and would fold over itself; at most " + format_number(works) +
                              " degrees work");
}

void apply(const Bend& bend, const Rest& rest, double t, std::vector<Vec3>& positions) {
  const Axes axes(bend.axis, rest);
  const double k = curvature(bend, axes, rest, t);
  const double first = rest.box.lower[axes.along], last = rest.box.upper[axes.along];
  // Nothing moves by more than an eighth of this angle times the extent: below rounding, and 1/k stays finite.
  if (std::abs(k) * (last - first) < 1e-15) return;
  const double middle = rest.center[axes.along], base = rest.center[axes.across];
  move_each(positions, [&](Vec3& p) {
    const double v = p[axes.across] - base;
    const double inside = std::clamp(p[axes.along], first, last), beyond = p[axes.along] - inside;
    // With half angles R (1 − cos θ) = 2 R sin² θ/2 keeps its digits where R is large and θ small.
    const auto [half_sin, half_cos] = sin_cos(0.5 * k * (inside - middle));
    const double sin = 2 * half_sin * half_cos, one_minus_cos = 2 * half_sin * half_sin, cos = 1 - one_minus_cos;
    p[axes.along] = middle + (sin / k - v * sin) + beyond * cos;
    p[axes.across] = base + (one_minus_cos / k + v * cos) + beyond * sin;
  });
}

void apply(const Poke& poke, const Rest& rest, double t, std::vector<Vec3>& positions) {
  const Vec3 size = rest.box.extent();
  const Vec3 center = rest.box.lower + Vec3{poke.center.x * size.x, poke.center.y * size.y, poke.center.z * size.z};
  const Vec3 push = poke.push * (t * rest.diagonal);
  const double radius = poke.radius * rest.diagonal;
  move_each(positions, [&](Vec3& p) {
    const double squared = squared_distance(p, center) / (radius * radius);
    // A mesh without extent has squared = 0/0 here and keeps its place.
    if (!(squared < 1)) return;
    const double rest_of_one = 1 - squared;
    p += push * (rest_of_one * rest_of_one * rest_of_one);
  });
}

Vec3 random_direction(Random& random) {
  const double z = random.uniform(-1, 1);
  const auto [s, c] = sin_cos(random.uniform(0, 2 * pi));
  const double ring = std::sqrt(1 - z * z);
  return {ring * c, ring * s, z};
}

void apply(const Noise& noise, const Rest& rest, double t, std::vector<Vec3>& positions) {
  // Amplitudes are proportional to wavelengths and sum to 1, so that all waves are equally steep and the displacement
  // is bounded by noise.amplitude.
  struct Wave {
    Vec3 push, per_unit;
    double phase;
  };
  constexpr std::array<double, 6> lengths{1.0, 1.5, 2.0, 2.5, 3.0, 3.5};
  constexpr double length_sum = 13.5;
  std::array<Wave, lengths.size()> waves;
  Random random(noise.seed);
  for (std::size_t w = 0; w < waves.size(); ++w) {
    const Vec3 push = random_direction(random), across = random_direction(random);
    waves[w].push = push * (t * noise.amplitude * rest.diagonal * lengths[w] / length_sum);
    waves[w].per_unit = across * (2 * pi / (noise.wavelength * lengths[w] * rest.diagonal));
    waves[w].phase = random.uniform(0, 2 * pi);
  }
  // Only vertices a million diagonals away get such phases; there sine has no digits left, and for a mesh without
  // extent it has no meaning.
  constexpr double largest_phase = 1e9;
  move_each(positions, [&](Vec3& p) {
    const Vec3 from_center = p - rest.center;
    for (const Wave& wave : waves) {
      const double phase = dot(wave.per_unit, from_center) + wave.phase;
      if (std::abs(phase) <= largest_phase) p += wave.push * sin_cos(phase).sin;
    }
  });
}

void apply_to(std::vector<Vec3>& positions, const Deformation& deformation, const Rest& rest, double t) {
  if (const Bend* bend = std::get_if<Bend>(&deformation)) require_no_fold(*bend, rest, t, positions);
  std::visit([&](const auto& d) { apply(d, rest, t, positions); }, deformation);
}

}  // namespace

std::string describe(const Deformation& deformation) {
  return std::visit(Describe{}, deformation);
}

std::vector<Vec3> deform(const MeshView& rest_mesh, const Deformations& deformations, double t) {
  const StandardFloats standard;
  if (!(t >= 0 && t <= 1)) throw std::invalid_argument("deformation parameter " + format_number(t) + " is not in 0…1");
  for (const Deformation& deformation : deformations) require_in_range(deformation);
  require_usable_scale(rest_mesh);
  const Rest rest(rest_mesh);

  // A deformation that cannot reach its full amount fails on the first frame of a motion, not halfway. Twists and bends
  // can fail.
  std::size_t checked = t < 1 ? deformations.size() : 0;
  while (checked > 0 && !std::holds_alternative<Twist>(deformations[checked - 1]) &&
         !std::holds_alternative<Bend>(deformations[checked - 1]))
    --checked;
  std::vector<Vec3> positions = rest_mesh.positions.to_vector();
  for (std::size_t i = 0; i < checked; ++i) apply_to(positions, deformations[i], rest, 1.0);

  positions = rest_mesh.positions.to_vector();
  if (t == 0) return positions;
  for (const Deformation& deformation : deformations) apply_to(positions, deformation, rest, t);
  for (const Facet& f : rest_mesh.facets)
    for (const std::uint32_t v : f)
      if (!is_finite(positions[v]))
        throw std::invalid_argument("the deformations together take vertex " + std::to_string(v) +
                                    " out of the range of numbers");
  return positions;
}

}  // namespace morula
