// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/excluded_nodes.hpp"

#include <algorithm>
#include <utility>

namespace morula::detail {

ExcludedNodes::ExcludedNodes(std::vector<std::uint32_t> begin, std::vector<Run> runs, std::size_t most_bytes) {
  Rows rows{std::move(begin), std::move(runs)};
  std::size_t used = 0;
  while (rows.begin.size() > 2) {
    rows = rows_above(rows);
    used += rows.bytes();
    if (used > most_bytes) return;
    heights_.push_back(rows);
  }
}

ExcludedNodes::Rows ExcludedNodes::rows_above(const Rows& below) {
  const auto count = static_cast<std::uint32_t>(below.begin.size() - 1);
  Rows above{.begin = {0}, .runs = {}};
  std::vector<Run> common, next;  // runs of all child rows so far; and with one more
  for (std::uint32_t node = 0; 8 * node < count; ++node) {
    common.assign(1, {node, (count - 1) / 8});
    for (std::uint32_t child = 8 * node; child < std::min(8 * node + 8, count); ++child) {
      next.clear();
      std::size_t at = 0;
      for (std::uint32_t i = below.begin[child]; i < below.begin[child + 1]; ++i) {
        const auto [first, last] = below.runs[i];
        // mutant exclusion-node-first: `(first + 7) / 8` -> `first / 8`
        const std::uint32_t low = first == child ? node : (first + 7) / 8;
        // mutant exclusion-node-last: `(last + 1) / 8` -> `(last + 8) / 8`
        const std::uint32_t end = last + 1 == count ? (count + 7) / 8 : (last + 1) / 8;
        if (low >= end) continue;
        while (at < common.size() && common[at].last < low) ++at;
        for (std::size_t k = at; k < common.size() && common[k].first < end; ++k)
          next.push_back({std::max(low, common[k].first), std::min(end - 1, common[k].last)});
      }
      common.swap(next);
    }
    above.runs.insert(above.runs.end(), common.begin(), common.end());
    above.begin.push_back(static_cast<std::uint32_t>(above.runs.size()));
  }
  return above;
}

bool ExcludedNodes::hold(std::size_t height, std::uint32_t a, std::uint32_t b) const {
  if (height > heights_.size()) return false;
  const Rows& rows = heights_[height - 1];
  const auto end = rows.runs.begin() + rows.begin[a + 1];
  const auto at = std::lower_bound(rows.runs.begin() + rows.begin[a], end, b,
                                   [](const Run& run, std::uint32_t node) { return run.last < node; });
  return at != end && at->first <= b;
}

std::size_t ExcludedNodes::bytes() const {
  std::size_t sum = 0;
  for (const Rows& rows : heights_) sum += rows.bytes();
  return sum;
}

}  // namespace morula::detail
