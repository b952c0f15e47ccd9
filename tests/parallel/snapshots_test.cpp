// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Snapshots in one thread against a model, and between two threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <morula/parallel/snapshots.hpp>
#include <random>
#include <set>
#include <thread>
#include <utility>

namespace morula {
namespace {

TEST(Snapshots, give_the_newest_state_in_any_order_of_calls) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    Snapshots<int> snapshots(-1);
    int published = -1, seen = -1;
    for (int call = 0; call < 60; ++call) {
      if (random() % 2 == 0) {
        EXPECT_NE(&snapshots.back(), &snapshots.front());
        snapshots.back() = call;
        EXPECT_EQ(snapshots.front(), seen);
        snapshots.publish();
        published = call;
      } else {
        EXPECT_EQ(snapshots.refresh(), published != seen);
        seen = published;
      }
      EXPECT_EQ(std::as_const(snapshots).front(), seen);
    }
  }
}

TEST(Snapshots, make_three_slots_in_place_that_never_move) {
  struct Unmovable {
    Unmovable(int a, const double& b) : sum(a + b), self(this) {}
    Unmovable(const Unmovable&) = delete;
    Unmovable& operator=(const Unmovable&) = delete;
    double sum;
    Unmovable* self;
  };
  Snapshots<Unmovable> snapshots(2, 0.5);
  std::set<const Unmovable*> slots;
  for (int k = 0; k < 10; ++k) {
    for (const Unmovable* slot : {&snapshots.back(), &snapshots.front()}) {
      EXPECT_EQ(slot->sum, 2.5);
      EXPECT_EQ(slot->self, slot);
      slots.insert(slot);
    }
    snapshots.publish();
    if (k % 3 == 0) {
      EXPECT_TRUE(snapshots.refresh());
    }
  }
  EXPECT_EQ(slots.size(), 3u);
}

TEST(Snapshots, pass_whole_states_in_order_from_thread_to_thread) {
  using State = std::array<std::uint64_t, 97>;
  constexpr std::uint64_t last = 20000;
  Snapshots<State> snapshots(State{});
  std::atomic<bool> torn{false}, backwards{false}, ended{false};
  std::thread reader([&] {
    std::uint64_t before = 0;
    for (;;) {
      const bool was_ended = ended.load(std::memory_order_acquire);
      const bool is_new = snapshots.refresh();
      const State& state = snapshots.front();
      if (std::any_of(state.begin(), state.end(), [&](std::uint64_t value) { return value != state[0]; })) torn = true;
      if (is_new ? state[0] <= before : state[0] != before) backwards = true;
      before = state[0];
      if (was_ended) break;
      std::this_thread::yield();
    }
    if (before != last) backwards = true;
  });
  for (std::uint64_t k = 1; k <= last; ++k) {
    snapshots.back().fill(k);
    snapshots.publish();
  }
  ended.store(true, std::memory_order_release);
  reader.join();
  EXPECT_FALSE(torn);
  EXPECT_FALSE(backwards);
}

}  // namespace
}  // namespace morula
