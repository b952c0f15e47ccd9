// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/points/kernels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "simd/processors.hpp"

namespace morula::detail {
namespace {

/// What the others have to reproduce, in plain loops; also for compilers without vector types.
namespace plain {

void farthest(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
              std::span<const Vec3f> centers, float* squared) {
  for (std::size_t k = 0; k < centers.size(); ++k) {
    float most = 0;
    const auto measure = [&](const LocalPoint& p) {
      most = std::max(most, squared_length(Vec3f{p.x, p.y, p.z} - centers[k]));
    };
    for (const PointRun& run : runs) std::for_each(points + run.begin, points + run.end, measure);
    for (const std::uint32_t i : index) measure(points[i]);
    squared[k] = most;
  }
}

Vec3f pull(const LocalPoint* points, const Pull& pull, const Vec3f& center) {
  Vec3f now = center, best = center;
  float least = 0;
  for (int step = 0;; ++step) {
    float squared = -1;
    Vec3f far;
    for (std::size_t i = 0; i < core_size; ++i) {
      const LocalPoint& p = points[pull.core[i]];
      const float s = squared_length(Vec3f{p.x, p.y, p.z} - now);
      if (s > squared) squared = s, far = {p.x, p.y, p.z};
    }
    if (step == 0 || squared < least) least = squared, best = now;
    if (squared <= pull.enough || step == pull_steps) return best;
    const float distance = std::sqrt(squared);
    const float along = 0.15f * distance / static_cast<float>(step + 1);
    const float excess = 0.8f * (std::sqrt(least) - pull.rest_radius);
    const float share = std::min(along, excess) / distance;
    now += (far - now) * share;
  }
}

std::uint32_t narrow_floats(const float* packed, std::size_t count, const Vec3f& origin, LocalPoint* out) {
  std::uint32_t largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f p = Vec3f{packed[3 * i], packed[3 * i + 1], packed[3 * i + 2]} - origin;
    out[i] = {p.x, p.y, p.z, 0};
    for (const float coordinate : {p.x, p.y, p.z})
      largest = std::max(largest, std::bit_cast<std::uint32_t>(coordinate) & 0x7fffffffu);
  }
  return largest;
}

constexpr Kernels kernels{farthest, pull, narrow_floats};

}  // namespace plain

#define MORULA_KERNELS "update/points/kernels.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<Kernels> table{MORULA_EVERY_KIND(kernels)};

}  // namespace

std::span<const Kernels> all_kernels() {
  return table.runnable();
}

const Kernels& kernels() {
  return table.widest();
}

}  // namespace morula::detail
