// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The body that a surface follows: its spheres say which blocks of the surface can be near another body's.
#pragma once

#include <cstdint>
#include <morula/collide/collider.hpp>
#include <span>
#include <vector>

namespace morula::detail {

struct FollowedBody {
  Collider spheres;         // the pose and where it is placed; no surface, so nothing of the caller's collider is kept
  std::uint64_t frame = 0;  // of the pose
  bool is_placed = false;   // other than where its coordinates are

  /// Where it was, and with all of its spheres there.
  bool is_current() const {
    const SphereState& pose = spheres.sphere_state();
    // mutant follow-moved: `pose.frame` -> `frame`
    return pose.frame == frame && pose.current && pose.complete;
  }
  bool covers() const { return spheres.sphere_state().covers; }
};

/// Which blocks have a facet of which a leaf owns a part; leaves by their nodes.
struct BlocksOfLeaves {
  std::uint64_t cover_id = 0;
  std::vector<std::uint32_t> begin, blocks;

  std::span<const std::uint32_t> operator[](std::uint32_t node) const {
    return std::span(blocks).subspan(begin[node], begin[node + 1] - begin[node]);
  }
};

}  // namespace morula::detail
