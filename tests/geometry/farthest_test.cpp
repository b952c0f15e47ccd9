// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The farthest of many points, with every kind of kernels: against a search in plain words, the first of equals.
#include "geometry/enclosing/farthest.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sampling.hpp>
#include <vector>

namespace morula {
using namespace detail;
namespace {

struct Points {
  std::vector<float> x, y, z;
  PointColumns columns() const { return {x.data(), y.data(), z.data(), x.size()}; }
};

// places: few, so that there are equals, or 0 for any.
Points random_points(std::size_t count, int places, std::uint64_t seed) {
  Random random(seed);
  const auto coordinate = [&] {
    const double v = 2 * random.uniform() - 1;
    return static_cast<float>(places > 0 ? std::round(places * v) : v);
  };
  Points points;
  for (std::size_t i = 0; i < count; ++i)
    points.x.push_back(coordinate()), points.y.push_back(coordinate()), points.z.push_back(coordinate());
  return points;
}

template <class Height>
std::size_t first_of_highest(const Points& points, const Height& height) {
  std::size_t best = 0;
  for (std::size_t i = 0; i < points.x.size(); ++i)
    if (height(Vec3f{points.x[i], points.y[i], points.z[i]}) >
        height(Vec3f{points.x[best], points.y[best], points.z[best]}))
      best = i;
  return best;
}

TEST(Farthest, is_the_first_of_the_farthest_with_every_kind_of_kernels) {
  std::vector<Vec3f> directions{{0, 0, 0}, {1, 0, 0}};
  for (const Vec3& d : fibonacci_directions(12)) directions.emplace_back(d);
  for (const std::size_t count :
       {1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 31, 33, 63, 64, 65, 101, 127, 128, 129, 300, 1025})
    for (const int places : {0, 1, 2, 20}) {
      const Points points = random_points(count, places, 7 * count + static_cast<std::size_t>(places));
      for (const Vec3f& d : directions) {
        const auto square = [&](const Vec3f& p) { return squared_length(p - d); };
        const std::size_t from = first_of_highest(points, square);
        const float squared = square({points.x[from], points.y[from], points.z[from]});
        const std::size_t along = first_of_highest(points, [&](const Vec3f& p) { return dot(p, d); });
        for (const FarthestKernels& kernels : all_farthest_kernels()) {
          const auto kind = static_cast<std::size_t>(&kernels - all_farthest_kernels().data());
          EXPECT_EQ(kernels.from(points.columns(), d), from) << count << " points, kind " << kind;
          EXPECT_EQ(std::bit_cast<std::uint32_t>(kernels.squared_distance(points.columns(), d)),
                    std::bit_cast<std::uint32_t>(squared))
              << count << " points, kind " << kind;
          EXPECT_EQ(kernels.along(points.columns(), d), along) << count << " points, kind " << kind;
        }
      }
    }
}

TEST(Farthest, looks_at_every_point_wherever_it_is) {
  for (const std::size_t count : {1, 4, 8, 16, 17, 100, 257})
    for (std::size_t at = 0; at < count; ++at) {
      Points points = random_points(count, 0, count);
      points.y[at] = -9;
      for (const FarthestKernels& kernels : all_farthest_kernels()) {
        EXPECT_EQ(kernels.from(points.columns(), {0, 1, 0}), at);
        EXPECT_EQ(kernels.along(points.columns(), {0, -1, 0}), at);
        EXPECT_GE(kernels.squared_distance(points.columns(), {0, 1, 0}), 100.0F);
      }
      std::uint32_t found = 0;
      farthest_along(std::vector<Vec3f>{{0, -1, 0}}, points.columns(), {&found, 1});
      EXPECT_EQ(found, at);
    }
}

TEST(Farthest, ends_where_coordinates_are_no_numbers) {
  for (const std::size_t count : {1, 5, 40, 200}) {
    Points points = random_points(count, 0, count);
    for (float& x : points.x) x = std::nanf("");
    for (const FarthestKernels& kernels : all_farthest_kernels()) {
      EXPECT_LT(kernels.from(points.columns(), {0, 0, 0}), count);
      EXPECT_LT(kernels.along(points.columns(), {1, 1, 1}), count);
    }
  }
}

}  // namespace
}  // namespace morula
