// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/points/ray_kernels.hpp"

#include <cmath>
#include <limits>

#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

// nearness() skips more and more samples. A sample y becomes as near to the point t along a ray as the ray's start x is
// where t is 1 over y's value: so values are above 1 / t inside the ball around that point on whose surface x is, and
// nowhere else. Once a value was found, only samples in its ball can have a larger one. The ball that is kept is larger
// by the share a below, for rounding: outside that one exact values are less than 1 / t by the share 2 a t² / |y − x|²,
// which is 2 a / 5 or more up to |y − x| = 2.2 t; farther away they are below 2 / |y − x|, a tenth less. Rounding
// changes them by about 1e-6.
// mutant rays-kept-around: `1.001f` -> `1`
constexpr float kept_around = 1.001f;
constexpr std::size_t spheres_step = RaySpheres::step;
constexpr std::size_t whole_steps(std::size_t count) {
  return (count + spheres_step - 1) / spheres_step * spheres_step;
}
constexpr float much = 1e30f;  // times what is above 0, at least 1 unless that is below 1e-30

/// The reference that the other kernels reproduce.
namespace plain {

float max(float a, float b) {
  return a > b ? a : b;
}
float min(float a, float b) {
  return a < b ? a : b;
}
float is_positive(float value) {
  return min(max(value * much, 0), 1);
}

/// Bit i: sphere begin + i touches.
unsigned touching(const RaySpheres& spheres, std::size_t begin, const Vec3f& center, float radius) {
  unsigned bits = 0;
  for (std::size_t i = 0; i < spheres_step; ++i) {
    const float x = spheres.x[begin + i] - center.x, y = spheres.y[begin + i] - center.y,
                z = spheres.z[begin + i] - center.z;
    const float reach = spheres.radius[begin + i] + radius;
    bits |= static_cast<unsigned>(x * x + y * y + z * z <= reach * reach) << i;
  }
  return bits;
}

void raise(const SampleBlock& block, const Spheref& places, const RaySpheres& spheres, float side, float* heights) {
  for (std::size_t begin = 0; begin < spheres.count; begin += spheres_step) {
    const unsigned bits = touching(spheres, begin, places.center, places.radius);
    for (std::size_t i = begin; i < begin + spheres_step; ++i) {
      if ((bits >> (i - begin) & 1) == 0) continue;
      const float square = spheres.radius[i] * spheres.radius[i];
      for (std::size_t k = 0; k < block_size; ++k) {
        const float x = block.x[k] - spheres.x[i], y = block.y[k] - spheres.y[i], z = block.z[k] - spheres.z[i];
        const float along = side * (x * block.dx[k] + y * block.dy[k] + z * block.dz[k]);
        const float depth = max(square - (x * x + y * y + z * z), 0);
        heights[k] = max(heights[k], (std::sqrt(along * along + depth) - along) * is_positive(depth));
      }
    }
  }
}

float nearness(const FacingRay& ray, const FacingBlocks& facing) {
  const Vec3f from = ray.from, d = ray.direction;
  float middle = ray.side * ray.length, radius = ray.length, found = 0;
  float nearest[block_size] = {};
  for (std::size_t begin = 0; begin < facing.places.count; begin += spheres_step) {
    const unsigned bits = touching(facing.places, begin, from + d * middle, radius);
    if (bits == 0) continue;
    for (std::size_t i = 0; i < spheres_step; ++i) {
      if ((bits >> i & 1) == 0) continue;
      const SampleBlock& block = facing.blocks[facing.number[begin + i]];
      for (std::size_t k = 0; k < block_size; ++k) {
        const float x = block.x[k] - from.x, y = block.y[k] - from.y, z = block.z[k] - from.z;
        const float along = x * d.x + y * d.y + z * d.z;
        const float cosine = block.dx[k] * d.x + block.dy[k] * d.y + block.dz[k] * d.z;
        const float value = 2 * ray.side * along / (x * x + y * y + z * z + 1 / much);
        nearest[k] = max(nearest[k], value * is_positive(facing_cosine - cosine));
      }
    }
    for (const float value : nearest) found = max(value, found);
    if (found * ray.length > 1) middle = ray.side / found, radius = kept_around / found;
  }
  return found;
}

constexpr RayKernels kernels{raise, nearness};

}  // namespace plain

#define MORULA_KERNELS "update/points/ray_kernels.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<RayKernels> table{MORULA_EVERY_KIND(kernels)};

}  // namespace

std::span<const RayKernels> all_ray_kernels() {
  return table.runnable();
}

const RayKernels& ray_kernels() {
  return table.widest();
}

void RaySphereList::reserve(std::size_t most) {
  for (std::vector<float>* column : {&x_, &y_, &z_, &radius_}) column->resize(whole_steps(most));
}

void RaySphereList::add(const Spheref& sphere) noexcept {
  x_[count_] = sphere.center.x, y_[count_] = sphere.center.y, z_[count_] = sphere.center.z;
  radius_[count_] = sphere.radius;
  ++count_;
}

RaySpheres RaySphereList::columns() noexcept {
  const std::size_t end = whole_steps(count_);
  for (std::size_t i = count_; i < end; ++i) radius_[i] = std::numeric_limits<float>::quiet_NaN();
  return {x_.data(), y_.data(), z_.data(), radius_.data(), end};
}

}  // namespace morula::detail
