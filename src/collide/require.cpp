// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/require.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace morula {
using namespace detail;

Status detail::status_of(const Collider& collider, std::uint8_t body, Needs needs) {
  using Code = Status::Code;
  if (collider.sphere_state().ended) return {Code::body_replaced, body};
  if (!collider.sphere_state().current) return {Code::body_not_current, body};
  if (needs.all_spheres && !collider.sphere_state().complete) return {Code::body_not_complete, body};
  if (needs.positions && !collider.has_surface()) return {Code::no_surface, body};
  if (needs.positions && !collider.has_current_positions()) return {Code::positions_not_current, body};
  return {};
}

Status askable(const Collider& collider, std::uint8_t body) {
  if (const Status status = status_of(collider, body, {.positions = true}); !status) return status;
  if (!(max_norm(collider.transform().translation) < 0x1p200)) return {Status::Code::transform_too_far, body};
  return {};
}

Status detail::status_of_pair(const Collider& a, const Collider& b, Needs needs) {
  if (const Status status = status_of(a, 0, needs); !status) return status;
  return status_of(b, 1, needs);
}

void detail::require_good(const Status& status) {
  if (!status) throw std::invalid_argument(message(status));
}

void detail::require_bodies(const Collider& a, const Collider& b, Needs needs) {
  require_good(status_of_pair(a, b, needs));
}

void detail::require_usable(const CollideOptions& options) {
  if (!(std::isfinite(options.margin) && options.margin >= 0))
    throw std::invalid_argument("margin is " + std::to_string(options.margin) + ": it must be finite and not negative");
  if (options.budget.tests() < 0)
    throw std::invalid_argument("budget is negative: " + std::to_string(options.budget.tests()) +
                                (options.budget.is_time() ? " ns" : " pair tests"));
}

bool detail::has_level(const Collider& a, const Collider& b, const std::optional<std::uint32_t>& level) {
  return !level || *level < std::max(a.tree().level_count(), b.tree().level_count());
}

}  // namespace morula
