// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pair refinement: divides the budget of one update among the pairs with work to do.
#pragma once

#include <chrono>
#include <cstdint>
#include <morula/parallel/workers.hpp>
#include <morula/scene/scene.hpp>
#include <vector>

#include "scene/pair_front.hpp"

namespace morula::detail {

/// The pairs with work to do, and the costs of the last update. look_at_roots() adds them, then refine() runs it.
class PairRefinement {
 public:
  /// No pair has work to do.
  void start() noexcept { work_.clear(); }
  /// Adds a pair with work to do. Its PairFront::priority is that of this update; pairs come in the order of their
  /// places.
  void add(PairFront& front) { work_.push_back(&front); }
  /// Spends options.budget. deadline: the end of a budget of time; surfaces get half of the rest. Returns the tests
  /// done.
  std::size_t run(const SceneOptions& options, std::chrono::nanoseconds deadline, Workers& workers);
  /// Makes room for so many pairs.
  void reserve(std::size_t pairs);
  /// Resets all data of earlier updates and fronts.
  void forget() noexcept;

 private:
  void run_all(const SceneOptions& options, Workers& workers);
  void run_by_tests(const SceneOptions& options, std::size_t tests, Workers& workers);
  void run_by_time(const SceneOptions& options, std::chrono::nanoseconds deadline, Workers& workers);
  void choose_by_importance(std::size_t count);
  void note_first_round(std::int64_t spent, std::int64_t pairs);

  std::vector<PairFront*> work_;    // pairs with work to do
  std::size_t tests_done_ = 0;      // tests done by this update
  double first_round_of_pair_ = 0;  // time per pair of the first round in the last update, on one thread, ns

  // Memory of one round: one entry per pair in work_, except in order_ and chosen_.
  std::vector<std::size_t> used_, shares_;
  std::vector<double> values_;
  std::vector<std::uint32_t> order_;
  std::vector<PairFront*> chosen_;
};

}  // namespace morula::detail
