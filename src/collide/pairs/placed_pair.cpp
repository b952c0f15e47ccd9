// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/pairs/placed_pair.hpp"

#include <algorithm>
#include <limits>

#include "geometry/rounded_up.hpp"

namespace morula::detail {

PlacedPair placed_pair(const RigidTransform& relative, double coordinates, double margin) {
  PlacedPair pair;
  pair.rows = relative.rows;
  pair.translation = relative.translation;
  pair.margin = margin;
  constexpr double far = 0x1p62, too_coarse = 0x1p58;
  // mutant pair-rounding: `46 * coordinates + 0x1p-` -> ``
  // mutant pair-rounding-less: `46` -> `53`
  // mutant pair-underflow: `coordinates + 0x1p-60` -> `coordinates`
  const double rounding = pair.rounding = 0x1p-46 * coordinates + 0x1p-60;
  Vec3& u = pair.translation;
  // The comparison is negated, so that NaN does not count as small.
  if (!(rounding + margin < too_coarse)) {
    u = {};
    pair.pad = std::max(far, std::min(rounding, std::numeric_limits<double>::max()));
  } else {
    if (!(max_norm(u) < far)) u = {far, 0, 0};
    // mutant pair-pad: `0x1p-20 * max_norm(u) + rounding` -> `rounding`
    // mutant pair-pad-less: `20` -> `22`
    pair.pad = 0x1p-20 * max_norm(u) + rounding;
  }
  for (std::size_t row = 0; row < 3; ++row)
    for (int axis = 0; axis < 3; ++axis) pair.narrow.rows[row][axis] = static_cast<float>(pair.rows[row][axis]);
  for (int axis = 0; axis < 3; ++axis) pair.narrow.translation[axis] = static_cast<float>(u[axis]);
  // mutant pair-margin: `pair.pad + margin` -> `pair.pad`
  pair.narrow.pad = rounded_up(std::min(pair.pad + margin, far) * (1 + 0x1p-20));
  return pair;
}

PlacedPair placed_pair(const Collider& a, const Collider& b, double margin) {
  const RigidTransform &place_a = a.transform(), &place_b = b.transform();
  const Vec3 origin_a = a.sphere_state().origin, origin_b = b.sphere_state().origin;
  const Vec3 world_a = place_a(origin_a), shift = place_b(origin_b) - world_a;
  const RigidTransform relative{relative_to(place_a, place_b).rows, place_a.inverse_rotate(shift)};
  const double coordinates =
      max_norm(origin_a) + max_norm(origin_b) + max_norm(place_a.translation) + max_norm(place_b.translation);
  PlacedPair pair = placed_pair(relative, coordinates, margin);
  pair.world_a = place_a.rows;
  pair.world_b = place_b.rows;
  pair.world_shift = shift;
  pair.world_origin = world_a;
  return pair;
}

}  // namespace morula::detail
