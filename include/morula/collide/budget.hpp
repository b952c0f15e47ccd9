// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Budget: the limit of a query's work, as a number of pair tests or as a time.
#pragma once

#include <chrono>
#include <concepts>
#include <cstdint>
#include <functional>

namespace morula {

/// The limit of a query's work. Queries reject a negative one.
class Budget {
 public:
  /// No limit.
  Budget() = default;
  /// A number of pair tests. With it, a query has the same bits for any number of workers and on any machine.
  template <std::integral Count>
  Budget(Count pair_tests) : unit_(Unit::tests), amount_(static_cast<std::int64_t>(pair_tests)) {}
  /// A time from the start of the call, in whole units such as std::chrono::microseconds; the query's option `clock`
  /// measures it.
  template <std::integral Rep, class Period>
  Budget(std::chrono::duration<Rep, Period> time)
      : unit_(Unit::time), amount_(std::chrono::duration_cast<std::chrono::nanoseconds>(time).count()) {}

  bool is_unlimited() const { return unit_ == Unit::none; }
  bool is_time() const { return unit_ == Unit::time; }
  bool is_tests() const { return unit_ == Unit::tests; }
  /// The number of pair tests, if is_tests().
  std::int64_t tests() const { return amount_; }
  /// The time, if is_time().
  std::chrono::nanoseconds time() const { return std::chrono::nanoseconds(amount_); }

 private:
  enum class Unit : std::uint8_t { none, tests, time };
  Unit unit_ = Unit::none;
  std::int64_t amount_ = 0;
};

/// A clock that never goes back, such as std::chrono::steady_clock. A query calls it on its own thread alone.
using Clock = std::function<std::chrono::nanoseconds()>;

}  // namespace morula
