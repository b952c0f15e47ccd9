// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/medial_seeds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "generators/fit/fit_kernels.hpp"
#include "geometry/each_bit.hpp"

namespace morula::detail {
namespace {

class SeedSearch {
 public:
  SeedSearch(std::span<const GroupBall> candidates, const GroupPoints& points, Dilation dilation)
      : candidates_(candidates.size()), points_(points.size()), growth_(candidates_ * points_) {
    for (std::size_t c = 0; c < candidates_; ++c) {
      const Vec3f center = candidates[c].center;
      const float radius = candidates[c].radius;
      float* const row = &growth_[c * points_];
      for (std::size_t i = 0; i < points_; ++i) {
        const float dx = points.x[i] - center.x, dy = points.y[i] - center.y, dz = points.z[i] - center.z;
        const float squared = dx * dx + dy * dy + dz * dz;
        row[i] = dilation == Dilation::length ? std::sqrt(squared) - radius
                                              : std::sqrt(std::max(0.0F, squared - radius * radius));
      }
    }
  }

  // Greedy cover at the least dilation that needs no more than `most` balls.
  std::vector<std::size_t> least_cover(std::size_t most) const {
    float lower = 0, upper = 0;
    for (std::size_t i = 0; i < points_; ++i) upper = std::max(upper, growth_[i]);
    std::vector<std::size_t> best = greedy(upper, most);
    constexpr int bisections = 10;
    for (int k = 0; k < bisections; ++k) {
      const float middle = 0.5F * (lower + upper);
      std::vector<std::size_t> chosen = greedy(middle, most);
      if (chosen.empty()) {
        lower = middle;
      } else {
        upper = middle;
        best = std::move(chosen);
      }
    }
    return best;
  }

  // Moves seeds while the sum over them of (points × largest growth) falls.
  void settle(std::vector<std::size_t>& seeds, int rounds) const {
    std::vector<std::size_t> best = seeds;
    double least = std::numeric_limits<double>::infinity();
    std::vector<std::uint8_t> owner(points_);
    for (int round = 0; round < rounds; ++round) {
      assign(seeds, owner);
      double sum = 0;
      for (std::size_t s = 0; s < seeds.size(); ++s) {
        std::vector<std::uint32_t> own;
        for (std::size_t i = 0; i < points_; ++i)
          if (owner[i] == s) own.push_back(static_cast<std::uint32_t>(i));
        if (own.empty()) continue;
        float smallest = std::numeric_limits<float>::infinity();
        std::size_t at = seeds[s];
        for (std::size_t c = 0; c < candidates_; ++c) {
          const float* const row = &growth_[c * points_];
          float largest = 0;
          for (const std::uint32_t i : own) {
            largest = std::max(largest, row[i]);
            if (largest >= smallest) break;
          }
          if (largest < smallest) smallest = largest, at = c;
        }
        seeds[s] = at;
        sum += static_cast<double>(own.size()) * smallest;
      }
      if (!(sum < least * (1 - 1e-6))) break;
      least = sum;
      best = seeds;
    }
    seeds = best;
  }

 private:
  std::vector<std::size_t> greedy(float dilation, std::size_t most) const {
    const std::size_t words = (points_ + 63) / 64;
    std::vector<std::uint64_t> reached(candidates_ * words), open(words, ~std::uint64_t{0});
    for (std::size_t c = 0; c < candidates_; ++c)
      fit_kernels().at_most(&growth_[c * points_], points_, dilation, &reached[c * words]);
    if (points_ % 64 != 0) open.back() >>= 64 - points_ % 64;
    std::size_t left = points_;
    std::vector<std::size_t> chosen;
    while (left > 0) {
      if (chosen.size() == most) return {};
      std::size_t best = 0, largest = 0;
      for (std::size_t c = 0; c < candidates_; ++c) {
        std::size_t gain = 0;
        for (std::size_t w = 0; w < words; ++w) gain += bit_count(reached[c * words + w] & open[w]);
        if (gain > largest) largest = gain, best = c;
      }
      if (largest == 0) return {};
      chosen.push_back(best);
      left -= largest;
      for (std::size_t w = 0; w < words; ++w) open[w] &= ~reached[best * words + w];
    }
    return chosen;
  }

  void assign(const std::vector<std::size_t>& seeds, std::vector<std::uint8_t>& owner) const {
    std::vector<float> least(points_, std::numeric_limits<float>::infinity());
    for (std::size_t s = 0; s < seeds.size(); ++s) {
      const float* const row = &growth_[seeds[s] * points_];
      for (std::size_t i = 0; i < points_; ++i)
        if (row[i] < least[i]) {
          least[i] = row[i];
          owner[i] = static_cast<std::uint8_t>(s);
        }
    }
  }

  std::size_t candidates_, points_;
  std::vector<float> growth_;  // growth by which candidate c contains point i: [c · points + i]
};

}  // namespace

std::vector<GroupBall> medial_seeds(std::span<const GroupBall> candidates, const GroupPoints& points, std::size_t most,
                                    Dilation dilation) {
  if (candidates.empty() || points.size() == 0) return {};
  const SeedSearch search(candidates, points, dilation);
  std::vector<std::size_t> seeds = search.least_cover(most);
  constexpr int rounds = 24;
  search.settle(seeds, rounds);
  std::sort(seeds.begin(), seeds.end());
  seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
  std::vector<GroupBall> balls;
  for (const std::size_t s : seeds) balls.push_back(candidates[s]);
  return balls;
}

}  // namespace morula::detail
