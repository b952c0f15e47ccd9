// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "plan/filter.hpp"

#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::robot {

using detail::KernelTable;
using detail::LocalPoint;

namespace {

/// One lane: the plain loops are the same source.
namespace plain {

constexpr int lanes = 1;
using Wide = float;
inline Wide all(float x) {
  return x;
}
inline Wide load(const float* first) {
  return *first;
}
inline void store(Wide a, float* first) {
  *first = a;
}
inline Wide max(Wide a, Wide b) {
  return a > b ? a : b;
}
inline Wide min(Wide a, Wide b) {
  return a < b ? a : b;
}
inline unsigned lanes_at_most(Wide a, Wide b) {
  return a <= b ? 1 : 0;
}
#include "plan/filter.inl"

}  // namespace plain

#define MORULA_KERNELS "plan/filter.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<FilterKernels> filter_table{MORULA_EVERY_KIND(kernels)};

}  // namespace

const FilterKernels& filter_kernels() {
  return filter_table.widest();
}

}  // namespace morula::robot
