// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/skin_kernels.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();

/// Registers of one number: the same source in plain loops, also for compilers without vector types.
namespace plain {

constexpr int lanes = 1, doubles = 1;
typedef float Wide;
typedef double Doubles;
typedef double LooseDoubles;
inline Wide all(float x) {
  return x;
}
inline Wide max(Wide a, Wide b) {
  return a > b ? a : b;
}
inline Wide min(Wide a, Wide b) {
  return a < b ? a : b;
}
inline Wide root(Wide a) {
  return std::sqrt(a);
}
inline unsigned lanes_at_most(Wide a, Wide b) {
  return a <= b ? 1 : 0;
}
inline Wide load(const float* first) {
  return *first;
}
inline void store(Wide a, float* first) {
  *first = a;
}
inline Wide power_of(Wide a) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(a) & 0x7f800000u);
}
inline Wide inverse_of_power(Wide a) {
  return std::bit_cast<float>(0x7f000000u - std::bit_cast<std::uint32_t>(a));
}
inline Doubles narrowed(Doubles a) {
  return static_cast<double>(static_cast<float>(a));
}
inline Doubles widened(const float* first) {
  return static_cast<double>(*first);
}
inline void write_narrowed(Doubles a, float* first) {
  *first = static_cast<float>(a);
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
