// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/facets/contact_geometry.hpp"

#include <morula/geometry/scale.hpp>
#include <numbers>

namespace morula::detail {

// Let D be the distance of centers, R_a and R_b the radii grown by half the margin and by the test's allowance for
// rounding: the regions' common points (with a margin, middles of near points) are in both grown spheres. The middle p
// of their overlap, delta = R_a + R_b - D long, is s = R_a - delta / 2 from a's center. Unless one sphere is inside the
// other, s > 0, and the point of the lens farthest from p is on the rim where the spheres meet: the distance from p, or
// from any other point on that side of the center, to points of a cap grows towards the rim. With x the rim's distance
// from a's center along the axis, |rim - p|^2 = R_a^2 - 2 x s + s^2 = delta^2 / 4 + s delta (R_b + D - R_a) / D. If one
// is inside the other, p is the center of the smaller one, and no point is farther than its radius.
void describe(const TreePair& trees, std::uint32_t node_a, std::uint32_t node_b, Contact& contact) {
  const PlacedPair& placed = trees.placed();
  const Spheref &a = trees.sphere_a(node_a), &b = trees.sphere_b(node_b);
  contact.node_a = node_a, contact.node_b = node_b;
  const auto turned = [](const std::array<Vec3, 3>& rows, const Vec3f& center) {
    const Vec3 c(center);
    return Vec3{dot(rows[0], c), dot(rows[1], c), dot(rows[2], c)};
  };
  const Vec3 center_a = turned(placed.world_a, a.center);
  const Vec3 center_b = turned(placed.world_b, b.center) + placed.world_shift;
  const double radius_a = a.radius, radius_b = b.radius;
  const double smaller = std::min(radius_a, radius_b), sum = radius_a + radius_b;
  const Vec3 between = center_a - center_b;
  // Transforms may be so far apart that squares overflow: bodies touch there only because digits are missing.
  const double distance = scaled_length(between);
  contact.depth = std::min(sum - distance, 2 * smaller);

  const double allowance = 0.5 * placed.margin + placed.allowance(a, b);
  const double grown_a = radius_a + allowance, grown_b = radius_b + allowance;
  // If centers coincide up to rounding, all directions are equally good.
  const bool coincide = !(distance > 0x1p-20 * sum);
  if (coincide || distance <= std::abs(radius_a - radius_b)) {
    contact.normal = coincide ? Vec3{1, 0, 0} : between / distance;
    contact.point = placed.world_origin + (radius_a < radius_b ? center_a : center_b);
    contact.error_bound = std::min(grown_a, grown_b) * (1 + 0x1p-30);
    contact.lens_volume = 4.0 / 3.0 * std::numbers::pi * smaller * smaller * smaller;
    return;
  }
  const double inverse = 1 / distance;
  contact.normal = between * inverse;
  contact.point = placed.world_origin + (center_b + contact.normal * (0.5 * (distance + radius_b - radius_a)));
  const double overlap = grown_a + grown_b - distance;
  const double from_a = grown_a - 0.5 * overlap;
  const double squared_bound = overlap * (0.25 * overlap + from_a * (grown_b + distance - grown_a) * inverse);
  contact.error_bound = std::sqrt(std::max(0.0, squared_bound)) * (1 + 0x1p-30);
  const double depth = std::max(0.0, contact.depth), difference = radius_a - radius_b;
  contact.lens_volume = 0;
  if (!(depth > 0)) return;
  contact.lens_volume = std::numbers::pi / 12 * depth * depth * inverse *
                        (distance * distance + 2 * distance * sum - 3 * difference * difference);
}

float overlap_share(const PlacedPair& placed, const Spheref& a, const Spheref& b) {
  const double sum = static_cast<double>(a.radius) + static_cast<double>(b.radius) + placed.margin;
  const double distance = length(Vec3(a.center) - placed.moved(b.center));
  return static_cast<float>(sum > 0 ? (sum - distance) / sum : -distance);
}

}  // namespace morula::detail
