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

StrainGauge::StrainGauge(const Mesh& pose, const CoveredTree& built, std::size_t most) {
  constexpr double shortest = 1e-2;  // of the longest in a leaf
  std::vector<Pair> all;
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t node = 0; node < built.tree.node_count(); ++node) {
    if (!built.tree.is_leaf(node)) continue;
    vertices.clear();
    for (std::uint32_t p = built.cover.region_begin[node]; p < built.cover.region_end[node]; ++p) {
      const Facet& facet = pose.facets[built.cover.patch_facet[p]];
      vertices.insert(vertices.end(), facet.begin(), facet.end());
    }
    if (vertices.empty()) continue;
    const auto [a, b, c] = extremes(pose.positions, vertices);
    const std::array<std::array<std::uint32_t, 2>, 3> pairs{{{a, b}, {b, c}, {c, a}}};
    std::array<double, 3> lengths{};
    for (std::size_t k = 0; k < 3; ++k) lengths[k] = distance(pose.positions[pairs[k][0]], pose.positions[pairs[k][1]]);
    const double least = shortest * *std::max_element(lengths.begin(), lengths.end());
    for (std::size_t k = 0; k < 3; ++k)
      if (lengths[k] > 0)
        all.push_back(
            {pairs[k][0], pairs[k][1], static_cast<float>(std::max(lengths[k], least)), static_cast<float>(least)});
  }
  const std::size_t count = std::min(most, all.size());
  for (std::size_t i = 0; i < count; ++i) pairs_.push_back(all[i * all.size() / count]);
}

// What gets longer makes spheres grow, and what gets shorter much less: a limb at 0.88 of the length that its tree was
// made for is as loose as one at 1.09 of it.
static float cost_of_length(float now, float at_build) noexcept {
  constexpr float of_shortening = 0.3f;
  const float difference = (now - at_build) * (now + at_build) / (now * at_build);
  return difference * difference * (now > at_build ? 1.0f : of_shortening);
}

double StrainGauge::strain(const PositionView& positions) const noexcept {
  // Some at a time, and sums of their own, so that an addition need not wait for the one before.
  constexpr std::size_t lanes = 8;
  std::array<float, lanes> now{}, at_build{}, sum{};
  for (std::size_t i = 0; i < pairs_.size(); i += lanes) {
    const std::size_t count = std::min(lanes, pairs_.size() - i);
    at_build.fill(1), now.fill(1);
    for (std::size_t k = 0; k < count; ++k) {
      const Pair& pair = pairs_[i + k];
      now[k] = std::max(static_cast<float>(distance(positions[pair.from], positions[pair.to])), pair.shortest);
      at_build[k] = pair.at_build;
    }
    for (std::size_t k = 0; k < lanes; ++k) sum[k] += cost_of_length(now[k], at_build[k]);
  }
  double all = 0;
  for (const float s : sum) all += static_cast<double>(s);
  return pairs_.empty() ? 0 : std::sqrt(all / static_cast<double>(pairs_.size())) / 2;
}

}  // namespace morula::detail
