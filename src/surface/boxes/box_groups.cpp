// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/boxes/box_groups.hpp"

#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

/// The reference: all other kernels have to return the same bits.
namespace plain {

std::uint64_t meet(const BoxGroup& a, const BoxGroup& b, const BoxReach& reach) {
  std::uint64_t bits = 0;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) {
      bool met = true;
      for (int k = 0; k < 3; ++k)
        met = met && a.bound[k][i] <= b.bound[k + 3][j] + reach.up[k] &&
              b.bound[k][j] + reach.down[k] <= a.bound[k + 3][i];
      bits |= std::uint64_t{met} << (8 * i + j);
    }
  return bits;
}

}  // namespace plain

#define MORULA_KERNELS "surface/boxes/box_groups.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<MeetGroups> table{MORULA_EVERY_KIND(meet)};

}  // namespace

std::span<const MeetGroups> all_meet_groups() {
  return table.runnable();
}

MeetGroups meet_groups() {
  return table.widest();
}

}  // namespace morula::detail
