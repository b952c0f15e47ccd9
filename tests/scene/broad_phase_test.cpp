// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The broad phase gives the pairs that comparing every box with every other gives, whatever comes, goes and moves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <morula/geometry/reproducible.hpp>
#include <morula/scene/broad_phase.hpp>
#include <stdexcept>
#include <support/allocations.hpp>

namespace morula {
namespace {

struct Known {
  Box box;
  bool is_static;
};
using Boxes = std::map<std::uint32_t, Known>;

std::uint32_t index(Random& random, std::size_t count) {
  return static_cast<std::uint32_t>(random.next() % count);
}

bool share_a_point(const Box& a, const Box& b) {
  return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y && b.lower.y <= a.upper.y &&
         a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
}

std::vector<BoxPair> pairs_by_force(const Boxes& boxes) {
  std::vector<BoxPair> pairs;
  for (auto i = boxes.begin(); i != boxes.end(); ++i)
    for (auto j = std::next(i); j != boxes.end(); ++j)
      if (!(i->second.is_static && j->second.is_static) && share_a_point(i->second.box, j->second.box))
        pairs.push_back({i->first, j->first});
  return pairs;
}

Box random_box(Random& random, double room, double size) {
  const Vec3 lower{random.uniform(-room, room), random.uniform(-room, room), random.uniform(-room, room)};
  // Some are flat, some are points, some share faces.
  const auto side = [&] { return index(random, 4) == 0 ? 0.0 : random.uniform(0, size); };
  Box box{lower, lower + Vec3{side(), side(), side()}};
  if (index(random, 3) != 0) return box;
  for (int axis = 0; axis < 3; ++axis)
    box.lower[axis] = std::round(box.lower[axis]),
    box.upper[axis] = std::max(box.lower[axis], std::round(box.upper[axis]));
  return box;
}

TEST(BroadPhase, has_the_pairs_of_brute_force_in_random_sequences) {
  Random random(11);
  for (int round = 0; round < 20; ++round) {
    BroadPhase broad;
    Boxes boxes;
    const double room = round % 3 == 0 ? 1e12 : 6;
    for (int step = 0; step < 120; ++step) {
      for (std::uint32_t k = index(random, 6); k-- > 0;) {
        const Known known{random_box(random, room, 2), index(random, 4) == 0};
        const std::uint32_t number = broad.add(known.box, known.is_static);
        ASSERT_TRUE(boxes.emplace(number, known).second) << "a number that is in use";
      }
      for (auto& [number, known] : boxes) {
        const std::uint32_t what = index(random, 8);
        if (what == 0) known.box = random_box(random, room, 3);
        const Vec3 way = Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * 0.05;
        if (what < 4) known.box = {known.box.lower + way, known.box.upper + way};
        if (what < 4) {
          ASSERT_TRUE(broad.move(number, known.box));
        }
      }
      for (std::uint32_t k = index(random, 4); k-- > 0 && !boxes.empty();) {
        const auto gone = std::next(boxes.begin(), index(random, boxes.size()));
        broad.remove(gone->first);
        boxes.erase(gone);
      }
      broad.update();
      const std::vector<BoxPair> expected = pairs_by_force(boxes);
      ASSERT_TRUE(std::equal(expected.begin(), expected.end(), broad.pairs().begin(), broad.pairs().end()))
          << "round " << round << ", step " << step << ": " << broad.pairs().size() << " pairs, not "
          << expected.size();
      ASSERT_EQ(broad.size(), boxes.size());
      std::vector<std::uint32_t> found, by_force;
      const Box asked = random_box(random, room, 6);
      broad.find(asked, found);
      for (const auto& [number, known] : boxes)
        if (share_a_point(known.box, asked)) by_force.push_back(number);
      ASSERT_EQ(found, by_force);
    }
  }
}

TEST(BroadPhase, finds_what_a_ray_or_a_half_space_reaches) {
  Random random(12);
  BroadPhase broad;
  Boxes boxes;
  for (int i = 0; i < 300; ++i) {
    const Box box = random_box(random, 3, 2);
    boxes[broad.add(box)] = {box, false};
  }
  std::vector<std::uint32_t> found;
  std::size_t met = 0;
  for (int i = 0; i < 300; ++i) {
    // A point of the box on the ray, or on the plane: whatever has one has to be there.
    const Vec3 origin{random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5)};
    Vec3 direction{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (i % 5 == 0) direction = {0, 0, 1};
    broad.find_along(origin, direction, 8, found);
    for (const auto& [number, known] : boxes) {
      bool hit = false;
      for (int k = 0; k <= 2000 && !hit; ++k) {
        const Vec3 p = origin + direction * (8.0 * k / 2000);
        hit = share_a_point(known.box, {p, p});
      }
      met += hit;
      EXPECT_TRUE(!hit || std::binary_search(found.begin(), found.end(), number));
    }
    EXPECT_LT(found.size(), boxes.size());
    broad.find_behind(direction, -2, found);
    for (const auto& [number, known] : boxes) {
      bool behind = false;
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p{corner & 1 ? known.box.lower.x : known.box.upper.x,
                     corner & 2 ? known.box.lower.y : known.box.upper.y,
                     corner & 4 ? known.box.lower.z : known.box.upper.z};
        behind = behind || dot(direction, p) <= -2;
      }
      EXPECT_TRUE(!behind || std::binary_search(found.begin(), found.end(), number));
    }
    EXPECT_LT(found.size(), boxes.size());
  }
  EXPECT_GT(met, 300u) << "hardly any ray meets a box";
}

TEST(BroadPhase, refuses_what_is_no_box_and_what_is_not_there) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  BroadPhase broad;
  const Box box{{0, 0, 0}, {1, 1, 1}};
  const std::uint32_t a = broad.add(box), b = broad.add(box);
  broad.update();
  for (const Box& bad : {Box{}, Box{{0, 0, 0}, {1, nan, 1}}, Box{{0, 0, 0}, {infinity, 1, 1}},
                         Box{{-1e308, 0, 0}, {1.7e308, 1, 1}}, Box{{1, 0, 0}, {0, 1, 1}}}) {
    EXPECT_THROW(broad.add(bad), std::invalid_argument);
    const Status status = broad.move(a, bad);
    EXPECT_EQ(status.code, Status::Code::bad_option);
    EXPECT_EQ(status.index, a);
  }
  EXPECT_EQ(broad.move(77, box).code, Status::Code::bad_option);
  broad.remove(b);
  EXPECT_THROW(broad.remove(b), std::invalid_argument);
  EXPECT_THROW(broad.remove(77), std::invalid_argument);
  EXPECT_EQ(broad.size(), 1u);
  EXPECT_EQ(broad.box(a).upper, box.upper);
  broad.update();
  EXPECT_TRUE(broad.pairs().empty());
  EXPECT_EQ(broad.add(box), b) << "the lowest number that is free";
  broad.update();
  EXPECT_EQ(broad.pairs().size(), 1u);
}

