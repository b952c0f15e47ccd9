// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rebuild/strain_gauge.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace morula::detail {
namespace {

// Three vertices far apart among those of the facets that a leaf has a share of: their lengths cover all directions
// within it.
std::array<std::uint32_t, 3> extremes(const PositionView& positions, std::span<const std::uint32_t> vertices) {
  const auto farthest = [&](const auto& measure) {
    return *std::max_element(vertices.begin(), vertices.end(),
                             [&](std::uint32_t a, std::uint32_t b) { return measure(a) < measure(b); });
  };
  const auto apart = [&](std::uint32_t a, std::uint32_t b) { return distance(positions[a], positions[b]); };
  const std::uint32_t first = farthest([&](std::uint32_t v) { return apart(v, vertices.front()); });
  const std::uint32_t second = farthest([&](std::uint32_t v) { return apart(v, first); });
  const std::uint32_t third = farthest([&](std::uint32_t v) { return std::min(apart(v, first), apart(v, second)); });
  return {first, second, third};
}

}  // namespace

StrainGauge::StrainGauge(const MeshView& posed, const SphereTree& tree, const Cover& cover) {
  std::vector<Pair> all;
  std::vector<std::uint32_t> vertices;
  double sum = 0;
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    if (!tree.is_leaf(node)) continue;
    vertices.clear();
    for (std::uint32_t p = cover.region_begin[node]; p < cover.region_end[node]; ++p) {
      const Facet& facet = posed.facets[cover.patch_facet[p]];
      vertices.insert(vertices.end(), facet.begin(), facet.end());
    }
    if (vertices.empty()) continue;
    const auto [a, b, c] = extremes(posed.positions, vertices);
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      if (const double length = distance(posed.positions[from], posed.positions[to]); length > 0) {
        all.push_back({from, to});
        sum += length;
      }
  }
  if (sum > 0) mean_length_ = sum / static_cast<double>(all.size());
  const std::size_t count = std::min(most, all.size());
  for (std::size_t i = 0; i < count; ++i) pairs_.push_back(all[i * all.size() / count]);
  at_build_.resize(count);
  measure(posed.positions, at_build_);
}

void StrainGauge::measure(const PositionView& positions, std::span<float> lengths) const noexcept {
  constexpr float shortest = 1e-3f;  // lengths count as at least that: two vertices may come together
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const double now = distance(positions[pairs_[i].from], positions[pairs_[i].to]);
    lengths[i] = std::max(static_cast<float>(now / mean_length_), shortest);
  }
}

double StrainGauge::strain(const PositionView& positions) const noexcept {
  std::array<float, most> now;
  measure(positions, now);
  return strain(std::span(now).first(pairs_.size()), at_build_);
}

// Longer lengths make spheres grow, and shorter ones much less: a limb at 0.88 of the length that its tree was made for
// is as loose as one at 1.09 of it.
static float cost_of_length(float now, float before) noexcept {
  constexpr float of_shortening = 0.3f;
  const float difference = (now - before) * (now + before) / (now * before);
  return difference * difference * (now > before ? 1.0f : of_shortening);
}

double StrainGauge::strain(std::span<const float> now, std::span<const float> before) noexcept {
  // Each lane has a sum of its own, so that an addition need not wait for the last one.
  constexpr std::size_t lanes = 8;
  std::array<float, lanes> sum{};
  std::size_t i = 0;
  for (; i + lanes <= now.size(); i += lanes)
    for (std::size_t k = 0; k < lanes; ++k) sum[k] += cost_of_length(now[i + k], before[i + k]);
  for (; i < now.size(); ++i) sum[0] += cost_of_length(now[i], before[i]);
  double all = 0;
  for (const float s : sum) all += static_cast<double>(s);
  return now.empty() ? 0 : std::sqrt(all / static_cast<double>(now.size())) / 2;
}

}  // namespace morula::detail
