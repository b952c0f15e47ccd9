// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/layers/known_layers.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "parallel/interruptible_sort.hpp"

namespace morula::detail {

void KnownLayers::add(const Patch& patch, std::span<const VertexGradient> a, std::span<const VertexGradient> b) {
  const auto number = static_cast<std::uint32_t>(next_.patches.size());
  next_.patches.push_back(patch);
  for (const VertexGradient& g : a) next_.vertices[0].push_back({g.vertex, number});
  for (const VertexGradient& g : b) next_.vertices[1].push_back({g.vertex, number});
}

void KnownLayers::finish() {
  for (auto& side : next_.vertices) sort_interruptibly(side, std::less<>());
  std::swap(now_, next_);
}

void KnownLayers::count_side(std::uint32_t patch, std::span<const VertexGradient> side,
                             const std::vector<Vertex>& known, bool swapped) {
  auto at = known.begin();
  for (const VertexGradient& g : side) {
    at = std::lower_bound(at, known.end(), Vertex{g.vertex, 0});
    for (auto of = at; of != known.end() && of->vertex == g.vertex; ++of)
      common_.push_back({of->patch, patch, swapped});
  }
}

void KnownLayers::count(std::uint32_t patch, std::span<const VertexGradient> a, std::span<const VertexGradient> b,
                        bool may_be_swapped) {
  count_side(patch, a, now_.vertices[0], false);
  count_side(patch, b, now_.vertices[1], false);
  if (!may_be_swapped) return;
  count_side(patch, a, now_.vertices[1], true);
  count_side(patch, b, now_.vertices[0], true);
}

void KnownLayers::match(std::span<Match> matches) {
  sort_interruptibly(common_, std::less<>());
  // Equal ones become one with their number.
  std::size_t kept = 0;
  for (const Common& c : common_) {
    Common* last = kept > 0 ? &common_[kept - 1] : nullptr;
    if (last && std::tie(last->known, last->patch, last->swapped) == std::tie(c.known, c.patch, c.swapped))
      ++last->count;
    else
      common_[kept++] = c;
  }
  common_.resize(kept);
  sort_interruptibly(common_,
                     [](const Common& c, const Common& d) { return c.count != d.count ? c.count > d.count : c < d; });
  taken_.assign(now_.patches.size(), false);
  for (const Common& c : common_) {
    if (taken_[c.known] || matches[c.patch].known != none) continue;
    taken_[c.known] = true;
    matches[c.patch] = {c.known, c.swapped};
  }
  common_.clear();
}

}  // namespace morula::detail