TEST(BroadPhase, finds_what_a_half_space_reaches_however_short_or_long_its_normal_is) {
  Random random(9);
  BroadPhase broad;
  for (int i = 0; i < 300; ++i) broad.add(random_box(random, 6, 2), true);
  for (int i = 0; i < 200; ++i) {
    const Vec3 normal{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const double offset = random.uniform(-8, 3);
    std::vector<std::uint32_t> expected, found;
    broad.find_behind(normal, offset, expected);
    for (const int exponent : {-1060, -1000, -300, 300, 1010}) {
      const auto scaled = [&](double x) { return std::ldexp(x, exponent); };
      broad.find_behind({scaled(normal.x), scaled(normal.y), scaled(normal.z)}, scaled(offset), found);
      // The shortest normals have few digits.
      if (exponent < -1022) {
        EXPECT_NEAR(static_cast<double>(found.size()), static_cast<double>(expected.size()), 10);
      } else {
        EXPECT_EQ(found, expected);
      }
    }
  }
  // Boxes around the plane, so that every one is reached.
  BroadPhase flat;
  for (int i = 0; i < 100; ++i) {
    const Vec3 c{random.uniform(-1, 1) * 1e-5, random.uniform(-9, 9), random.uniform(-9, 9)};
    flat.add({{c.x, c.y, c.z}, {c.x + 1, c.y, c.z}}, true);
  }
  std::vector<std::uint32_t> found;
  flat.find_behind({0x1p-1070, 0, 0}, std::ldexp(1.0, -1070), found);
  EXPECT_EQ(found.size(), 100u);
}

TEST(BroadPhase, finds_the_boxes_that_a_moving_box_meets) {
  Random random(10);
  BroadPhase broad;
  Boxes boxes;
  for (int i = 0; i < 400; ++i) {
    const Box box = random_box(random, 6, 1);
    boxes[broad.add(box)] = {box, false};
  }
  std::size_t met = 0, listed = 0;
  for (int i = 0; i < 300; ++i) {
    const Box box = random_box(random, 6, 2);
    Vec3 motion{random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)};
    if (i % 5 == 0) motion = {0, 0, 3};
    if (i % 7 == 0) motion = {};
    std::vector<std::uint32_t> found;
    broad.find_along(box, motion, found);
    for (const auto& [number, known] : boxes) {
      bool hit = false;
      for (int k = 0; k <= 1000 && !hit; ++k) {
        const Vec3 shift = motion * (k / 1000.0);
        hit = share_a_point(known.box, {box.lower + shift, box.upper + shift});
      }
      met += hit;
      EXPECT_TRUE(!hit || std::binary_search(found.begin(), found.end(), number));
    }
    listed += found.size();
  }
  EXPECT_GT(met, 400u);
  EXPECT_LT(listed, 2 * met) << "boxes about the whole way would list more";
}

TEST(BroadPhase, allocates_nothing_once_it_has_seen_the_motion) {
  BroadPhase broad;
  std::vector<std::uint32_t> numbers;
  const auto box_at = [](std::size_t i, double t) {
    const double x = static_cast<double>(i % 10), y = static_cast<double>(i / 10);
    const Vec3 c{x + 0.7 * t * (y - 4), y, 0.3 * x * t};
    return Box{c, c + Vec3{1.1, 1.1, 1.1}};
  };
  for (std::size_t i = 0; i < 100; ++i) numbers.push_back(broad.add(box_at(i, 0)));
  bool good = true;
  std::size_t pairs = 0;
  const auto go = [&] {
    for (int step = 0; step < 40; ++step) {
      const double t = std::abs(step - 20) / 20.0;
      for (std::size_t i = 0; i < 100; ++i) good = good && broad.move(numbers[i], box_at(i, t));
      broad.remove(numbers[7]);
      numbers[7] = broad.add(box_at(7, t));
      broad.update();
      pairs += broad.pairs().size();
    }
  };
  go(), go();
  const std::size_t before = test::allocations;
  go();
  EXPECT_EQ(test::allocations - before, 0u);
  EXPECT_TRUE(good);
  EXPECT_GT(pairs, 1000u);
}

}  // namespace
}  // namespace morula
