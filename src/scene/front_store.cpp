// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/front_store.hpp"

#include <algorithm>
#include <utility>

namespace morula::detail {
namespace {

constexpr std::size_t fewest_parted_fronts = 64;
// The number of updates after which parted pairs free their memory; it takes at most twice as many. Pairs that come and
// go keep their memory.
constexpr std::uint32_t updates_kept = 32;

bool is_earlier(const PairFront* x, const PairFront* y) {
  return std::pair(x->id_a(), x->id_b()) < std::pair(y->id_a(), y->id_b());
}

}  // namespace

void FrontStore::part(PairFront* front) {
  front->has_rested = false;
  parted_.insert(std::upper_bound(parted_.begin(), parted_.end(), front, is_earlier), front);
}

void FrontStore::discard(PairFront* front) {
  front->has_rested = false;
  spare_.push_back(front);
}

// Fronts of parted pairs are kept up to the number of fronts in use.
PairFront* FrontStore::take(BodyId a, BodyId b) {
  const auto known = std::lower_bound(parted_.begin(), parted_.end(), std::pair(a, b),
                                      [](const PairFront* front, const std::pair<BodyId, BodyId>& ids) {
                                        return std::pair(front->id_a(), front->id_b()) < ids;
                                      });
  auto taken = parted_.end();
  if (known != parted_.end() && (*known)->is_of(a, b)) taken = known;
  if (taken == parted_.end() && spare_.empty()) {
    // Reserved fronts serve before another is made, though a parted pair loses its own.
    const bool has_reserved = all_.size() <= reserved_ && !parted_.empty();
    if (!has_reserved && parted_.size() <= std::max(fewest_parted_fronts, all_.size() / 2)) {
      all_.push_back(std::make_unique<PairFront>());
      spare_.reserve(all_.capacity());
      parted_.reserve(all_.capacity());
      return all_.back().get();
    }
    next_to_forget_ = (next_to_forget_ + 1) % parted_.size();
    taken = parted_.begin() + static_cast<std::ptrdiff_t>(next_to_forget_);
  }
  if (taken == parted_.end()) {
    PairFront* const front = spare_.back();
    spare_.pop_back();
    return front;
  }
  PairFront* const front = *taken;
  parted_.erase(taken);
  return front;
}

void FrontStore::unbind(BodyId id) {
  std::erase_if(parted_, [&](PairFront* front) {
    // mutant scene-parted-fronts-of-replaced: `if (front->id_a() != id && front->id_b() != id) return` -> `return`
    if (front->id_a() != id && front->id_b() != id) return false;
    front->unbind();
    spare_.push_back(front);
    return true;
  });
}

void FrontStore::give_back_rested() {
  // mutant scene-memory-kept: `if (++updates_to_give_back_ < updates_kept) return` -> `return`
  if (++updates_to_give_back_ < updates_kept) return;
  updates_to_give_back_ = 0;
  for (PairFront* const front : spare_)
    if (std::exchange(front->has_rested, true)) front->give_back();
  std::erase_if(parted_, [&](PairFront* front) {
    if (!std::exchange(front->has_rested, true)) return false;
    front->give_back();
    front->unbind();
    spare_.push_back(front);
    return true;
  });
}

void FrontStore::reserve(std::size_t pairs, std::size_t contacts, std::size_t surfaces) {
  all_.reserve(pairs);
  spare_.reserve(all_.capacity());
  parted_.reserve(all_.capacity());
  while (all_.size() < pairs) {
    all_.push_back(std::make_unique<PairFront>());
    spare_.push_back(all_.back().get());
  }
  for (const auto& front : all_) front->reserve(contacts, surfaces);
  reserved_ = std::max(reserved_, pairs);
}

void FrontStore::forget() noexcept {
  parted_.clear(), spare_.clear(), all_.clear();
  next_to_forget_ = reserved_ = updates_to_give_back_ = 0;
}

}  // namespace morula::detail
