// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/skin_kernels.hpp"

#include <cmath>
#include <limits>

#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Registers of one double: the same source in plain loops, also for compilers without vector types.
namespace plain {

constexpr int doubles = 1;
typedef double Doubles;
typedef double LooseDoubles;
inline unsigned greater(Doubles a, Doubles b) {
  return a > b ? 1 : 0;
}
inline Doubles root(Doubles a) {
  return std::sqrt(a);
}
inline Doubles narrowed(Doubles a) {
  return static_cast<double>(static_cast<float>(a));
}
#include "update/rules/skin_kernels.inl"

}  // namespace plain

#define MORULA_KERNELS "update/rules/skin_kernels.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<SkinKernels> table{MORULA_EVERY_KIND(kernels)};

}  // namespace

std::span<const SkinKernels> all_skin_kernels() {
  return table.runnable();
}

const SkinKernels& skin_kernels() {
  return table.widest();
}

}  // namespace morula::detail
