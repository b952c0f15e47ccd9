// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A progress bar on stderr, shown only to a person: nothing is printed when stderr is not a terminal.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <toolbox/stopwatch.hpp>

namespace morula::cli {

class Progress {
 public:
  explicit Progress(std::string label);
  /// Removes the bar.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// share: of the work done, 0…1. After a second the bar says how long the rest takes at the rate so far, unless the
  /// label says it already.
  void update(double share);
  void update(double share, std::string label);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool shown_;  // stderr is a terminal
  Clock::time_point begun_ = Clock::now(), last_{};
};

/// ", about 3 min left"; nothing while it is not known, and for less than a second.
std::string time_left(std::optional<double> seconds);

}  // namespace morula::cli
