// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <limits>

#include "collide/facets/leaf_surfaces.hpp"
#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// The reference: all other kernels have to return the same bits.
namespace plain {

float smaller(float a, float b) {
  return a < b ? a : b;
}
float larger(float a, float b) {
  return a > b ? a : b;
}
float axis_gap(float p, float a, float b, float c) {
  const float lower = smaller(smaller(a, b), c), upper = larger(larger(a, b), c);
  return larger(larger(lower - p, p - upper), 0.0f);
}

float squared_gaps(const FacetColumns& facets, const Vec3f& p, float* squared) {
  float least = infinity;
  for (std::size_t i = 0; i < facets.count; ++i) {
    const auto column = [&](int k) { return facets.column[k][i]; };
    const float dx = axis_gap(p.x, column(0), column(3), column(6));
    const float dy = axis_gap(p.y, column(1), column(4), column(7));
    const float dz = axis_gap(p.z, column(2), column(5), column(8));
    squared[i] = dx * dx + dy * dy + dz * dz;
    least = smaller(squared[i], least);
  }
  return least;
}

unsigned at_most(const float* numbers, float limit) {
  unsigned bits = 0;
  for (std::size_t i = 0; i < facet_columns_step; ++i) bits |= (numbers[i] <= limit ? 1u : 0u) << i;
  return bits;
}

float reach(const FacetColumns& facets, const Vec3f& direction) {
  float most = -infinity;
  for (std::size_t i = 0; i < facets.count; ++i)
    for (int k = 0; k < 9; k += 3)
      most = larger(facets.column[k][i] * direction.x + facets.column[k + 1][i] * direction.y +
                        facets.column[k + 2][i] * direction.z,
                    most);
  return most;
}

constexpr FacetKernels kernels{squared_gaps, at_most, reach};

}  // namespace plain

#define MORULA_KERNELS "collide/facets/facet_columns.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<FacetKernels> table{MORULA_EVERY_KIND(kernels)};

}  // namespace

std::span<const FacetKernels> all_facet_kernels() {
  return table.runnable();
}

const FacetKernels& facet_kernels() {
  return table.widest();
}

}  // namespace morula::detail
