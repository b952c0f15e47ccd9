// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A second core for one job, also on a machine that is busy: frames wait for the processor time that the job would have
// had by then.
#pragma once

#include <atomic>
#include <functional>
#include <thread>

namespace morula::bench {

class PacedThread {
 public:
  /// Joins the job before; its thread starts at once.
  void run(std::function<void()> job);
  /// Returns when the job has had `seconds` of processor time, or is over. Elsewhere than on Linux: of wall time.
  void wait_for(double seconds) const;

 private:
  double processor_seconds() const;

  std::atomic<bool> over_{true};
  double started_ = 0;
  mutable std::jthread thread_;
};

}  // namespace morula::bench
