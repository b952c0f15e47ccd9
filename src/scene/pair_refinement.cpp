// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/pair_refinement.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>

#include "collide/pairs/meter.hpp"

namespace morula::detail {
namespace {

// The least number of tests that a pair gets at a time, so that a few rounds assign a large budget.
constexpr std::size_t quantum = 512;
// The most tests that a pair gets at once by its earlier cost.
constexpr std::size_t most_expected = 2048;
// The least budget of a round, one block of eight by eight nodes; with fewer tests a round is not worthwhile.
constexpr std::size_t least_budget = 64;

}  // namespace

std::size_t PairRefinement::run(const SceneOptions& options, std::chrono::nanoseconds deadline, Workers& workers) {
  tests_done_ = 0;
  const Budget& budget = options.budget;
  if (budget.is_unlimited()) {
    run_all(options, workers);
  } else if (budget.is_tests()) {
    run_by_tests(options, static_cast<std::size_t>(budget.tests()), workers);
  } else {
    // Surfaces and patches get half of the rest.
    const std::chrono::nanoseconds begun = now(options.clock);
    run_by_time(options, options.surfaces || options.patches ? begun + (deadline - begun) / 2 : deadline, workers);
  }
  return tests_done_;
}

void PairRefinement::reserve(std::size_t pairs) {
  work_.reserve(pairs), chosen_.reserve(pairs);
  used_.reserve(pairs), shares_.reserve(pairs), values_.reserve(pairs), order_.reserve(pairs);
}

void PairRefinement::forget() noexcept {
  work_.clear(), chosen_.clear();
  first_round_of_pair_ = 0;
}

void PairRefinement::run_all(const SceneOptions& options, Workers& workers) {
  used_.assign(work_.size(), 0);
  parallel_for(workers, work_.size(), 2, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) used_[i] = work_[i]->refine(options, std::nullopt);
  });
  for (const std::size_t used : used_) tests_done_ += used;
}

// Works in rounds. Each round assigns the rest of the budget to the pairs with the greatest importance per work already
// done, the lowest first among equals: each pair gets the tests that it took last time and somewhat more, or a quantum.
// Unused tests are available in the next round. The result depends only on counts, so the same pairs get the same tests
// for any number of workers.
void PairRefinement::run_by_tests(const SceneOptions& options, std::size_t tests, Workers& workers) {
  std::size_t left = tests;
  while (left >= std::min(least_budget, tests) && left > 0 && !work_.empty()) {
    values_.clear();
    order_.clear();
    for (std::uint32_t i = 0; i < work_.size(); ++i) {
      const auto done = static_cast<double>(work_[i]->priority.tests);
      values_.push_back(work_[i]->priority.importance * static_cast<double>(quantum) /
                        (static_cast<double>(quantum) + done));
      order_.push_back(i);
    }
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t x, std::uint32_t y) {
      return values_[x] != values_[y] ? values_[x] > values_[y] : x < y;
    });
    shares_.assign(work_.size(), 0);
    std::size_t assigned = 0, count = 0;
    for (; count < order_.size() && assigned < left; ++count) {
      const PairFront& front = *work_[order_[count]];
      const std::size_t wanted = std::clamp(front.tests_expected().value_or(quantum), least_budget, most_expected);
      // The last pair gets the rest; if that is too little to open any pair of nodes, no pair gets it.
      const std::size_t share = std::min(wanted, left - assigned);
      if (count > 0 && share < std::min(wanted, least_budget)) break;
      shares_[order_[count]] = share;
      assigned += share;
    }
    // work_ stays in the order of places.
    used_.assign(work_.size(), 0);
    parallel_for(workers, work_.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (shares_[i] != 0) used_[i] = work_[i]->refine(options, shares_[i]);
    });
    for (std::size_t i = 0; i < work_.size(); ++i) {
      if (shares_[i] == 0) continue;
      PairFront*& front = work_[i];
      front->priority.updates_left_out = 0;
      front->priority.tests += used_[i];
      left -= used_[i];
      tests_done_ += used_[i];
      // The pair got too few tests to open any pair of nodes, and later rounds give no more.
      if (front->is_finished() || used_[i] == 0) front = nullptr;
    }
    std::erase(work_, nullptr);
  }
}

