// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The farthest of many points: from a center, or along directions. One source, farthest.inl, compiled for each kind of
// processor and chosen at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <span>

namespace morula::detail {

/// Points in columns: at least one, all finite.
template <class Scalar>
struct BasicPointColumns {
  const Scalar* x;
  const Scalar* y;
  const Scalar* z;
  std::size_t count;
};
using PointColumns = BasicPointColumns<float>;
using DoublePointColumns = BasicPointColumns<double>;

/// Sums of three products are in the order x, y, z.
struct FarthestKernels {
  /// The square of the largest distance from a center.
  float (*squared_distance)(const PointColumns& points, const Vec3f& center);
  /// The point farthest from a center, the first of equals.
  std::size_t (*from)(const PointColumns& points, const Vec3f& center);
  std::size_t (*from_in_double)(const DoublePointColumns& points, const Vec3& center);
  /// The point farthest along a direction, the first of equals.
  std::size_t (*along)(const PointColumns& points, const Vec3f& direction);
};

/// The kernels that this processor runs, the narrowest first. All give the same bits.
std::span<const FarthestKernels> all_farthest_kernels();
/// The widest kernels.
const FarthestKernels& farthest_kernels();

/// Writes to found[d] the point farthest along directions[d], the first of equals. Cost: points × directions, in
/// registers.
void farthest_along(std::span<const Vec3f> directions, const PointColumns& points, std::span<std::uint32_t> found);

}  // namespace morula::detail
