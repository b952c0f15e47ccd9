// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/haptic/proxy_start.hpp"

#include <algorithm>
#include <cmath>

namespace morula::detail {
namespace {

// The sum of the normals, the normals, the opposite ones, and 26 directions of a cube.
std::vector<Vec3> directions_from(std::span<const ProxyContact> contacts) {
  std::vector<Vec3> directions(1);
  for (const ProxyContact& contact : contacts) directions[0] += contact.normal;
  directions[0] = normalized(directions[0]);
  for (const ProxyContact& contact : contacts.first(std::min<std::size_t>(contacts.size(), 8)))
    directions.push_back(contact.normal);
  for (std::size_t k = directions.size(); k-- > 0;) directions.push_back(-directions[k]);
  for (int n = 0; n < 27; ++n)
    if (n != 13) directions.push_back(normalized(Vec3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1)));
  return directions;
}

}  // namespace

std::optional<Vec3> place_beside(const Collider& body, TouchQuery& touch, std::span<const ProxyContact> contacts,
                                 const Vec3& center, const KeptDistances& kept) {
  std::optional<Vec3> best;
  double most = kept.skin / 64;
  std::vector<NearFacet> near;
  const std::vector<Vec3> directions = directions_from(contacts);
  for (const double share : {1.0, 2.0, 4.0, 8.0, 16.0, 0.25, 0.0625})
    for (const Vec3& direction : directions) {
      const Vec3 end = center + share * kept.rest * direction, middle = 0.5 * (center + end);
      // This ball contains the segment, and the ball around its end.
      const Touch& found =
          touch.run(body, Sphere{middle, distance(middle, end) + kept.touching}, {.collect_all = true});
      if (!found.status) return best;
      near.clear();
      double clearance = kept.touching;
      for (const TouchingFacet& facet : found.facets) {
        near.push_back({facet.point.facet, body.triangle(facet.point.facet)});
        clearance = std::min(clearance, std::sqrt(closest_point(near.back().corners, end).squared_distance));
      }
      if (!(clearance > most) || !leaves_facets(near, center, end)) continue;
      best = end, most = clearance;
      if (clearance >= kept.stop) return best;
    }
  return best;
}

}  // namespace morula::detail
