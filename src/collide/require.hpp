// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Requirements that queries have of their arguments.
#pragma once

#include <morula/collide/collider.hpp>
#include <morula/collide/contacts.hpp>

namespace morula::detail {

/// What a query needs of a body, besides an update that was not refused.
struct Needs {
  bool all_spheres = true;  ///< also those that a lazy update has left behind
  bool positions = false;
};
/// ok, or the first fault.
Status status_of(const Collider& collider, std::uint8_t body, Needs needs);
/// The first fault of either.
Status status_of_pair(const Collider& a, const Collider& b, Needs needs);
/// Throws std::invalid_argument with the message of a fault.
void require_good(const Status& status);
/// Throws std::invalid_argument with the message of the first fault of either.
void require_bodies(const Collider& a, const Collider& b, Needs needs);
/// Throws std::invalid_argument for a margin that is negative or not finite and for a negative budget.
void require_usable(const CollideOptions& options);
/// Has one of both trees such a level?
bool has_level(const Collider& a, const Collider& b, const std::optional<std::uint32_t>& level);

}  // namespace morula::detail
