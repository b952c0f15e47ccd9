// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/kdop/slab_extents.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "simd/processors.hpp"

namespace morula::detail {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// The reference that the other kernels reproduce, in plain loops.
namespace plain {

template <int k>
void slab_extents(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
                  float* lower, float* upper) {
  std::fill(lower, lower + k / 2, infinity);
  std::fill(upper, upper + k / 2, -infinity);
  const auto measure = [&](const LocalPoint& p) {
    int slab = 0;
    const auto add = [&](float value) {
      lower[slab] = std::min(lower[slab], value);
      upper[slab] = std::max(upper[slab], value);
      ++slab;
    };
    add(p.x), add(p.y), add(p.z);
    const float sum = p.x + p.y, difference = p.x - p.y;
    if constexpr (has_corner_slabs(k)) add(sum + p.z), add(sum - p.z), add(difference + p.z), add(difference - p.z);
    if constexpr (has_edge_slabs(k)) {
      add(sum), add(difference);
      add(p.x + p.z), add(p.x - p.z), add(p.y + p.z), add(p.y - p.z);
    }
  };
  for (const PointRun& run : runs) std::for_each(points + run.begin, points + run.end, measure);
  for (const std::uint32_t i : index) measure(points[i]);
  for (int i = 0; i < k / 2; ++i) lower[i] += 0.0f, upper[i] += 0.0f;  // no negative zeros
}

}  // namespace plain

#define MORULA_KERNELS "update/kdop/slab_extents.inl"
#include "simd/every_processor.inl"

template <int k>
constexpr KernelTable<SlabKernel> table{MORULA_EVERY_KIND(slab_extents<k>)};

}  // namespace

std::span<const SlabKernel> slab_kernels(int k) {
  switch (k) {
    case 6:
      return table<6>.runnable();
    case 14:
      return table<14>.runnable();
    case 18:
      return table<18>.runnable();
    default:
      assert(k == 26);
      return table<26>.runnable();
  }
}

}  // namespace morula::detail
