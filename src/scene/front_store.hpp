// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Front store: all fronts of a scene, and which of them are of pairs that parted, or of none.
//
//   new ──> in use: NearPair::front ── part() ──> parted ── give_back_rested() ──> spare
//            ^  ^     │                             │                              ^  │
//            │  └─────│──── the same two bodies ────┘ (others: of too many parted) │  │
//            │        └── discard(): a body was removed ───────────────────────────┘  │
//            └── any two bodies ──────────────────────────────────────────────────────┘
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "scene/pair_front.hpp"

namespace morula::detail {

/// All fronts that a scene has made. list_near() takes those of new pairs and gives back those of pairs that are gone.
class FrontStore {
 public:
  /// A front for two bodies that have come near: the one that they had when they were near, or a spare one. It is of
  /// any two bodies, or of none, so bind() may come next.
  PairFront* take(BodyId a, BodyId b);
  /// Takes back a front of two bodies that may come near again. Allocates nothing.
  void part(PairFront* front);
  /// Takes back a front of a body that was removed. Allocates nothing.
  void discard(PairFront* front);
  /// The body has another collider: no parted front is of it any more.
  void unbind(BodyId id);
  /// Once an update. Parted pairs may come back, so they keep what they have until they have been seen here twice.
  void give_back_rested();
  /// None is in use.
  void forget() noexcept;

 private:
  std::vector<std::unique_ptr<PairFront>> all_;
  std::vector<PairFront*> spare_, parted_;  // with room for all there are; parted ones in the order of their bodies
  std::size_t next_to_forget_ = 0;          // of parted_, where there are too many
  std::uint32_t updates_to_give_back_ = 0;  // since memory was given back last
};

}  // namespace morula::detail
