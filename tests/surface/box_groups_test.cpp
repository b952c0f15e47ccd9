// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Groups of boxes: every kind of processor against plain loops, and plain loops against intervals.
#include "surface/boxes/box_groups.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <morula/geometry/reproducible.hpp>

#include "simd/processors.hpp"

namespace morula::detail {
namespace {

BoxGroup random_group(Random& random) {
  BoxGroup group;
  group.clear();
  for (std::size_t i = 0; i < 8; ++i) {
    if (random.next() % 5 == 0) continue;  // nothing there
    for (std::size_t k = 0; k < 3; ++k) {
      // Few values, so that many bounds are equal.
      const auto lower = static_cast<float>(static_cast<int>(random.next() % 9) - 4);
      group.bound[k][i] = lower;
      group.bound[k + 3][i] = lower + static_cast<float>(random.next() % 4);
    }
  }
  return group;
}

TEST(BoxGroups, all_processors_find_what_intervals_say) {
  Random random(3);
  std::size_t met = 0;
  for (int round = 0; round < 2000; ++round) {
    const BoxGroup a = random_group(random), b = random_group(random);
    const float r = static_cast<float>(random.next() % 3);
    const BoxReach reach{{r, r, r}, {-r, -r, -r}};
    std::uint64_t expected = 0;
    for (std::size_t i = 0; i < 8; ++i)
      for (std::size_t j = 0; j < 8; ++j) {
        bool apart = a.bound[0][i] > a.bound[3][i] || b.bound[0][j] > b.bound[3][j];
        for (std::size_t k = 0; k < 3; ++k)
          apart = apart || a.bound[k][i] - b.bound[k + 3][j] > r || b.bound[k][j] - a.bound[k + 3][i] > r;
        if (!apart) expected |= std::uint64_t{1} << (8 * i + j), ++met;
      }
    for (std::size_t kind = 0; kind < all_meet_groups().size(); ++kind)
      ASSERT_EQ(all_meet_groups()[kind](a, b, reach), expected) << kind_name(kind);
  }
  EXPECT_GT(met, 1000u);
}

TEST(VertexBoxes, all_processors_round_to_the_next_float_outwards) {
  Random random(4);
  std::vector<double> numbers{0.0,       -0.0,        1.0,          -1.0,       1e-50,     -1e-50,           0x1p-149,
                              -0x1p-149, 0x1.8p-149,  -0x1.8p-149,  0x1p-126,   -0x1p-126, 0x1.fffffffp-127, 0x1p102,
                              -0x1p102,  1 + 0x1p-30, -1 - 0x1p-30, 1 - 0x1p-30};
  for (int i = 0; i < 3000; ++i)
    numbers.push_back(std::ldexp(random.uniform(-1, 1), static_cast<int>(random.next() % 250) - 150));
  while (numbers.size() % 3 != 0) numbers.push_back(0);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < numbers.size(); i += 3) points.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
  points.emplace_back();  // what may be read beyond
  const std::size_t count = points.size() - 1;
  std::vector<MinBox> boxes(count);
  for (std::size_t kind = 0; kind < all_make_vertex_boxes().size(); ++kind) {
    all_make_vertex_boxes()[kind](points.data(), points.data(), count, boxes.data());
    for (std::size_t i = 0; i < count; ++i)
      for (int k = 0; k < 3; ++k) {
        const double x = points[i][k];
        const float lower = boxes[i].bound[k], upper = -boxes[i].bound[k + 4];
        ASSERT_LE(static_cast<double>(lower), x) << kind_name(kind);
        ASSERT_GE(static_cast<double>(upper), x) << kind_name(kind);
        ASSERT_GT(static_cast<double>(std::nextafter(lower, 1e38f)), x) << kind_name(kind);
        ASSERT_LT(static_cast<double>(std::nextafter(upper, -1e38f)), x) << kind_name(kind);
      }
  }
}

}  // namespace
}  // namespace morula::detail
