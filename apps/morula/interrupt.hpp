// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ctrl-C during long work: the work is asked to stop, and the command leaves as if it had never begun.
#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

namespace morula::cli {

/// While it lives, the first SIGINT or SIGTERM requests a stop instead of ending the program; the second one ends it. A
/// signal that was ignored at the start (nohup, background jobs) stays ignored. One at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return source_.get_token(); }
  bool requested() const;
  /// 128 + the signal, as shells have it.
  int exit_code() const;

 private:
  std::stop_source source_;
  std::mutex mutex_;
  std::condition_variable_any ended_;
  std::jthread watch_;  // a signal handler may do no more than set a flag: this thread looks at it
};

}  // namespace morula::cli
