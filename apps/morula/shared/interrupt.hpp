// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ctrl-C and its like: the command leaves as if it had never begun.
#pragma once

#include <atomic>
#include <stop_token>

namespace morula::cli {

/// Makes SIGINT, SIGTERM and SIGHUP, and on Windows Ctrl-C, Ctrl-Break and the end of the console, remove incomplete
/// outputs before they end the program, with exit code 128 + signal. Signals that were ignored at the start (nohup,
/// background jobs) stay ignored. A closed pipe and a file that grows too large become errors of the write instead of
/// signals. To be called once, at the beginning.
void watch_signals();
/// What a signal does.
void take_signal(int signal);

/// While it lives, the first signal requests a stop instead of ending the program; the second one ends it. One at a
/// time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return source_.get_token(); }
  bool requested() const { return signal_ != 0; }
  /// 128 + the signal, as shells have it.
  int exit_code() const { return 128 + signal_; }

 private:
  friend void take_signal(int signal);
  std::stop_source source_;
  std::atomic<int> signal_{0};
};

}  // namespace morula::cli
