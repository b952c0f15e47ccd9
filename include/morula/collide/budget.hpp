// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Budget: the limit of a query's work, in tests or in time.
#pragma once

#include <chrono>
#include <concepts>
#include <cstdint>
#include <functional>

namespace morula {

/// The limit of a query's work.
class Budget {
 public:
  /// No limit.
  Budget() = default;
  /// A number of pair tests. The result has the same bits for any number of workers.
  template <std::integral Count>
  Budget(Count pair_tests) : unit_(Unit::tests), amount_(static_cast<std::int64_t>(pair_tests)) {}
  /// A time from the start of the call, by CollideOptions::clock.
  template <std::integral Rep, class Period>
  Budget(std::chrono::duration<Rep, Period> time)
      : unit_(Unit::time), amount_(std::chrono::duration_cast<std::chrono::nanoseconds>(time).count()) {}

  bool is_unlimited() const { return unit_ == Unit::none; }
  bool is_time() const { return unit_ == Unit::time; }
  bool is_tests() const { return unit_ == Unit::tests; }
  std::int64_t tests() const { return amount_; }
  std::chrono::nanoseconds time() const { return std::chrono::nanoseconds(amount_); }

 private:
  enum class Unit : std::uint8_t { none, tests, time };
  Unit unit_ = Unit::none;
  std::int64_t amount_ = 0;
};

/// A monotone clock; called on the thread of the query alone.
using Clock = std::function<std::chrono::nanoseconds()>;

}  // namespace morula
