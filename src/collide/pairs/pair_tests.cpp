// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cassert>
#include <morula/collide/pair_tests.hpp>

#include "collide/pairs/pair_kernels.hpp"
#include "parallel/float_environment.hpp"
#include "simd/processors.hpp"

namespace morula {
using namespace detail;

std::size_t pair_test_kinds() {
  const StandardFloats standard;
  return all_pair_kernels().size();
}

std::string_view pair_test_kind_name(std::size_t kind) {
  const StandardFloats standard;
  return kind_name(kind);
}

std::size_t count_overlapping(std::span<const Spheref> a, std::span<const Spheref> b, const RigidTransform& transform,
                              std::size_t kind) {
  const StandardFloats standard;
  assert(kind < pair_test_kinds());
  const PairKernels& kernels = all_pair_kernels()[kind];
  const NarrowPair pair = placed_pair(transform, 0, 0).narrow;
  constexpr std::size_t side = 8;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); i += side)
    for (std::size_t j = 0; j < b.size(); j += side) {
      std::uint64_t masks[side];
      const PairBlock block{&a[i], std::min(side, a.size() - i), a.size() - i,
                            &b[j], std::min(side, b.size() - j), b.size() - j};
      kernels.test(pair, block, masks);
      for (std::size_t k = 0; k < block.count_b; ++k) count += static_cast<std::size_t>(std::popcount(masks[k]));
    }
  return count;
}

}  // namespace morula
