// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The loops of an update that wide registers speed up: one source, kernels.inl, compiled for each kind of processor and
// chosen at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <span>

#include "simd/float4.hpp"

namespace morula::detail {

/// Lists of points come in groups of this many; short ones repeat their last entry, which changes no maximum.
inline constexpr std::size_t points_per_group = 16;
inline constexpr std::size_t most_centers = 4;
/// Points that stand for all that a node owns when its centre is pulled.
inline constexpr std::size_t core_size = 32;

/// Points [begin, end), a multiple of points_per_group.
struct PointRun {
  std::uint32_t begin, end;
};

/// A centre on its way: see pull.
struct Pull {
  const std::uint32_t* core;  ///< core_size points
  float enough;               ///< squared: a largest squared distance at or below this ends the pull
  float rest_radius;          ///< largest distance to the core at rest
};

/// All kernels give the same bits: every distance is taken by the same operations in the same order, without fused
/// ones, and then only compared.
struct Kernels {
  /// squared[k] = largest squared distance from centers[k] to a point of the runs or of the list; 0 without any. At
  /// most most_centers; index.size() is a multiple of points_per_group.
  void (*farthest)(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
                   std::span<const Vec3f> centers, float* squared);
  /// The centre moved towards the farthest point of its core, up to pull_steps times: the best place on the way
  /// [badoiu2003], so never one farther from the core than it was.
  Vec3f (*pull)(const LocalPoint* points, const Pull& pull, const Vec3f& center);
  /// out[i] = the i-th of `count` packed points (x, y, z of each, nothing between) minus origin. Returns the largest
  /// bit pattern of an absolute coordinate: of infinity or more when one is not finite.
  std::uint32_t (*narrow_floats)(const float* packed, std::size_t count, const Vec3f& origin, LocalPoint* out);
};
inline constexpr int pull_steps = 4;

/// Those that this processor can run, narrowest first.
std::span<const Kernels> all_kernels();
/// The widest.
const Kernels& kernels();

}  // namespace morula::detail
