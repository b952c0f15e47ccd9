// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/pairs/pair_kernels.hpp"

#include <limits>

#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
// mutant pair-radius-a: `1 + 0x1p-20f` -> `1`
// mutant pair-radius-b: `1 + 0x1p-19f` -> `1`
// mutant pair-center: `0x1p-20f;` -> `0;`
// mutant pair-center-less: `20f;` -> `24f;`
constexpr float grown_a = 1 + 0x1p-20f, grown_b = 1 + 0x1p-19f, center_share = 0x1p-20f;
// Prevents 0 / 0 where two grown radii and a distance are 0.
constexpr float tiny = 0x1p-125f;

/// The reference in plain loops: all other kernels have to return the same bits.
namespace plain {

float absolute(float x) {
  return x > -x ? x : -x;
}

template <bool measured>
float test_pairs(const NarrowPair& f, const PairBlock& block, std::uint64_t* masks) {
  float least = infinity;
  for (std::size_t j = 0; j < block.count_b; ++j) {
    const float x = block.b[j].center.x, y = block.b[j].center.y, z = block.b[j].center.z;
    float moved[3];
    for (int row = 0; row < 3; ++row)
      moved[row] = (f.rows[row][0] * x + f.rows[row][1] * y) + (f.rows[row][2] * z + f.translation[row]);
    const float size = (absolute(x) + absolute(y)) + absolute(z);
    const float radius = block.b[j].radius * grown_b + (size * center_share + f.pad);
    std::uint64_t mask = 0;
    for (std::size_t i = 0; i < block.count_a; ++i) {
      const Spheref& a = block.a[i];
      const float dx = a.center.x - moved[0], dy = a.center.y - moved[1], dz = a.center.z - moved[2];
      const float squared = (dx * dx + dy * dy) + dz * dz;
      const float sum = a.radius * grown_a + radius;
      const float square = sum * sum;
      mask |= static_cast<std::uint64_t>(squared <= square) << i;
      if constexpr (measured) {
        const float t = squared - square;
        const float value = t * (t / ((squared + square) + tiny));
        least = value < least ? value : least;
      }
    }
    masks[j] = mask;
  }
  return least;
}

void test(const NarrowPair& f, const PairBlock& block, std::uint64_t* masks) {
  test_pairs<false>(f, block, masks);
}

constexpr PairKernels kernels{test, test_pairs<true>};

}  // namespace plain

#define MORULA_KERNELS "collide/pairs/pair_kernels.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<PairKernels> table{MORULA_EVERY_KIND(kernels)};

}  // namespace

std::span<const PairKernels> all_pair_kernels() {
  return table.runnable();
}

const PairKernels& pair_kernels() {
  return table.widest();
}

}  // namespace morula::detail
