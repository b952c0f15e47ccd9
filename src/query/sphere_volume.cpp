// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ball ∩ object as a sum over facets of ball ∩ cone(center, facet), arranged so that no term is singular for any
// center. In units of the radius, with the center at the origin, a facet T in the plane n·x = H cuts the ball in D = T
// ∩ disc. Its cone inside the ball has three times the volume
//
//   H area(D) + s Ω(T) − s Ω(D),   s the sign of H, Ω the solid angle.
//
// The first and the difference of the others are sums over the border, by the angle φ about the foot of the center:
// area = ∫ ½ρ² dφ, and s Ω(T) − s Ω(D) = ∫ H/√(H² + ρ²) dφ along the arcs that D has instead of T's sides, minus the
// same integral along the replaced parts of the sides. On an arc of angle θ it is H θ, on a line at distance h from the
// foot g(t₂) − g(t₁) with tan g = H t / (h √(H² + h² + t²)). The replaced parts are outside the ball, so these are
// smooth.
//
// The facets that miss the ball contribute their solid angle. The index computes it roughly; with all the others it
// makes up a multiple of 4π, so the solid angles of the facets that meet the ball, modulo 2π, give the rest.
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/query/signed_distance.hpp>
#include <numbers>
#include <stdexcept>

#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

// A length that replaces zero where only the direction counts; its fourth power is still a normal number.
constexpr double next_to_nothing = 1e-50;

bool comes_before(const Vec3& a, const Vec3& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

// The line through a facet's side from a to b, which differ. Close to the line all terms depend on the direction from
// the center to it, and the two facets that share the side must use the same direction, or their solid angles would not
// match. Hence only the signs of `along` and `plane` depend on the order of a and b, and the nearest point is found
// from the nearer end, where it loses least.
struct Side {
  Vec3 along;          // unit direction from a to b
  Vec3 nearest;        // the point of the line nearest to the center
  Vec3 plane;          // normal of the plane through center, a and b, seen from the left of the side
  double first, last;  // a and b, as distances along the line from `nearest`
};

Side side_between(const Vec3& a, const Vec3& b) {
  Side side;
  side.along = normalized(b - a);
  side.first = dot(side.along, a);
  side.last = dot(side.along, b);
  const double to_a = squared_length(a), to_b = squared_length(b);
  const bool from_a = to_a != to_b ? to_a < to_b : comes_before(a, b);
  side.nearest = from_a ? a - side.along * side.first : b - side.along * side.last;
  // The line passes through the center up to rounding: the remainder points along the line.
  const double off_line = squared_length(side.nearest);
  side.nearest -= side.along * dot(side.along, side.nearest);
  if (!(squared_length(side.nearest) > 0.25 * off_line)) {
    const Vec3 forward = comes_before(a, b) ? side.along : -side.along;
    const bool mostly_x = std::abs(forward.x) > 0.5;
    side.nearest = normalized(cross(forward, mostly_x ? Vec3{0, 1, 0} : Vec3{1, 0, 0})) * next_to_nothing;
  }
  side.plane = cross(side.nearest, side.along);
  return side;
}

// Whether the center is so close to a side or corner, for the facet's size, that solid_angle has lost more than two
// digits: both arguments of its arctangent are then sums that cancel.
bool passes_closely(const Triangle& t) {
  const double a = length(t[0]), b = length(t[1]), c = length(t[2]);
  const double product = a * b * c;
  const double denominator = product + dot(t[0], t[1]) * c + dot(t[1], t[2]) * a + dot(t[2], t[0]) * b;
  return std::max(std::abs(denominator), std::abs(dot(t[0], cross(t[1], t[2])))) < 0.01 * product;
}

// Solid angle of the triangle modulo 2π, by the angles between the planes through the center and its sides: their sum
// less π. From behind all angles change their signs, and π is as good as −π.
double solid_angle_modulo_turn(const Triangle& corners, const std::array<Side, 3>& sides) {
  double sum = -std::numbers::pi;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &in = sides[(k + 2) % 3].plane, &out = -sides[k].plane;
    sum += angle_of(dot(corners[k], cross(out, in)), length(corners[k]) * dot(out, in));
  }
  return std::remainder(sum, 2 * std::numbers::pi);  // a sum over many facets must not grow, it would lose digits
}

// Angle between (x1, y1) and (x2, y2), 0…π.
double angle_between(double x1, double y1, double x2, double y2) {
  return angle_of(std::abs(x1 * y2 - x2 * y1), x1 * x2 + y1 * y2);
}

