// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A body of a scene: its collider, what was read of it, and the box that it lies in.
#pragma once

#include <morula/scene/scene.hpp>

#include "collide/facets/leaf_surfaces.hpp"

namespace morula::detail {

/// What tells whether a body has moved.
struct BodyStamp {
  std::uint64_t cover_id = 0, frame = 0;
  Vec3 origin{};
  RigidTransform transform{};
  bool operator==(const BodyStamp&) const = default;
};

struct SceneBody {
  const Collider* collider = nullptr;  ///< none: there is no such body
  std::uint32_t generation = 0;
  SceneBodyOptions options{};
  bool is_asleep = false;
  bool is_falling_asleep = false;  ///< looked at once more in the next update: its last move may have come just before
  bool is_to_be_read = false;      ///< in the next update, though it is static or asleep; counts as moved then
  bool has_moved = false;          ///< in this update
  BodyStamp stamp{};
  Sphere around{};       ///< the ball that the box is around
  FacetShares shares{};  ///< of the collider, once surfaces were asked for

  bool is_looked_at() const {
    return collider != nullptr && (is_to_be_read || is_falling_asleep || !(is_asleep || options.is_static));
  }
};

/// What an update finds of a body, before it is known whether all can be used.
struct BodyRead {
  Status status{};
  bool has_moved = false;
  BodyStamp stamp{};
  Sphere around{};
};

BodyStamp stamp_of(const Collider& collider);
/// Two such balls have a point in common wherever the pair test of both roots says that they overlap or are no farther
/// apart than the margin.
Sphere ball_around(const Collider& collider, double margin);
Box box_around(const Sphere& ball);

}  // namespace morula::detail
