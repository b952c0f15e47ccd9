// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/collide/query_status.hpp>

#include "collide/require.hpp"

namespace morula {

std::string message(const QueryStatus& status) {
  const std::string body = status.body == 0 ? "the first body" : "the second body";
  switch (status.code) {
    case QueryStatus::Code::ok:
      return {};
    case QueryStatus::Code::body_not_current:
      return body + "'s last update was refused, so its spheres are those of an older frame: update it first";
    case QueryStatus::Code::body_not_complete:
      return body +
             " was updated lazily, and not all of its nodes have been reached: update it in full, or give "
             "CollideOptions::reach where a query takes it";
    case QueryStatus::Code::positions_not_current:
      return body + " was updated since its collider was given positions: call set_positions after each update";
    case QueryStatus::Code::placement_too_far:
      return body + " is placed 2^200 or more from the origin";
    case QueryStatus::Code::bad_option:
      return "an option of the query is negative or not a number, or names a vertex that is none";
    case QueryStatus::Code::bad_shape:
      return "the shape that is asked about is not finite, has a negative radius or no direction, or is too far away";
  }
  return {};
}

QueryStatus askable(const Collider& collider, std::uint8_t body) {
  if (const QueryStatus status = status_of(collider, body, {.positions = true}); !status) return status;
  if (!(largest_component(collider.placement().translation) < 0x1p200))
    return {QueryStatus::Code::placement_too_far, body};
  return {};
}

bool spheres_cover(const Body& body) {
  return covers(body.options());
}

}  // namespace morula
