// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cstdint>

#include "simd/float4.hpp"
#include "simd/processors.hpp"
#include "surface/boxes/box_groups.hpp"

namespace morula::detail {
namespace {

/// The reference: all other kernels have to return the same bits.
namespace plain {

/// The largest float that is not above x.
///
/// Bit patterns of floats, read as integers with those of negative floats inverted, are in the order of the floats: one
/// less is the next float down. If the nearest float is above x, that float is the result. A negative x too small for
/// float is rounded to −0, whose number is one less than that of 0; the next one down is the largest negative float.
/// Rounding keeps order: a point between two others along an axis lies between the rounded bounds of the two.
float rounded_down(double x) {
  const auto nearest = static_cast<float>(x);
  auto number = std::bit_cast<std::int32_t>(nearest);
  number ^= (number >> 31) & 0x7fffffff;
  number -= static_cast<double>(nearest) > x ? 1 : 0;
  return std::bit_cast<float>(number ^ ((number >> 31) & 0x7fffffff));
}

void make(const Vec3* lower, const Vec3* upper, std::size_t count, MinBox* boxes) {
  for (std::size_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) {
      boxes[i].bound[k] = rounded_down(lower[i][k]);
      boxes[i].bound[k + 4] = rounded_down(-upper[i][k]);
    }
    boxes[i].bound[3] = boxes[i].bound[7] = 0;
  }
}

}  // namespace plain

#define MORULA_KERNELS "surface/boxes/vertex_boxes.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<MakeVertexBoxes> table{MORULA_EVERY_KIND(make)};

}  // namespace

std::span<const MakeVertexBoxes> all_make_vertex_boxes() {
  return table.runnable();
}

MakeVertexBoxes make_vertex_boxes() {
  return table.widest();
}

}  // namespace morula::detail
