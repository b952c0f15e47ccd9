// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rebuild/strain_gauge.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace morula::detail {
namespace {

// Three vertices far apart among those of the facets that a leaf has a share of: all directions within it are felt.
std::array<std::uint32_t, 3> extremes(std::span<const Vec3> positions, std::span<const std::uint32_t> vertices) {
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

StrainGauge::StrainGauge(const Mesh& rest, const CoveredTree& built, std::size_t most) {
  std::vector<Pair> all;
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t node = 0; node < built.tree.node_count(); ++node) {
    if (!built.tree.is_leaf(node)) continue;
    vertices.clear();
    for (std::uint32_t p = built.cover.region_begin[node]; p < built.cover.region_end[node]; ++p) {
      const Facet& facet = rest.facets[built.cover.patch_facet[p]];
      vertices.insert(vertices.end(), facet.begin(), facet.end());
    }
    if (vertices.empty()) continue;
    const auto [a, b, c] = extremes(rest.positions, vertices);
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      if (const double length = distance(rest.positions[from], rest.positions[to]); length > 0)
        all.push_back({from, to, length});
  }
  const std::size_t count = std::min(most, all.size());
  for (std::size_t i = 0; i < count; ++i) pairs_.push_back(all[i * all.size() / count]);
}

void StrainGauge::measure(const PositionView& positions, std::span<float> lengths) const noexcept {
  constexpr float shortest = 1e-3f;  // counts as at least that: two vertices may come together
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Pair& pair = pairs_[i];
    const double now = distance(positions[pair.from], positions[pair.to]);
    lengths[i] = std::max(static_cast<float>(now / pair.at_rest), shortest);
  }
}

// What gets longer makes spheres grow, and what gets shorter much less: a limb at 0.88 of the length that its tree was
// made for is as loose as one at 1.09 of it.
static float cost_of_length(float now, float at_build) noexcept {
  constexpr float of_shortening = 0.3f;
  const float difference = (now - at_build) * (now + at_build) / (now * at_build);
  return difference * difference * (now > at_build ? 1.0f : of_shortening);
}

double StrainGauge::strain(std::span<const float> now, std::span<const float> at_build) noexcept {
  // Sums of their own, so that an addition need not wait for the one before.
  constexpr std::size_t lanes = 8;
  std::array<float, lanes> sum{};
  std::size_t i = 0;
  for (; i + lanes <= now.size(); i += lanes)
    for (std::size_t k = 0; k < lanes; ++k) sum[k] += cost_of_length(now[i + k], at_build[i + k]);
  for (; i < now.size(); ++i) sum[0] += cost_of_length(now[i], at_build[i]);
  double all = 0;
  for (const float s : sum) all += static_cast<double>(s);
  return now.empty() ? 0 : std::sqrt(all / static_cast<double>(now.size())) / 2;
}

}  // namespace morula::detail
