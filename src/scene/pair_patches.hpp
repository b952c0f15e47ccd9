// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The contact patches that a scene keeps for a pair of bodies, and the closed surfaces of its bodies.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <morula/scene/scene.hpp>
#include <vector>

#include "collide/patches/patch_engine.hpp"

namespace morula::detail {

/// The surface of a body, once it is examined. Bodies with the same facets share it.
struct BodySurface {
  bool is_examined = false;
  /// Null if the body has no facets, or its surface is open, not oriented or inside out.
  std::shared_ptr<const ClosedSurface> closed{};
};

/// The patches of a pair, of the poses in which they were computed last.
class PairPatches {
 public:
  /// Whether another find() for these bodies in their present poses, with these options, would have the same result.
  bool is_settled(const Collider& a, const Collider& b, const ContactPatchOptions& options) const;
  /// Computes all patches below nodes of which all crossings are in or below a pair. meter: null: no limit. Patches
  /// keep their ids if the last ones were of the same bodies. Returns false if the meter ended it, or the surface of a
  /// body is inside out where it meets the other.
  bool find(PatchEngine& engine, const PatchBodies& bodies, std::span<const NodePair> nodes,
            const ContactPatchOptions& options, Meter* meter);
  /// Whether the last find() has computed all patches.
  bool is_there() const { return is_there_; }
  std::span<const ContactPatch> patches() const { return result_.patches; }

  std::chrono::nanoseconds cost{0};    ///< time of the last find() that ended by itself; less after updates without one
  std::uint32_t updates_left_out = 0;  ///< number of updates since the last find()

 private:
  struct Side {
    const Collider* collider = nullptr;
    std::uint64_t cover_id = 0, frame = 0;
    RigidTransform transform{};
    bool operator==(const Side&) const = default;
    static Side of(const Collider& collider) {
      return {&collider, collider.sphere_state().cover_id, collider.sphere_state().frame, collider.transform()};
    }
  };
  Side a_, b_;
  std::uint32_t max_points_ = 0;
  bool depths_ = false, is_there_ = false, is_rejected_ = false;
  PatchResult result_, next_;
  std::vector<KnownPatch> known_;
  std::uint32_t next_id_ = 0;
};

}  // namespace morula::detail
