// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Why a query on colliders was refused.
#pragma once

#include <cstdint>
#include <morula/collide/collider.hpp>
#include <string>

namespace morula {

struct QueryStatus {
  enum class Code : std::uint8_t {
    ok,
    body_not_current,       ///< its last update was refused: the spheres are those of an older frame
    body_not_complete,      ///< a lazy update has left nodes behind
    positions_not_current,  ///< Collider::set_positions was not called since the body's last update
    placement_too_far,      ///< a translation of 2^200 or more: squares would leave the range of double
    bad_option,             ///< not a number, negative where it must not be, or a vertex that is none
    bad_shape,              ///< a plane, sphere, capsule, ray or point that is not finite, of negative radius, without
                            ///< direction, or 2^200 or more away
  };
  Code code = Code::ok;
  std::uint8_t body = 0;  ///< which one: 0 for a or the only one, 1 for b

  explicit operator bool() const { return code == Code::ok; }
  bool operator==(const QueryStatus&) const = default;
};

/// In words, with the remedy; empty for ok.
std::string message(const QueryStatus& status);

/// May this body be asked? `ok`, or one of the first three faults.
QueryStatus askable(const Collider& collider, std::uint8_t body = 0);

/// True when every level's spheres contain the surface whatever the motion: the rules `exact`, `wrapped` and `modal`,
/// or a conservative body. Otherwise lower bounds and misses are no proofs.
bool spheres_cover(const Body& body);

}  // namespace morula
