// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rays from samples of the surface: where they leave spheres, and how near they come to surface that faces them. Most
// of what an estimate of looseness computes. One source, ray_kernels.inl, compiled for each kind of processor and
// chosen at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "update/points/surface_samples.hpp"

namespace morula::detail {

/// Between directions: below 60 degrees, rays keep apart as curvature has it.
inline constexpr float facing_cosine = 0.5f;

/// Spheres in columns. A radius that is not a number: nothing is there.
struct RaySpheres {
  static constexpr std::size_t step = 16;
  const float* x;
  const float* y;
  const float* z;
  const float* radius;
  std::size_t count;  ///< a multiple of step
};

struct FacingRay {
  Vec3f from, direction;
  float side;    ///< 1 outward, −1 inward
  float length;  ///< above 0
};

/// Blocks of samples that may face a ray.
struct FacingBlocks {
  const SampleBlock* blocks;
  const std::uint32_t* number;  ///< in blocks
  RaySpheres places;            ///< contain those of each
};

struct RayKernels {
  /// Where rays from the block's samples leave spheres, for those inside: heights grow to the farthest. places:
  /// contains the samples. side: 1 outward, −1 inward.
  void (*raise)(const SampleBlock& block, const Spheref& places, const RaySpheres& spheres, float side, float* heights);
  /// One over the distance along the ray at which a sample y that faces it becomes as near as its start x,
  /// 2 (y − x)·d / |y − x|²: the largest over the samples. Where none is above 1 / length, any number up to that.
  float (*nearness)(const FacingRay& ray, const FacingBlocks& facing);
};

/// Those that this processor can run, narrowest first. All give the same bits.
std::span<const RayKernels> all_ray_kernels();
/// The widest.
const RayKernels& ray_kernels();

/// Spheres that become columns, filled up to whole steps.
class RaySphereList {
 public:
  /// Room for so many. Before the first is added.
  void reserve(std::size_t most);
  void clear() noexcept { count_ = 0; }
  /// At most as many as there is room for.
  void add(const Spheref& sphere) noexcept;
  std::size_t count() const { return count_; }
  /// Valid until the next change.
  RaySpheres columns() noexcept;

 private:
  std::vector<float> x_, y_, z_, radius_;
  std::size_t count_ = 0;
};

}  // namespace morula::detail
