// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/facets/box_kernels.hpp"

#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

/// The reference: all other kernels have to return the same results.
namespace plain {

bool meet(const BoxList& boxes, std::size_t i, const FloatBox& box) {
  bool met = true;
  for (std::size_t k = 0; k < 3; ++k)
    met = met && boxes.column[k][i] <= box.bound[k + 3] && box.bound[k] <= boxes.column[k + 3][i];
  return met;
}

std::size_t select(const BoxList& boxes, const FloatBox& box, std::uint32_t* found) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < boxes.count; ++i)
    if (meet(boxes, i, box)) found[count++] = static_cast<std::uint32_t>(i);
  return count;
}

FloatBox box_of_meeting(const BoxList& boxes, const FloatBox& box) {
  FloatBox found;
  for (std::size_t i = 0; i < boxes.count; ++i) {
    if (!meet(boxes, i, box)) continue;
    FloatBox each;
    for (std::size_t k = 0; k < 6; ++k) each.bound[k] = boxes.column[k][i];
    found.add(each);
  }
  return found;
}

constexpr BoxKernels kernels{select, box_of_meeting};

}  // namespace plain

#define MORULA_KERNELS "collide/facets/box_kernels.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<BoxKernels> table{MORULA_EVERY_KIND(kernels)};

}  // namespace

std::span<const BoxKernels> all_box_kernels() {
  return table.runnable();
}

const BoxKernels& box_kernels() {
  return table.widest();
}

}  // namespace morula::detail
