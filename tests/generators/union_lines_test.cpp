// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Empty space in unions of spheres, by lines, against exact volumes of single spheres.
#include <gtest/gtest.h>

#include <generators/fit/union_lines.hpp>
#include <memory>
#include <morula/parallel/interrupt.hpp>
#include <morula/query/signed_distance.hpp>
#include <stdexcept>

#include "on_capsule.hpp"

namespace morula {
using namespace detail;
namespace {

using test::OnCapsule;

TEST(UnionLines, of_one_sphere_are_its_outside_volume) {
  const OnCapsule on;
  // On the axis, one that is little but the layer between it and the facets; beside it; across the end; far out.
  for (const Sphere& s :
       {Sphere{{0.1, 0, 0}, 0.51}, Sphere{{0.3, 0.4, 0.1}, 0.3}, Sphere{{1.4, 0.1, 0}, 0.4}, Sphere{{0, 3, 0}, 0.7}}) {
    UnionLines lines(on.lines, {&s, 1}, on.lines.cell());
    EXPECT_EQ(lines.outside(), 0);
    lines.count(0, true);
    const double exact = outside_volume(on.shape.distance(), s);
    EXPECT_NEAR(lines.outside(), exact, 0.02 * exact) << "at " << s.center.x << ", " << s.center.y;
  }
}

TEST(UnionLines, count_what_spheres_share_once) {
  const OnCapsule on;
  const std::vector<Sphere> spheres{
      {{0, 0.6, 0}, 0.3}, {{0, 0.6, 0}, 0.3}, {{0, 0.6, 0.02}, 0.25}, {{0, 2, 0}, 0.2}, {{0.1, 0.55, 0}, 0.3}};
  UnionLines lines(on.lines, spheres, 0.03);
  lines.count(0, true);
  const double one = lines.outside();
  lines.count(1, true), lines.count(2, true);
  EXPECT_EQ(lines.outside(), one);
  lines.count(3, true);
  const double apart = outside_volume(on.shape.distance(), spheres[3]);
  EXPECT_NEAR(lines.outside(), one + apart, 0.03 * apart);
  lines.count(4, true);
  EXPECT_GT(lines.outside(), one + apart * 1.1);
  EXPECT_LT(lines.outside(), 2 * one + apart);
}

TEST(UnionLines, changes_are_differences_of_unions) {
  const OnCapsule on;
  const std::vector<Sphere> spheres{
      {{0, 0.4, 0}, 0.3}, {{0.2, 0.4, 0}, 0.3}, {{0.1, 0.3, 0.2}, 0.35}, {{1, 0, 0}, 0.6}};
  UnionLines lines(on.lines, spheres, 0.04);
  lines.count(0, true), lines.count(3, true);
  const double before = lines.outside();
  const std::vector<std::uint32_t> added{1, 2}, removed{0};
  const double change = lines.change(added, removed);
  const std::vector<std::uint8_t> others{0, 1, 1, 1};
  const double difference = lines.difference(others);
  EXPECT_EQ(lines.outside(), before);
  lines.count(0, false), lines.count(1, true), lines.count(2, true);
  EXPECT_NEAR(lines.outside() - before, change, 1e-9);
  // What only one has is at least how far their volumes are apart.
  EXPECT_GE(difference, std::abs(change));
  EXPECT_NEAR(lines.difference(others), 0, 1e-12);
}

// Deep trees have millions of lines. Every part checks for interruption, and at least once for each hundred lines.
TEST(UnionLines, check_for_interruption_in_every_part) {
  const OnCapsule on;
  std::vector<Sphere> spheres;
  for (int i = 0; i < 40; ++i) spheres.push_back({{0.05 * i - 1, 0.3, 0.1 * (i % 5)}, 0.4});
  struct Stop : std::runtime_error {
    Stop() : std::runtime_error("stop") {}
  };
  std::size_t looks = 0;
  bool stops = false;
  const Interrupt interrupt([&] {
    ++looks;
    if (stops) throw Stop();
  });
  const auto looks_of = [&](const auto& part) {
    const std::size_t before = looks;
    part();
    return looks - before;
  };
  std::unique_ptr<UnionLines> lines;
  const auto construct = [&] { lines = std::make_unique<UnionLines>(on.lines, spheres, on.lines.cell()); };
  const std::size_t in_construction = looks_of(construct);
  std::size_t line_count = 0;  // at least so many have chords
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    line_count = std::max(line_count, lines->line_count(s));
    lines->count(s, s % 2 == 0);
  }
  ASSERT_GT(line_count, 1000u);
  EXPECT_GE(in_construction, line_count / 100);
  std::vector<std::uint32_t> added, removed;
  for (std::uint32_t s = 0; s < spheres.size(); ++s) (s % 2 == 0 ? removed : added).push_back(s);
  const std::vector<std::uint8_t> others(spheres.size(), 1);
  const auto outside = [&] { static_cast<void>(lines->outside()); };
  const auto change = [&] { static_cast<void>(lines->change(added, removed)); };
  const auto difference = [&] { static_cast<void>(lines->difference(others)); };
  EXPECT_GE(looks_of(outside), line_count / 100);
  EXPECT_GE(looks_of(change), line_count / 100);
  EXPECT_GE(looks_of(difference), line_count / 100);
  stops = true;
  EXPECT_THROW(construct(), Stop);
  EXPECT_THROW(outside(), Stop);
}

}  // namespace
}  // namespace morula
