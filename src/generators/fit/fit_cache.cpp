// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/fit_cache.hpp"

#include <bit>

#include "generators/fit/assignment.hpp"

namespace morula::detail {

bool FitCache::has_fit(std::size_t ball, const FitInputs& inputs, std::span<const GroupBall> balls) const {
  const Entry& own = entries_[ball];
  if (own.fitted == 0 || own.inputs != inputs) return false;
  // The search looked at balls a little away from the one it found.
  const float near = 1.3F * balls[ball].radius;
  const auto is_near = [&](const GroupBall& other) {
    return distance_between(other.center, balls[ball].center) < near + other.radius;
  };
  for (std::size_t j = 0; j < entries_.size(); ++j) {
    if (j == ball || entries_[j].changed <= own.fitted) continue;
    if (is_near(balls[j]) || is_near(entries_[j].before)) return false;
  }
  return true;
}

void FitCache::note_fit(std::size_t ball, const GroupBall& before, const GroupBall& after, const FitInputs& inputs) {
  const bool same = after.center == before.center && after.radius == before.radius;
  if (!same) note_change(ball, before);
  entries_[ball].fitted = ++clock_;
  entries_[ball].inputs = inputs;
}

void FitCache::note_change(std::size_t ball, const GroupBall& before) {
  entries_[ball].before = before;
  entries_[ball].changed = ++clock_;
}

std::uint64_t WholeBalls::key(const GroupBall& b, const FitInputs& inputs) {
  std::uint64_t hash = inputs.points_hash;
  // mutant refused-split-whatever-it-costs: `b.cost, inputs` -> `inputs`
  for (const float number : {b.center.x, b.center.y, b.center.z, b.radius, b.cost, inputs.overlap_weight})
    hash = hash_mix(hash ^ std::bit_cast<std::uint32_t>(number));
  return hash;
}

}  // namespace morula::detail
