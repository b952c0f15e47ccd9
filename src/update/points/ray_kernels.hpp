// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rays from samples of the surface: where they leave spheres, and how near they come to surface that faces them. An
// estimate of looseness spends most of its time here. One source, ray_kernels.inl, is compiled for each kind of
// processor, and the kind is chosen at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "update/points/surface_samples.hpp"

namespace morula::detail {

/// Cosine of the angle between two directions. Below 60 degrees, curvature alone describes how rays keep apart.
inline constexpr float facing_cosine = 0.5f;

/// Spheres in columns. A radius that is NaN marks an unused entry.
struct RaySpheres {
  static constexpr std::size_t step = 16;
  const float* x;
  const float* y;
  const float* z;
  const float* radius;
  std::size_t count;  ///< number of spheres, a multiple of step
};

struct FacingRay {
  Vec3f from, direction;
  float side;    ///< 1 outward, −1 inward
  float length;  ///< above 0
};

/// Blocks of samples that may face a ray.
struct FacingBlocks {
  const SampleBlock* blocks;
  const std::uint32_t* number;  ///< numbers of the blocks
  RaySpheres places;            ///< spheres that contain the places of each block
};

struct RayKernels {
  /// Raises heights to where rays from the block's samples leave spheres, for samples inside: the farthest counts.
  /// places: contains the samples. side: 1 outward, −1 inward.
  void (*raise)(const SampleBlock& block, const Spheref& places, const RaySpheres& spheres, float side, float* heights);
  /// One over the distance along the ray at which a sample y that faces it becomes as near as its start x, 2 (y − x)·d
  /// / |y − x|²: the largest over the samples. If none is above 1 / length, any number up to that.
  float (*nearness)(const FacingRay& ray, const FacingBlocks& facing);
};

/// The kernels that this processor can run, narrowest first. All give the same bits.
std::span<const RayKernels> all_ray_kernels();
/// The widest kernels that this processor can run.
const RayKernels& ray_kernels();

/// Spheres that become columns, filled up to whole steps.
class RaySphereList {
 public:
  /// Reserves room for `most` spheres; called before the first is added.
  void reserve(std::size_t most);
  void clear() noexcept { count_ = 0; }
  /// Adds a sphere; at most as many as there is room for.
  void add(const Spheref& sphere) noexcept;
  std::size_t count() const { return count_; }
  /// The result is valid until the next change.
  RaySpheres columns() noexcept;

 private:
  std::vector<float> x_, y_, z_, radius_;
  std::size_t count_ = 0;
};

}  // namespace morula::detail
