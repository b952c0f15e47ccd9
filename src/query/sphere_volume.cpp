// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ball ∩ object as a sum over facets of ball ∩ cone(centre, facet), ALGORITHMS A.5, in a form without case distinctions
// on where the centre's foot lies. In units of the radius, with the centre at the origin:
//
// A facet in the plane n·x = H, |H| < 1, cuts the ball in a disc; D is the part of the disc in the facet. Its cone has
// volume (H area(D) − s Ω(D)) / 3, s the sign of H, besides the solid angle of the whole facet over 3, and these add up
// to 4π/3 or 0. Going around D in its plane, by the angle φ about the foot, area and solid angle are integrals of ½ρ²
// and 1 − |H|/√(H² + ρ²). So s Ω(D) is a multiple of 2π less ∫ H/√(H² + ρ²) dφ, which is elementary on each piece of
// the border:
//   circle, angle θ                    H θ
//   line at distance h, from t₁ to t₂   g(t₂) − g(t₁) with tan g = H t / (h √(H² + h² + t²))
// The multiples of 2π of all facets and the 4π of the centre leave one whole number for the ball. It is what the far
// facets' solid angle lacks, and that needs to be known only to a quarter of a turn.
#include <algorithm>
#include <cmath>
#include <morula/query/sphere_volume.hpp>
#include <numbers>

namespace morula {
namespace {

// Stands in for a length of zero where only its direction counts; its fourth power is still a normal number.
constexpr double next_to_nothing = 1e-50;

bool comes_before(const Vec3& a, const Vec3& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

// Angle between (x1, y1) and (x2, y2), 0…π.
double angle_between(double x1, double y1, double x2, double y2) {
  return std::atan2(std::abs(x1 * y2 - x2 * y1), x1 * x2 + y1 * y2);
}

// The line through a facet's side from a to b. Close to the line everything depends on the direction from the centre to
// it, and the two facets that share the side must see the same one, or their angles would not add up. Hence nothing
// here depends on the order of a and b but the sign of `along`, and lengths are measured from the nearer end, where
// they have lost least.
struct Side {
  Vec3 along;    // unit, from a to b
  Vec3 nearest;  // point of the line nearest to the centre
  double first, last;
};

Side side_of(const Vec3& a, const Vec3& b) {
  Side side;
  side.along = normalized(b - a);
  side.first = dot(side.along, a);
  side.last = dot(side.along, b);
  const double to_a = squared_length(a), to_b = squared_length(b);
  const bool from_a = to_a != to_b ? to_a < to_b : comes_before(a, b);
  side.nearest = from_a ? a - side.along * side.first : b - side.along * side.last;
  if (side.nearest == Vec3{}) {
    const Vec3 forward = comes_before(a, b) ? side.along : -side.along;
    const bool mostly_x = std::abs(forward.x) > 0.5;
    side.nearest = normalized(cross(forward, mostly_x ? Vec3{0, 1, 0} : Vec3{1, 0, 0})) * next_to_nothing;
  }
  return side;
}

// ∫ H/√(H² + ρ²) dφ about the foot, and H × area; over all of the facet and over its part in the ball.
struct Sums {
  double whole_angle = 0;
  double inside = 0;
};

void add_side(const Vec3& normal, const Side& side, Sums& sums) {
  const double height = dot(normal, side.nearest);
  const double signed_distance = dot(cross(side.along, normal), side.nearest);
  const double distance = std::abs(signed_distance);  // of the line from the foot
  const double turn = signed_distance < 0 ? -1 : 1;
  const double squared = squared_length(side.nearest);

  const auto line_angle = [&](double t1, double t2) {
    const double to_1 = std::sqrt(squared + t1 * t1), to_2 = std::sqrt(squared + t2 * t2);
    const double angle = angle_between(distance * to_1, height * t1, distance * to_2, height * t2);
    return turn * (height < 0 ? -angle : angle);
  };
  const auto add_arc = [&](double t1, double t2) {
    if (!(t1 < t2)) return;
    // Half the squared radius of the disc for the area, and 1 for the angle, both times H.
    const double theta = turn * angle_between(distance, t1, distance, t2);
    sums.inside += theta * height * (1.5 - 0.5 * height * height);
  };

  const double half_chord = squared < 1 ? std::sqrt(1 - squared) : 0;
  const double enter = std::max(side.first, -half_chord), leave = std::min(side.last, half_chord);
  const double whole = line_angle(side.first, side.last);
  sums.whole_angle += whole;
  if (!(enter < leave)) {
    add_arc(side.first, side.last);
    return;
  }
  add_arc(side.first, enter);
  const bool all_inside = enter == side.first && leave == side.last;
  sums.inside += (all_inside ? whole : line_angle(enter, leave)) + 0.5 * height * signed_distance * (leave - enter);
  add_arc(leave, side.last);
}

}  // namespace

double inside_volume(const SignedDistance& object, const Sphere& ball) {
  if (!(ball.radius > 0)) return 0;
  std::vector<std::uint32_t> near;
  object.bvh().facets_touching(ball, near);
  if (near.empty()) return object.is_inside(ball.center) ? volume(ball) : 0;

  Sums sums;
  double near_solid_angle = 0;
  for (const std::uint32_t f : near) {
    const Triangle& t = object.bvh().triangle(f);
    Triangle local;
    for (std::size_t k = 0; k < 3; ++k) {
      local[k] = (t[k] - ball.center) / ball.radius;
      // A centre on a vertex: as if it were beside it, on the same side for all facets there.
      if (local[k] == Vec3{}) local[k] = Vec3{0.48, 0.62, 0.62} * next_to_nothing;
    }
    const Vec3 area_vector = morula::area_vector(local);
    const double twice_area = length(area_vector);
    if (!(twice_area > 0)) continue;
    const Vec3 normal = area_vector / twice_area;
    const Vec3& nearest_corner = *std::min_element(
        local.begin(), local.end(), [](const Vec3& a, const Vec3& b) { return squared_length(a) < squared_length(b); });
    if (!(std::abs(dot(normal, nearest_corner)) < 1)) continue;
    near_solid_angle += solid_angle(t, ball.center);
    for (std::size_t k = 0; k < 3; ++k) add_side(normal, side_of(local[k], local[(k + 1) % 3]), sums);
  }

  // The index sums the very same solid angles of the facets nearby, so whatever rounding does to them when the centre
  // is on the surface drops out here. On an open surface there is no whole number: the result is then the integral of
  // the winding number, as exact as the far field.
  constexpr double turn = 2 * std::numbers::pi;
  const double accuracy = object.has_volume() ? 2 : 4;
  const double total = 2 * turn * object.bvh().winding_number(ball.center, accuracy);
  double rest = total - near_solid_angle - sums.whole_angle;
  if (object.has_volume()) rest = turn * std::round(rest / turn);
  const double share = object.orientation() * (rest + sums.inside) / (2 * turn);
  return volume(ball) * std::clamp(share, 0.0, 1.0);
}

double outside_volume(const SignedDistance& object, const Sphere& ball) {
  return volume(ball) - inside_volume(object, ball);
}

}  // namespace morula
