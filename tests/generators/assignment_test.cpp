// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Owners of points, and the memory of fits: each against a plain search over everything.
#include <gtest/gtest.h>

#include <cmath>
#include <generators/fit/assignment.hpp>
#include <generators/fit/child_state.hpp>
#include <morula/geometry/reproducible.hpp>
#include <numeric>

namespace morula {
using namespace detail;
namespace {

constexpr std::size_t most = 9;

// aligned: coordinates are few whole numbers, so that powers are often equal.
Vec3f random_point(Random& random, bool aligned) {
  const auto coordinate = [&] {
    const double u = 20 * random.uniform();
    return static_cast<float>(aligned ? std::floor(u / 4) * 4 : u);
  };
  const float x = coordinate(), y = coordinate();
  return {x, y, coordinate()};
}

GroupPoints random_points(Random& random, std::size_t count, bool aligned) {
  GroupPoints points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(random_point(random, aligned));
  for (std::size_t i = 0; i < count; ++i) points.demand.push_back(static_cast<float>(random.uniform()));
  return points;
}

std::size_t owner_by_search(const Vec3f& p, std::span<const GroupBall> balls, std::span<const float> squares) {
  std::size_t owner = 0;
  float least = INFINITY;
  for (std::size_t b = 0; b < balls.size(); ++b) {
    if (squares[b] < 0) continue;
    const float x = p.x - balls[b].center.x, y = p.y - balls[b].center.y, z = p.z - balls[b].center.z;
    const float power = x * x + y * y + z * z - squares[b];
    if (power < least) least = power, owner = b;
  }
  return owner;
}

// Counts and demands are those of the owners; balls with equal sets have equal hashes, others not.
void expect_in_step(Assignment& assignment) {
  std::vector<std::size_t> count(most, 0);
  std::vector<float> demand(most, 0);
  for (std::size_t i = 0; i < assignment.points().size(); ++i) {
    ++count[assignment.owners()[i]];
    demand[assignment.owners()[i]] += assignment.points().demand[i];
  }
  Assignment same(assignment.points(), most);
  same.set_owners(assignment.owners());
  for (std::size_t b = 0; b < most; ++b) {
    EXPECT_EQ(assignment.count(b), count[b]);
    EXPECT_EQ(assignment.is_used(b), count[b] > 0);
    EXPECT_EQ(assignment.demand()[b], demand[b]) << "summed in the order of points";
    EXPECT_EQ(assignment.hash(b), same.hash(b)) << "however the points came to it";
    std::vector<std::size_t> points;
    assignment.each_owned(b, [&](std::size_t i) { points.push_back(i); });
    EXPECT_EQ(points.size(), count[b]);
    EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
    for (const std::size_t i : points) EXPECT_EQ(assignment.owners()[i], b);
  }
}

TEST(Assignment, by_power_is_that_of_a_search_however_few_balls_changed) {
  for (const bool aligned : {false, true}) {
    Random random(aligned ? 2 : 1);
    const GroupPoints points = random_points(random, 5000, aligned);
    Assignment assignment(points, most);
    std::vector<GroupBall> balls(most);
    std::vector<float> squares(most, -1);
    for (int round = 0; round < 60; ++round) {
      // Now all balls, now one or two; some vanish and come back.
      const std::size_t changes = round % 7 == 0 ? most : 1 + random.next() % 2;
      for (std::size_t k = 0; k < changes; ++k) {
        const std::size_t b = changes == most ? k : random.next() % most;
        balls[b].center = random_point(random, aligned);
        squares[b] = random.next() % 4 == 0 ? -1 : static_cast<float>(std::floor(30 * random.uniform()));
      }
      if (round % 13 == 12) std::fill(squares.begin(), squares.end(), -1.0F);
      const std::vector<std::uint8_t> before = assignment.owners();
      assignment.set_by_power(balls, squares);
      const bool any = std::any_of(squares.begin(), squares.end(), [](float s) { return s >= 0; });
      for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t expected = any ? owner_by_search(points[i], balls, squares) : before[i];
        ASSERT_EQ(assignment.owners()[i], expected) << "round " << round << ", point " << i;
      }
    }
  }
}

TEST(Assignment, keeps_count_hash_and_demand_in_step_with_owners) {
  Random random(3);
  const GroupPoints points = random_points(random, 300, false);
  Assignment assignment(points, most);
  expect_in_step(assignment);
  for (int round = 0; round < 20; ++round) {
    for (int k = 0; k < 30; ++k) assignment.set_owner(random.next() % points.size(), random.next() % most);
    expect_in_step(assignment);
  }
  assignment.set_all(4);
  expect_in_step(assignment);
  const std::uint64_t all = assignment.hash(4);
  assignment.set_owner(7, 5);
  EXPECT_NE(assignment.hash(4), all);
  assignment.set_owner(7, 4);
  EXPECT_EQ(assignment.hash(4), all);
}

TEST(FitCache, remembers_a_fit_until_inputs_or_a_sibling_near_by_change) {
  const std::vector<GroupBall> start{{{0, 0, 0}, 2, 1}, {{3, 0, 0}, 2, 1}, {{50, 0, 0}, 2, 1}};
  const FitInputs inputs{17, 0.15F};
  std::vector<GroupBall> balls = start;
  FitCache fits(balls.size());
  EXPECT_FALSE(fits.has_fit(0, inputs, balls)) << "never fitted";
  for (std::size_t b = 0; b < balls.size(); ++b) fits.note_fit(b, {}, balls[b], inputs);
  // Those fitted later count as changed near by.
  EXPECT_FALSE(fits.has_fit(0, inputs, balls));
  fits.note_fit(0, balls[0], balls[0], inputs);
  EXPECT_TRUE(fits.has_fit(0, inputs, balls));
  EXPECT_FALSE(fits.has_fit(0, {18, 0.15F}, balls)) << "other points";
  EXPECT_FALSE(fits.has_fit(0, {17, 0.6F}, balls)) << "another weight";

  const FitCache kept = fits;
  const auto has_fit_after = [&](std::size_t sibling, const GroupBall& moved) {
    FitCache changed = kept;
    std::vector<GroupBall> now = start;
    changed.note_fit(sibling, start[sibling], moved, inputs);
    now[sibling] = moved;
    return changed.has_fit(0, inputs, now);
  };
  EXPECT_TRUE(has_fit_after(2, {{60, 0, 0}, 2, 1})) << "far from and to";
  EXPECT_FALSE(has_fit_after(1, {{70, 0, 0}, 2, 1})) << "from near by";
  EXPECT_FALSE(has_fit_after(2, {{0, 4, 0}, 2, 1})) << "to near by";
  EXPECT_TRUE(has_fit_after(1, start[1])) << "fitted again, to the same ball";
}

}  // namespace
}  // namespace morula
