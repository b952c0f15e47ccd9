// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/require.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace morula {

void require_current(const Collider& collider, const char* who) {
  if (!collider.body().is_current())
    throw std::invalid_argument(std::string("the last update of ") + who +
                                " was refused: its spheres are those of an older frame");
}

void require_complete(const Collider& collider, const char* who) {
  require_current(collider, who);
  if (!collider.body().is_complete())
    throw std::invalid_argument(std::string(who) +
                                " was updated lazily, and not all of its nodes have been reached: update it in full, "
                                "or give CollideOptions::reach where a query takes it");
}

void require_positions(const Collider& collider, const char* who) {
  if (!collider.has_current_positions())
    throw std::invalid_argument(std::string(who) +
                                " was updated since its collider was given positions: call set_positions after it");
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
