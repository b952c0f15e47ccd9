// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The meter of a budget: its rest.
#pragma once

#include <limits>
#include <morula/collide/contacts.hpp>

namespace morula::detail {

inline std::chrono::nanoseconds now(const Clock& clock) {
  return clock ? clock() : std::chrono::steady_clock::now().time_since_epoch();
}

/// The rest of a budget. Once it has run out, it stays at zero.
class Meter {
 public:
  explicit Meter(const CollideOptions& options) : options_(&options) {
    if (options.budget.is_tests()) left_ = options.budget.tests();
    if (!options.budget.is_time()) return;
    start_ = now(options.clock);
    // Surfaces get the other half.
    limit_ = options.surfaces ? options.budget.time() / 2 : options.budget.time();
  }
  /// Releases the rest that was reserved for surfaces.
  void release_rest() {
    limit_ = options_->budget.time();
    late_ = step_is_due_ = false;
  }
  bool by_time() const { return options_->budget.is_time(); }
  /// Whether a budget of time is above zero.
  bool has_any_time() const { return options_->budget.time().count() > 0; }
  /// Allows the first step at any cost, except with a budget of zero, so that repeated resume() calls always finish. A
  /// step is one pair of roots, or all pairs below one pair; done_step() ends it.
  void allow_step() { step_is_due_ = by_time() ? has_any_time() : left_ > 0; }
  void done_step() { step_is_due_ = false; }
  bool out_of_time() {
    // mutant resume-out-of-time: `if (step_is_due_) return false;` -> ``
    if (step_is_due_) return false;
    if (by_time() && !late_) late_ = now(options_->clock) - start_ >= limit_;
    return late_;
  }
  /// Whether so many tests may be done. Once false, it stays false. Zero tests are always allowed.
  bool try_spend(std::uint32_t tests) {
    if (tests == 0) return true;
    // mutant resume-stands-still: `step_is_due_ && left_ == options_->budget.tests()` -> `false`
    const bool is_first = step_is_due_ && left_ == options_->budget.tests();
    blocked_ = blocked_ || (tests > left_ && !is_first);
    if (!blocked_) left_ -= tests;
    return !blocked_;
  }
  void give_back(std::uint32_t tests) { left_ += tests; }
  std::size_t done = 0;

 private:
  const CollideOptions* options_;
  std::int64_t left_ = std::numeric_limits<std::int64_t>::max();
  std::chrono::nanoseconds start_{}, limit_{};
  bool blocked_ = false, late_ = false, step_is_due_ = false;
};

}  // namespace morula::detail
