// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Corners of many facets in columns of floats, and the two loops over them that contacts need.
#pragma once

#include <cstddef>
#include <morula/geometry/vector.hpp>
#include <span>

namespace morula::detail {

/// Corner k of facet i is (column[3 k][i], column[3 k + 1][i], column[3 k + 2][i]). count: a multiple of
/// facet_columns_step, filled up with repetitions of a facet.
struct FacetColumns {
  const float* column[9];
  std::size_t count;
};
inline constexpr std::size_t facet_columns_step = 16;

/// All give the same bits: the same operations in the same order, none of them fused.
struct FacetKernels {
  /// squared[i] = squared distance of p from the box of facet i; room for count. Returns the least.
  float (*squared_gaps)(const FacetColumns& facets, const Vec3f& p, float* squared);
  /// Of facet_columns_step numbers: bit i is set where number i is at most `limit`.
  unsigned (*at_most)(const float* numbers, float limit);
  /// Largest corner . direction. count > 0.
  float (*reach)(const FacetColumns& facets, const Vec3f& direction);
};
/// Narrowest first; what this processor runs.
std::span<const FacetKernels> all_facet_kernels();
/// The widest.
const FacetKernels& facet_kernels();

}  // namespace morula::detail
