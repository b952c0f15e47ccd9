// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenes in any order of calls: a random walk through a model, judged by brute force over facets.
#include "scene_walk.hpp"

#include <gtest/gtest.h>

namespace morula {
namespace {

using test::Call;
using test::SceneWalk;

/// Walks of so many calls each, until so many were made. A fault is told with its seed and the fewest calls that show
/// it.
void walk(std::uint64_t first_seed, std::size_t calls, std::size_t calls_of_walk) {
  SceneWalk model;
  for (std::size_t made = 0; made < calls; made += calls_of_walk, ++first_seed) {
    std::vector<Call> list = SceneWalk::random_calls(first_seed, calls_of_walk);
    const std::string fault = model.run(list);
    if (fault.empty()) continue;
    list.resize(model.made());
    list = model.shrunk(std::move(list), 2000);
    std::string told;
    for (const Call& call : list) told += "  " + call.words() + ",\n";
    FAIL() << "seed " << first_seed << ": " << fault << "\nthe same with " << list.size()
           << " calls: " << model.run(list) << "\nSceneWalk().run(std::vector<Call>{\n"
           << told << "});";
  }
  // It has been where faults are.
  EXPECT_GT(model.updates, calls / 10);
  EXPECT_GT(model.rejected, calls / 100);
  EXPECT_GT(model.thrown, calls / 200);
  EXPECT_GT(model.interrupted, calls / 50);
  EXPECT_GT(model.crossed, calls);
  EXPECT_GT(model.began, calls / 20);
  EXPECT_GT(model.ended, calls / 20);
  EXPECT_GT(model.unconfirmed, calls / 20);
  EXPECT_GT(model.kept, calls / 50);
}

TEST(SceneWalk, any_order_of_calls_leaves_no_crossing_out) {
  walk(1, 2400, 300);
}

TEST(LongSceneWalk, any_order_of_a_hundred_thousand_calls_leaves_no_crossing_out) {
  walk(1000, 120'000, 400);
}

}  // namespace
}  // namespace morula
