// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "interrupt.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>

namespace morula::cli {
namespace {

constexpr std::array watched{SIGINT, SIGTERM};
constexpr std::chrono::milliseconds look_every{20};

std::atomic<int> seen{0};
static_assert(std::atomic<int>::is_always_lock_free, "written by a signal handler");

}  // namespace

extern "C" {
static void note_signal(int signal) {
  seen = signal;
  std::signal(signal, SIG_DFL);
}
}

Interrupt::Interrupt() {
  seen = 0;
  for (const int signal : watched)
    if (std::signal(signal, note_signal) == SIG_IGN) std::signal(signal, SIG_IGN);
  watch_ = std::jthread([this](const std::stop_token& end) {
    std::unique_lock lock(mutex_);
    while (!end.stop_requested()) {
      if (seen != 0) {
        source_.request_stop();
        return;
      }
      ended_.wait_for(lock, end, look_every, [] { return false; });
    }
  });
}

Interrupt::~Interrupt() {
  for (const int signal : watched)
    if (std::signal(signal, SIG_DFL) == SIG_IGN) std::signal(signal, SIG_IGN);
}

bool Interrupt::requested() const {
  return seen != 0;
}

int Interrupt::exit_code() const {
  return 128 + seen;
}

}  // namespace morula::cli
