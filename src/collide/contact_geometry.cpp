// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/contact_geometry.hpp"

#include <numbers>

namespace morula {

// Let D be the distance of centres, R_a and R_b the radii grown by half the margin and by what the test allows for
// rounding: the regions' common points (with a margin, middles of near points) are in both grown spheres. The middle p
// of their overlap, delta = R_a + R_b - D long, is s = R_a - delta / 2 from a's centre. Unless one sphere is inside the
// other, s > 0, and the point of the lens farthest from p is on the rim where the spheres meet: from p as from anywhere
// on that side of the centre, points of a cap grow farther towards its rim. With x the rim's distance from a's centre
// along the axis, |rim - p|^2 = R_a^2 - 2 x s + s^2 = delta^2 / 4 + s delta (R_b + D - R_a) / D.
// One inside the other: p is the middle of the smaller, nothing is farther than its radius.
Contact contact_of(const PlacedPair& placed, const Spheref& a, const Spheref& b) {
  Contact contact;
  const Vec3 center_a(a.center), center_b = placed.moved(b.center);
  const double radius_a = a.radius, radius_b = b.radius;
  const double smaller = std::min(radius_a, radius_b);
  const Vec3 between = center_a - center_b;
  const double distance = length(between);
  const double growth = 0.5 * placed.margin + placed.growth(a, b);

  // Where centres coincide but for rounding, any direction is as good.
  const bool coincide = !(distance > 0x1p-20 * (radius_a + radius_b));
  contact.normal = coincide ? Vec3{1, 0, 0} : placed.world.turn(between / distance);
  contact.depth = std::min(radius_a + radius_b - distance, 2 * smaller);

  const double grown_a = radius_a + growth, grown_b = radius_b + growth;
  const double overlap = grown_a + grown_b - distance;
  double bound;
  if (coincide || distance <= std::abs(grown_a - grown_b)) {
    const bool a_inside = radius_a < radius_b;
    contact.point = placed.world(a_inside ? center_a : center_b);
    bound = std::min(grown_a, grown_b);
    contact.lens_volume = 4.0 / 3.0 * std::numbers::pi * smaller * smaller * smaller;
  } else {
    contact.point = placed.world(center_b + between * (0.5 * (distance + radius_b - radius_a) / distance));
    const double from_a = grown_a - 0.5 * overlap;
    bound = std::sqrt(
        std::max(0.0, 0.25 * overlap * overlap + from_a * overlap * (grown_b + distance - grown_a) / distance));
    const double depth = contact.depth, difference = radius_a - radius_b, sum = radius_a + radius_b;
    if (depth > 0)
      contact.lens_volume = std::numbers::pi * depth * depth *
                            (distance * distance + 2 * distance * sum - 3 * difference * difference) / (12 * distance);
  }
  contact.error_bound = bound * (1 + 0x1p-30);
  return contact;
}

float overlap_share(const PlacedPair& placed, const Spheref& a, const Spheref& b) {
  const double sum = static_cast<double>(a.radius) + static_cast<double>(b.radius) + placed.margin;
  const double distance = length(Vec3(a.center) - placed.moved(b.center));
  return static_cast<float>(sum > 0 ? (sum - distance) / sum : -distance);
}

}  // namespace morula
