// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What queries ask of their arguments, said by exceptions.
#pragma once

#include <morula/collide/contacts.hpp>

namespace morula {

/// Throws std::invalid_argument when the last update was refused. who: "the first body".
void require_current(const Collider& collider, const char* who);
/// That, and when a lazy update has left nodes behind.
void require_complete(const Collider& collider, const char* who);
/// The same when positions are of an older frame.
void require_positions(const Collider& collider, const char* who);
/// Throws std::invalid_argument for a margin that is negative or not finite and for a negative budget.
void require_usable(const CollideOptions& options);
/// Has one of both trees such a level?
bool has_level(const Collider& a, const Collider& b, const std::optional<std::uint32_t>& level);

}  // namespace morula
