// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <morula/parallel/workers.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace morula {
namespace {

std::vector<unsigned> thread_counts() {
  return {1, 2, 3, 8};
}

TEST(Workers, call_every_chunk_once) {
  for (const unsigned threads : thread_counts()) {
    Workers workers(threads);
    for (const std::size_t count : {0u, 1u, 2u, 7u, 1000u}) {
      std::vector<std::atomic<int>> calls(count);
      workers.run(count, [&](std::size_t i) { calls[i].fetch_add(1); });
      for (const auto& c : calls) EXPECT_EQ(c.load(), 1);
    }
  }
}

TEST(Workers, split_ranges_by_count_and_grain_alone) {
  for (const unsigned threads : thread_counts()) {
    Workers workers(threads);
    std::vector<std::pair<std::size_t, std::size_t>> chunks(4);
    parallel_for(workers, 10, 3, [&](std::size_t begin, std::size_t end) { chunks[begin / 3] = {begin, end}; });
    EXPECT_EQ(chunks, (std::vector<std::pair<std::size_t, std::size_t>>{{0, 3}, {3, 6}, {6, 9}, {9, 10}}));
  }
}

TEST(Workers, throw_the_exception_of_the_lowest_chunk_and_stay_usable) {
  for (const unsigned threads : thread_counts()) {
    Workers workers(threads);
    for (int repeat = 0; repeat < 20; ++repeat) {
      std::string caught;
      try {
        workers.run(100, [](std::size_t i) {
          if (i % 10 == 3) throw std::runtime_error(std::to_string(i));
        });
      } catch (const std::runtime_error& e) {
        caught = e.what();
      }
      EXPECT_EQ(caught, "3");
    }
    std::atomic<int> sum{0};
    workers.run(10, [&](std::size_t i) { sum += static_cast<int>(i); });
    EXPECT_EQ(sum.load(), 45);
  }
}

TEST(WorkersOrAll, are_those_given_or_one_per_processor) {
  Workers three(3);
  WorkersOrAll given(three), none;
  EXPECT_EQ(&static_cast<Workers&>(given), &three);
  Workers& all = none;
  EXPECT_EQ(all.thread_count(), Workers(0).thread_count());
  EXPECT_EQ(&static_cast<Workers&>(none), &all) << "one pool for a call";
}

TEST(WorkersOrAll, start_no_threads_inside_a_chunk) {
  Workers two(2);
  std::array<unsigned, 4> counts{};
  two.run(counts.size(), [&](std::size_t i) {
    WorkersOrAll none;
    counts[i] = static_cast<Workers&>(none).thread_count();
  });
  EXPECT_EQ(counts, (std::array<unsigned, 4>{1, 1, 1, 1}));
}

// A function of the host's that asks to end a loop of a million chunks is not asked a million times more.
TEST(Workers, begin_no_other_chunk_after_an_exception) {
  for (const bool on_host : {false, true}) {
    Workers workers = on_host ? Workers(
                                    [](std::size_t count, ChunkFunction chunk) {
                                      for (std::size_t i = 0; i < count; ++i) chunk(i);
                                    },
                                    2)
                              : Workers();
    int called = 0;
    EXPECT_THROW(workers.run(1000,
                             [&](std::size_t i) {
                               ++called;
                               if (i == 3) throw std::runtime_error("3");
                             }),
                 std::runtime_error);
    EXPECT_EQ(called, 4);
  }
}

// Threads that come too late for a loop, that wait awake, that sleep, and more of them than processors.
TEST(Workers, are_done_with_every_chunk_of_short_loops_in_a_row) {
  for (const unsigned threads : {2u, 3u, 9u}) {
    Workers workers(threads);
    std::vector<std::size_t> written(64);
    for (std::size_t loop = 1; loop <= 5000; ++loop) {
      const std::size_t count = 2 + loop * 7 % 60;
      parallel_for(workers, count, 1 + loop % 3, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) written[i] = written[i] < loop ? loop : 0;
      });
      // Not atomic: each is written once, before the loop returns.
      for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(written[i], loop) << threads << " threads, chunk " << i;
      if (loop % 1000 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
}

TEST(Workers, run_nested_loops_where_they_are) {
  Workers workers(3);
  std::atomic<int> sum{0};
  workers.run(10, [&](std::size_t) { workers.run(10, [&](std::size_t j) { sum += static_cast<int>(j); }); });
  EXPECT_EQ(sum.load(), 450);
}

TEST(Workers, use_the_hosts_executor) {
  int rounds = 0;
  Workers workers(
      [&](std::size_t count, ChunkFunction chunk) {
        ++rounds;
        for (std::size_t i = count; i-- > 0;) chunk(i);
      },
      4);
  std::vector<std::size_t> order;
  workers.run(3, [&](std::size_t i) { order.push_back(i); });
  EXPECT_EQ(rounds, 1);
  EXPECT_EQ(order, (std::vector<std::size_t>{2, 1, 0}));
  EXPECT_THROW(Workers(Workers::Executor{}, 2), std::invalid_argument);
}

TEST(Workers, neither_exceptions_nor_nested_loops_reach_the_host) {
  int escaped = 0, runs = 0;
  Workers workers(
      [&](std::size_t count, ChunkFunction chunk) {
        ++runs;
        for (std::size_t i = count; i-- > 0;) {
          try {
            chunk(i);
          } catch (...) {
            ++escaped;
          }
        }
      },
      2);
  int inner = 0;
  EXPECT_THROW(workers.run(10,
                           [&](std::size_t i) {
                             workers.run(3, [&](std::size_t) { ++inner; });
                             if (i == 7) throw std::out_of_range("7");
                             if (i == 2) throw std::runtime_error("2");
                           }),
               std::runtime_error);
  EXPECT_EQ(escaped, 0);
  EXPECT_EQ(runs, 1);
  EXPECT_EQ(inner, 30);
}

}  // namespace
}  // namespace morula
