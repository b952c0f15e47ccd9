// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The pair test: spheres of one body against spheres of another, up to 64 x 64 at once. One source, compiled for each
// kind of processor and chosen at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <morula/geometry/sphere.hpp>
#include <span>

#include "collide/pairs/placed_pair.hpp"

namespace morula::detail {

/// Adjacent nodes of both trees: at most 64 each, at least one. Spheres up to `readable` may be read, but have no
/// effect.
struct PairBlock {
  const Spheref* a;
  std::size_t count_a, readable_a;
  const Spheref* b;
  std::size_t count_b, readable_b;
};

/// masks[j] has bit i when a[i] and b[j] overlap or rounding leaves that in doubt (placed_pair.hpp).
struct PairKernels {
  void (*test)(const NarrowPair& pair, const PairBlock& block, std::uint64_t* masks);
  /// Computes the same masks. Returns the least t² / w over all pairs, where t = d² - s² and w = d² + s²: half of it is
  /// below the square of |d - s|, by which distance and sum of grown radii differ.
  float (*test_and_measure)(const NarrowPair& pair, const PairBlock& block, std::uint64_t* masks);
};

/// The kernels that this processor runs, the narrowest first. All give the same bits.
std::span<const PairKernels> all_pair_kernels();
/// The widest kernels.
const PairKernels& pair_kernels();

}  // namespace morula::detail
