// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The kernel of k-DOPs: one walk over points computes their extents along k / 2 directions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "update/points/kernels.hpp"

namespace morula::detail {

/// The slabs of a k-DOP: the axes, then (14 and 26) the corners of the cube, then (18 and 26) its edges.
constexpr bool has_corner_slabs(int k) {
  return k == 14 || k == 26;
}
constexpr bool has_edge_slabs(int k) {
  return k == 18 || k == 26;
}

/// lower[i], upper[i]: least and largest projection on slab i of the points of all runs and of the list, in float;
/// zeros are positive. Runs and index: whole groups. At least one point.
using SlabKernel = void (*)(const LocalPoint* points, std::span<const PointRun> runs,
                            std::span<const std::uint32_t> index, float* lower, float* upper);

/// The kernels for k = 6, 14, 18 or 26 that this processor can run, slowest first. All give the same bits: the same
/// sums in the same order, and these are only compared.
std::span<const SlabKernel> slab_kernels(int k);

}  // namespace morula::detail
