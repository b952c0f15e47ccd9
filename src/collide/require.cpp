// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/require.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace morula {

QueryStatus status_of(const Collider& collider, std::uint8_t body, Needs needs) {
  using Code = QueryStatus::Code;
  if (!collider.body().is_current()) return {Code::body_not_current, body};
  if (needs.all_spheres && !collider.body().is_complete()) return {Code::body_not_complete, body};
  if (needs.positions && !collider.has_current_positions()) return {Code::positions_not_current, body};
  return {};
}

void require_bodies(const Collider& a, const Collider& b, Needs needs) {
  for (const QueryStatus& status : {status_of(a, 0, needs), status_of(b, 1, needs)})
    if (!status) throw std::invalid_argument(message(status));
}

void require_usable(const CollideOptions& options) {
  if (!(std::isfinite(options.margin) && options.margin >= 0))
    throw std::invalid_argument("margin is " + std::to_string(options.margin) + ": it must be finite and not negative");
  if (options.budget.tests() < 0)
    throw std::invalid_argument("budget is negative: " + std::to_string(options.budget.tests()) +
                                (options.budget.is_time() ? " ns" : " pair tests"));
}

bool has_level(const Collider& a, const Collider& b, const std::optional<std::uint32_t>& level) {
  return !level || *level < std::max(a.body().rest_tree().level_count(), b.body().rest_tree().level_count());
}

}  // namespace morula
