// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rays over spheres and towards facing surface, with every kind of kernels: against every sample and every sphere.
#include "update/points/ray_kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <vector>

#include "simd/processors.hpp"

namespace morula {
using namespace detail;
namespace {

std::uint32_t bits(float x) {
  return std::bit_cast<std::uint32_t>(x);
}

Vec3f random_point(Random& random, double size) {
  const auto one = [&] { return static_cast<float>(random.uniform(-size, size)); };
  const float x = one(), y = one();
  return {x, y, one()};
}

void set(SampleBlock& block, std::size_t lane, const Vec3f& place, const Vec3f& direction) {
  block.x[lane] = place.x, block.y[lane] = place.y, block.z[lane] = place.z;
  block.dx[lane] = direction.x, block.dy[lane] = direction.y, block.dz[lane] = direction.z;
}

Vec3f place_of(const SampleBlock& block, std::size_t lane) {
  return {block.x[lane], block.y[lane], block.z[lane]};
}
Vec3f direction_of(const SampleBlock& block, std::size_t lane) {
  return {block.dx[lane], block.dy[lane], block.dz[lane]};
}

Spheref around(const SampleBlock& block) {
  Spheref sphere{place_of(block, 0), 0};
  for (std::size_t k = 0; k < block_size; ++k)
    sphere.radius = std::max(sphere.radius, distance(sphere.center, place_of(block, k)));
  return sphere;
}

// A surface of many patches: each within `width`, some of a point alone.
std::vector<SampleBlock> random_blocks(Random& random, std::size_t count, double width) {
  std::vector<SampleBlock> blocks(count);
  for (SampleBlock& block : blocks) {
    const Vec3f middle = random_point(random, 1);
    const double size = random.uniform() < 0.3 ? 0 : width;
    for (std::size_t k = 0; k < block_size; ++k)
      set(block, k, middle + random_point(random, size), normalized(random_point(random, 1), {0, 0, 1}));
  }
  return blocks;
}

class Blocks {
 public:
  explicit Blocks(std::vector<SampleBlock> blocks) : blocks_(std::move(blocks)) {
    places_.reserve(blocks_.size());
    for (std::uint32_t b = 0; b < blocks_.size(); ++b) number_.push_back(b), places_.add(around(blocks_[b]));
  }
  FacingBlocks facing() { return {blocks_.data(), number_.data(), places_.columns()}; }
  const std::vector<SampleBlock>& operator()() const { return blocks_; }

 private:
  std::vector<SampleBlock> blocks_;
  std::vector<std::uint32_t> number_;
  RaySphereList places_;
};

// Over all samples, the sums in the order that the kernels have.
float largest_value(const FacingRay& ray, const std::vector<SampleBlock>& blocks) {
  float largest = 0;
  for (const SampleBlock& block : blocks)
    for (std::size_t k = 0; k < block_size; ++k) {
      const Vec3f to = place_of(block, k) - ray.from;
      if (!(dot(direction_of(block, k), ray.direction) < facing_cosine)) continue;
      largest = std::max(largest, 2 * ray.side * dot(to, ray.direction) / (squared_length(to) + 1e-30f));
    }
  return largest;
}

void expect_nearest(const FacingRay& ray, Blocks& blocks) {
  const float expected = largest_value(ray, blocks());
  for (const RayKernels& kernels : all_ray_kernels()) {
    const float found = kernels.nearness(ray, blocks.facing());
    const char* const kind = kind_name(static_cast<std::size_t>(&kernels - all_ray_kernels().data()));
    if (expected * ray.length > 1)
      EXPECT_EQ(bits(found), bits(expected)) << kind << ", " << found << " for " << expected;
    else
      EXPECT_LE(found, expected) << kind;
  }
}

TEST(RayKernels, find_the_nearest_facing_sample) {
  Random random(5);
  std::size_t blocked = 0, free = 0;
  for (const std::size_t count : {1, 2, 15, 16, 17, 33, 64, 100})
    for (int trial = 0; trial < 200; ++trial) {
      Blocks blocks(random_blocks(random, count, 0.2));
      const FacingRay ray{random_point(random, 1), normalized(random_point(random, 1), {1, 0, 0}),
                          random.uniform() < 0.5 ? 1.0f : -1.0f, static_cast<float>(random.uniform(0.01, 3))};
      expect_nearest(ray, blocks);
      ++(largest_value(ray, blocks()) * ray.length > 1 ? blocked : free);
    }
  EXPECT_GT(blocked, 100u);
  EXPECT_GT(free, 100u);
}

// The start and all samples on one sphere: every value is the same but for rounding, which decides.
TEST(RayKernels, find_the_nearest_of_samples_as_near_as_each_other) {
  Random random(6);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3f direction = normalized(random_point(random, 1), {1, 0, 0}), from = random_point(random, 1);
    const auto radius = static_cast<float>(random.uniform(0.1, 2));
    const float side = trial % 2 == 0 ? 1.0f : -1.0f;
    std::vector<SampleBlock> blocks(64);
    for (SampleBlock& block : blocks) {
      const Vec3f place = from + direction * (side * radius) + normalized(random_point(random, 1), {0, 1, 0}) * radius;
      for (std::size_t k = 0; k < block_size; ++k) set(block, k, place, -direction);
    }
    Blocks on_sphere(std::move(blocks));
    expect_nearest({from, direction, side, 2 * radius}, on_sphere);
  }
}

TEST(RayKernels, raise_to_where_rays_leave_the_farthest_sphere) {
  Random random(7);
  for (const std::size_t count : {1, 3, 16, 17, 40, 300})
    for (int trial = 0; trial < 50; ++trial) {
      const SampleBlock block = random_blocks(random, 1, 0.3)[0];
      std::vector<Spheref> spheres(count);
      RaySphereList list;
      list.reserve(count);
      for (Spheref& s : spheres) {
        s = {random_point(random, 1), static_cast<float>(random.uniform(0, 1))};
        list.add(s);
      }
      const float side = trial % 2 == 0 ? 1.0f : -1.0f;
      std::array<float, block_size> before{}, expected{};
      for (float& height : before) height = random.uniform() < 0.5 ? 0 : static_cast<float>(random.uniform());
      for (std::size_t k = 0; k < block_size; ++k) {
        expected[k] = before[k];
        for (const Spheref& s : spheres) {
          const Vec3f from = place_of(block, k) - s.center;
          const float depth = s.radius * s.radius - squared_length(from);
          if (!(depth > 0)) continue;
          const float along = side * dot(from, direction_of(block, k));
          expected[k] = std::max(expected[k], std::sqrt(along * along + depth) - along);
        }
      }
      for (const RayKernels& kernels : all_ray_kernels()) {
        std::array<float, block_size> found = before;
        kernels.raise(block, around(block), list.columns(), side, found.data());
        for (std::size_t k = 0; k < block_size; ++k)
          EXPECT_EQ(bits(found[k]), bits(expected[k]))
              << kind_name(static_cast<std::size_t>(&kernels - all_ray_kernels().data())) << ", " << count
              << " spheres";
      }
    }
}

}  // namespace
}  // namespace morula