// The part of one side in H area(D) + s Ω(T) − s Ω(D). height is H, the same for all sides.
double part_of_cone(const Vec3& normal, double height, const Side& side) {
  const double signed_distance = dot(cross(side.along, normal), side.nearest);  // signed distance of the line from the
                                                                                // foot
  const double distance = std::abs(signed_distance);
  const double squared = squared_length(side.nearest);
  const auto replaced = [&](double t1, double t2) {
    if (!(t1 < t2)) return 0.0;
    const double to_1 = std::sqrt(squared + t1 * t1), to_2 = std::sqrt(squared + t2 * t2);
    const double arc = angle_between(distance, t1, distance, t2);
    const double line = angle_between(distance * to_1, height * t1, distance * to_2, height * t2);
    const double half_squared_disc_radius = 0.5 * (1 - height * height);
    const double sum = height * arc * (half_squared_disc_radius + 1) - (height < 0 ? -line : line);
    return signed_distance < 0 ? -sum : sum;
  };
  const double half_chord = squared < 1 ? std::sqrt(1 - squared) : 0;
  const double enter = std::max(side.first, -half_chord), leave = std::min(side.last, half_chord);
  if (!(enter < leave)) return replaced(side.first, side.last);
  return replaced(side.first, enter) + 0.5 * height * signed_distance * (leave - enter) + replaced(leave, side.last);
}

// Sums over the facets that meet the ball.
struct ConeSums {
  double cones = 0;        // H area(D) + s Ω(T) − s Ω(D)
  double solid_angle = 0;  // solid angle as the index computes it
  double modulo_turn = 0;  // the same angle, modulo 2π for facets that the center passes closely

  void add(const Triangle& t, const Sphere& ball);
};

void ConeSums::add(const Triangle& t, const Sphere& ball) {
  Triangle local;
  bool is_at_corner = false;
  for (std::size_t k = 0; k < 3; ++k) {
    local[k] = (t[k] - ball.center) / ball.radius;
    if (local[k] != Vec3{}) continue;
    // The center counts as next to the vertex, on the same side for all facets there.
    local[k] = Vec3{0.48, 0.62, 0.62} * next_to_nothing;
    is_at_corner = true;
  }
  // The same angle as in the index's sum, even if rounding has made one for a facet that has none.
  const double angle = morula::solid_angle(t, ball.center);
  solid_angle += angle;
  if (local[0] == local[1] || local[1] == local[2] || local[2] == local[0]) return;

  std::array<double, 3> squared;
  for (std::size_t k = 0; k < 3; ++k) squared[k] = squared_length(local[k]);
  const auto [nearest, farthest] = std::minmax_element(squared.begin(), squared.end());
  const Vec3 area_vector = morula::area_vector(local);
  const Vec3 normal = normalized(area_vector, Vec3{});
  // A facet that only touches the ball replaces its whole border and contributes nothing.
  const double height = std::clamp(dot(normal, local[static_cast<std::size_t>(nearest - squared.begin())]), -1.0, 1.0);

  const bool is_whole = *farthest <= 1;
  const bool is_passed_closely = is_at_corner || passes_closely(local);
  std::array<Side, 3> sides;
  if (!is_whole || is_passed_closely)
    for (std::size_t k = 0; k < 3; ++k) sides[k] = side_between(local[k], local[(k + 1) % 3]);

  modulo_turn += is_passed_closely ? solid_angle_modulo_turn(local, sides) : angle;
  if (is_whole)
    cones += 0.5 * height * length(area_vector);
  else
    for (const Side& side : sides) cones += part_of_cone(normal, height, side);
}

}  // namespace

double inside_volume(const SignedDistance& object, const Sphere& ball) {
  const StandardFloats standard;
  if (!(ball.radius > 0)) return 0;
  if (!has_usable_scale(ball)) throw std::invalid_argument("volume of a ball: it has a number beyond 1e30");
  // A ball so small counts as a point compared with the object's coordinates: in units of its radius they would
  // overflow.
  const Box& box = object.bvh().bounding_box();
  constexpr double smallest_share = 0x1p-60;
  if (!(ball.radius > smallest_share * std::max(max_norm(box.lower), max_norm(box.upper))))
    return object.is_inside(ball.center) ? volume(ball) : 0;
  std::vector<std::uint32_t> near;
  object.bvh().facets_touching(ball, near);
  if (near.empty() && object.has_volume()) return object.is_inside(ball.center) ? volume(ball) : 0;

  ConeSums sums;
  for (const std::uint32_t f : near) sums.add(object.bvh().triangle(f), ball);

  // The index sums the very same solid angles of the facets nearby, so their rounding errors when the center is on the
  // surface cancel in the difference. On an open surface the rest is unknown: the result is then the integral of the
  // winding number, as exact as the far field.
  constexpr double turn = 2 * std::numbers::pi;
  const auto far_solid_angle = [&](double accuracy) {
    return 2 * turn * object.bvh().winding_number(ball.center, accuracy) - sums.solid_angle;
  };
  double far = far_solid_angle(object.has_volume() ? 2 : 4);
  if (object.has_volume()) {
    double turns = (far + sums.modulo_turn) / turn;
    constexpr double safely_whole = 0.2;
    if (std::abs(turns - std::round(turns)) > safely_whole)
      turns = (far_solid_angle(std::numeric_limits<double>::infinity()) + sums.modulo_turn) / turn;
    far = turn * std::round(turns) - sums.modulo_turn;
  }
  const double share = object.orientation() * (far + sums.cones) / (2 * turn);
  return volume(ball) * std::clamp(share, 0.0, 1.0);
}

double outside_volume(const SignedDistance& object, const Sphere& ball) {
  const StandardFloats standard;
  return volume(ball) - inside_volume(object, ball);
}

}  // namespace morula
