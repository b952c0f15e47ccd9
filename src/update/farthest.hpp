// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The kernel of the exact rule: one walk over points, the largest squared distance to each of a few centres.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <span>

#include "geometry/float4.hpp"

namespace morula {

/// Lists of points come in groups of this many; short ones repeat their last entry, which changes no maximum.
inline constexpr std::size_t points_per_group = 8;

template <class Wide>
struct WidePoints {
  Wide x, y, z;
};
/// Four points by index, coordinate by coordinate.
template <class Wide>
WidePoints<Wide> gather(const LocalPoint* points, const std::uint32_t* index) {
  WidePoints<Wide> p{Wide::load(points[index[0]]), Wide::load(points[index[1]]), Wide::load(points[index[2]])};
  Wide::transpose_points(p.x, p.y, p.z, Wide::load(points[index[3]]));
  return p;
}

template <class Wide>
Wide squared_distance(const WidePoints<Wide>& p, const Wide& x, const Wide& y, const Wide& z) {
  const Wide dx = p.x - x, dy = p.y - y, dz = p.z - z;
  return dx * dx + dy * dy + dz * dz;
}

template <class Wide, std::size_t count>
void farthest_of_few(const LocalPoint* points, std::span<const std::uint32_t> index, const Vec3f* centers,
                     float* squared) {
  Wide x[count], y[count], z[count], farthest[count];
  for (std::size_t k = 0; k < count; ++k) {
    x[k] = Wide(centers[k].x), y[k] = Wide(centers[k].y), z[k] = Wide(centers[k].z);
    farthest[k] = Wide(0.0f);
  }
  for (std::size_t i = 0; i < index.size(); i += 4) {
    const WidePoints<Wide> p = gather<Wide>(points, &index[i]);
    for (std::size_t k = 0; k < count; ++k) farthest[k] = max(squared_distance(p, x[k], y[k], z[k]), farthest[k]);
  }
  for (std::size_t k = 0; k < count; ++k) squared[k] = largest_lane(farthest[k]);
}

inline constexpr std::size_t most_centers = 4;

/// squared[k] = largest squared distance from centers[k] to a point of the list. A maximum has no order, so the result
/// depends on nothing but the points. At most most_centers; index.size() is a multiple of points_per_group.
template <class Wide = Float4>
void farthest(const LocalPoint* points, std::span<const std::uint32_t> index, std::span<const Vec3f> centers,
              float* squared) {
  assert(index.size() % points_per_group == 0 && centers.size() <= most_centers);
  switch (centers.size()) {
    case 4:
      return farthest_of_few<Wide, 4>(points, index, centers.data(), squared);
    case 3:
      return farthest_of_few<Wide, 3>(points, index, centers.data(), squared);
    case 2:
      return farthest_of_few<Wide, 2>(points, index, centers.data(), squared);
    case 1:
      return farthest_of_few<Wide, 1>(points, index, centers.data(), squared);
    default:
      return;
  }
}

using FarthestKernel = void (*)(const LocalPoint* points, std::span<const std::uint32_t> index,
                                std::span<const Vec3f> centers, float* squared);
/// Those that this processor can run, slowest first. All give the same bits: every distance is taken by the same
/// operations in the same order, without fused ones, and then only compared.
std::span<const FarthestKernel> farthest_kernels();

}  // namespace morula
