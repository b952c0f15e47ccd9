// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Front store: all fronts of a scene, including the fronts of parted pairs and unused ones.
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

/// All fronts that a scene has made. list_near() takes fronts for new pairs and returns the fronts of pairs that are
/// gone.
class FrontStore {
 public:
  /// Returns a front for two bodies that have come near: the one that they had when they were near last, or a spare
  /// one. The front may belong to any two bodies, or to none, so the caller may have to call bind().
  PairFront* take(BodyId a, BodyId b);
  /// Stores a front of two bodies that may come near again. Allocates nothing.
  void part(PairFront* front);
  /// Stores a front of a body that was removed. Allocates nothing.
  void discard(PairFront* front);
  /// Unbinds the parted fronts of a body, which has another collider.
  void unbind(BodyId id);
  /// Frees memory; called once per update. Parted pairs may come back, so their fronts keep their memory until two such
  /// calls have found them parted.
  void give_back_rested();
  /// Makes fronts, so that so many pairs may be near, with room for so many contacts, and surfaces, each. The fronts
  /// keep this room until forget().
  void reserve(std::size_t pairs, std::size_t contacts, std::size_t surfaces);
  /// Resets the store: no front is in use.
  void forget() noexcept;

 private:
  std::vector<std::unique_ptr<PairFront>> all_;
  std::vector<PairFront*> spare_, parted_;  // fronts not in use, with room for all fronts; parted ones in the order of
                                            // their bodies
  std::size_t next_to_forget_ = 0;          // place in parted_ of the next front to reuse, if there are too many
  std::size_t reserved_ = 0;                // number of fronts that reserve() asked for
  std::uint32_t updates_to_give_back_ = 0;  // updates since memory was freed last
};

}  // namespace morula::detail