// Chooses as many of the most important pairs as there is time for, then the others by importance in steps of a factor
// of two. Each part is in the order of places, in which bodies and fronts lie in memory: in another order a test takes
// a fifth longer.
void PairRefinement::choose_by_importance(std::size_t count) {
  if (count >= work_.size()) return;
  constexpr int steps = 128;
  std::nth_element(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(count), values_.end(),
                   std::greater<>());
  const double most_of_others = values_[count];
  const auto step_of = [&](const PairFront* front) -> std::size_t {
    if (front->priority.importance > most_of_others) return 0;
    const int exponent = front->priority.importance > 0 ? std::ilogb(front->priority.importance) : -steps;
    return static_cast<std::size_t>(std::clamp(steps / 2 - exponent, 1, steps - 1));
  };
  std::array<std::size_t, steps + 1> begin{};
  for (const PairFront* front : work_) ++begin[step_of(front) + 1];
  for (std::size_t step = 0; step < steps; ++step) begin[step + 1] += begin[step];
  chosen_.resize(work_.size());
  for (PairFront* front : work_) chosen_[begin[step_of(front)]++] = front;
  work_.swap(chosen_);
}

// One long wait for the processor must not keep later updates from beginning any pair: the noted time grows at most by
// a factor of four, and falls by an eighth if no pair was begun because of it.
void PairRefinement::note_first_round(std::int64_t spent, std::int64_t pairs) {
  if (pairs == 0) {
    // mutant scene-long-wait: `0.875` -> `1`
    first_round_of_pair_ *= 0.875;
    return;
  }
  const double of_pair = static_cast<double>(spent) / static_cast<double>(pairs);
  first_round_of_pair_ = first_round_of_pair_ > 0 ? std::min(of_pair, 4 * first_round_of_pair_) : of_pair;
}

// Each pair gets a quantum, then in each further round twice as much.
void PairRefinement::run_by_time(const SceneOptions& options, std::chrono::nanoseconds deadline, Workers& workers) {
  // Only this thread reads a clock of the caller.
  Workers& used_workers = options.clock ? serial_workers() : workers;
  // The number is somewhat below the estimate from the last update, so that the rest does not always consist of the
  // same last pairs.
  values_.clear();
  for (const PairFront* front : work_) values_.push_back(front->priority.importance);
  const double time = 0.9 * static_cast<double>((deadline - now(options.clock)).count()) * used_workers.thread_count();
  choose_by_importance(time < first_round_of_pair_ * static_cast<double>(work_.size())
                           ? static_cast<std::size_t>(std::max(1.0, time / first_round_of_pair_))
                           : work_.size());
  std::atomic<bool> is_late = false;
  // No pair is begun when the deadline is nearer than twice the average time of a pair in this round. For the first
  // pair of a round that is twice the average of the preceding round, and in the first round the average of the last
  // update.
  std::atomic<std::int64_t> spent = 0, pairs = 0;
  auto expected = static_cast<std::int64_t>(first_round_of_pair_);
  for (std::size_t share = quantum; !work_.empty() && !is_late; share *= 2) {
    used_.assign(work_.size(), 0);
    spent = 0, pairs = 0;
    // In the first round, in which most pairs are finished, the clock is read once for several pairs, if they are
    // quick.
    constexpr double at_once_for = 10000;  // ns
    const std::size_t at_once = share == quantum && first_round_of_pair_ > 0
                                    ? static_cast<std::size_t>(std::clamp(at_once_for / first_round_of_pair_, 1.0, 8.0))
                                    : 1;
    parallel_for(used_workers, work_.size(), at_once, [&](std::size_t first, std::size_t last) {
      if (is_late) return;
      const std::int64_t known = pairs, count = static_cast<std::int64_t>(last - first);
      const std::int64_t kept = count * (known > 0 ? 2 * spent / known : expected);
      const std::chrono::nanoseconds begin = now(options.clock);
      // mutant scene-late: `begin + std::chrono::nanoseconds(kept) >= deadline` -> `false`
      if (begin + std::chrono::nanoseconds(kept) >= deadline) {
        is_late = true;
        return;
      }
      for (std::size_t i = first; i < last; ++i) {
        work_[i]->priority.updates_left_out = 0;
        used_[i] = work_[i]->refine(options, share, true);
      }
      spent += (now(options.clock) - begin).count();
      pairs += count;
    });
    if (pairs > 0) expected = 2 * spent / pairs;
    if (share == quantum) note_first_round(spent, pairs);
    for (const std::size_t used : used_) tests_done_ += used;
    // If there was time and no test was done, none can be done.
    for (std::size_t i = 0; i < work_.size(); ++i)
      if (work_[i]->is_finished() || (used_[i] == 0 && !is_late)) work_[i] = nullptr;
    std::erase(work_, nullptr);
  }
}

}  // namespace morula::detail
