// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/patch_matching.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

namespace morula::detail {
namespace {
constexpr double unreached = -std::numeric_limits<double>::infinity();
constexpr std::size_t most_candidates = 16;
constexpr double least_gain = 1e-9;  // less is rounding, which must not lead in a circle
}  // namespace

std::span<const std::uint32_t> PatchMatching::find(std::span<const KnownPatch> known,
                                                   std::span<const KnownPatch> present) {
  candidates_.clear();
  begin_.assign(1, 0);
  for (const KnownPatch& patch : present) {
    for (std::uint32_t q = 0; q < known.size(); ++q) {
      const double move = std::min(distance(known[q].centroid[0], patch.centroid[0]),
                                   distance(known[q].centroid[1], patch.centroid[1]));
      const double size = std::max(patch.size, known[q].size);
      if (move <= size) candidates_.push_back({q, size > 0 ? 1 - move / size : 1});
    }
    keep_nearest();
    begin_.push_back(candidates_.size());
  }
  known_of_.assign(present.size(), none);
  patch_of_.assign(known.size(), none);
  matched_gain_.assign(known.size(), 0);
  from_.assign(known.size(), none);
  from_gain_.assign(known.size(), 0);
  for (std::uint32_t p = 0; p < present.size(); ++p) augment(p);
  return known_of_;
}

// Of many known patches nearer than their size, all but the nearest are unlikely; the search grows with their number.
void PatchMatching::keep_nearest() {
  const auto first = candidates_.begin() + static_cast<std::ptrdiff_t>(begin_.back());
  if (candidates_.end() - first <= static_cast<std::ptrdiff_t>(most_candidates)) return;
  const auto last = first + static_cast<std::ptrdiff_t>(most_candidates);
  std::nth_element(first, last, candidates_.end(), [](const Candidate& c, const Candidate& d) {
    return std::tie(d.gain, c.known) < std::tie(c.gain, d.known);
  });
  std::sort(first, last, [](const Candidate& c, const Candidate& d) { return c.known < d.known; });
  candidates_.erase(last, candidates_.end());
}

// The best matching of the patches before this one becomes the best with it along the path of the largest gain: from
// the patch to a known one, from there to the patch that it matched, and so on, up to a known one without match, or to
// a patch that loses its match.
void PatchMatching::augment(std::uint32_t patch) {
  best_.assign(patch_of_.size(), unreached);
  queue_.assign(1, patch);
  const auto gain_at = [&](std::uint32_t p) {
    return p == patch ? 0 : best_[known_of_[p]] - matched_gain_[known_of_[p]];
  };
  double most = 0;
  std::uint32_t end = none;
  for (std::size_t next = 0; next < queue_.size(); ++next) {
    const std::uint32_t p = queue_[next];
    const double so_far = gain_at(p);
    for (std::size_t i = begin_[p]; i < begin_[p + 1]; ++i) {
      const auto& [known, gain] = candidates_[i];
      if (!(so_far + gain > best_[known] + least_gain)) continue;
      best_[known] = so_far + gain;
      from_[known] = p, from_gain_[known] = gain;
      const std::uint32_t other = patch_of_[known];
      if (other != none && other != patch) queue_.push_back(other);
      if (const double total = best_[known] - (other == none ? 0 : matched_gain_[known]); total > most + least_gain)
        most = total, end = known;
    }
  }
  if (end == none) return;
  if (patch_of_[end] != none) known_of_[patch_of_[end]] = none;
  for (std::uint32_t known = end; known != none;) {
    const std::uint32_t p = from_[known], before = p == patch ? none : known_of_[p];
    patch_of_[known] = p, known_of_[p] = known, matched_gain_[known] = from_gain_[known];
    known = before;
  }
}

}  // namespace morula::detail
