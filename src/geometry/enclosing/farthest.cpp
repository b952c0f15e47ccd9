// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "geometry/enclosing/farthest.hpp"

#include <algorithm>

#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

/// The reference: all other kernels have to return the same bits.
namespace plain {

template <class Scalar>
Scalar square_of_distance(const BasicPointColumns<Scalar>& points, std::size_t i, const Vector3<Scalar>& center) {
  const Scalar dx = points.x[i] - center.x, dy = points.y[i] - center.y, dz = points.z[i] - center.z;
  return dx * dx + dy * dy + dz * dz;
}

float squared_distance(const PointColumns& points, const Vec3f& center) {
  float most = 0;
  for (std::size_t i = 0; i < points.count; ++i) most = std::max(most, square_of_distance(points, i, center));
  return most;
}

template <class Height>
std::size_t first_of_highest(std::size_t count, const Height& height) {
  std::size_t at = 0;
  for (std::size_t i = 1; i < count; ++i)
    if (height(i) > height(at)) at = i;
  return at;
}

template <class Scalar>
std::size_t from(const BasicPointColumns<Scalar>& points, const Vector3<Scalar>& center) {
  return first_of_highest(points.count, [&](std::size_t i) { return square_of_distance(points, i, center); });
}

std::size_t along(const PointColumns& points, const Vec3f& direction) {
  return first_of_highest(points.count, [&](std::size_t i) {
    return points.x[i] * direction.x + points.y[i] * direction.y + points.z[i] * direction.z;
  });
}

constexpr FarthestKernels kernels{squared_distance, from<float>, from<double>, along};

}  // namespace plain

#define MORULA_KERNELS "geometry/enclosing/farthest.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<FarthestKernels> table{MORULA_EVERY_KIND(kernels)};

}  // namespace

std::span<const FarthestKernels> all_farthest_kernels() {
  return table.runnable();
}

const FarthestKernels& farthest_kernels() {
  return table.widest();
}

void farthest_along(std::span<const Vec3f> directions, const PointColumns& points, std::span<std::uint32_t> found) {
  const auto along = farthest_kernels().along;
  for (std::size_t d = 0; d < directions.size(); ++d)
    found[d] = static_cast<std::uint32_t>(along(points, directions[d]));
}

}  // namespace morula::detail
