// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/interrupt.hpp"

#include <cstdlib>
#include <morula/io/whole_output.hpp>
#include <mutex>
#include <platform/console.hpp>
#include <platform/interrupt.hpp>

#include "shared/console.hpp"

namespace morula::cli {
namespace {

// Never destroyed: the thread outlives main.
struct Current {
  std::mutex mutex;
  Interrupt* interrupt = nullptr;
};
Current& current() {
  static Current& one = *new Current;
  return one;
}

[[noreturn]] void end_now(int signal) {
  abandon_unfinished();
  const std::string written = written_so_far();
  const int code = say_interrupted(128 + signal, written.empty() ? "; nothing unfinished was left behind" : written);
  platform::restore_console();
  std::_Exit(code);
}

}  // namespace

void take_signal(int signal) {
  {
    const std::lock_guard lock(current().mutex);
    Interrupt* const interrupt = current().interrupt;
    if (interrupt != nullptr && !interrupt->requested()) {
      interrupt->signal_ = signal;
      interrupt->source_.request_stop();
      return;
    }
  }
  end_now(signal);
}

void watch_signals() {
  platform::watch_end_requests(take_signal);
}

Interrupt::Interrupt() {
  const std::lock_guard lock(current().mutex);
  current().interrupt = this;
}

Interrupt::~Interrupt() {
  const std::lock_guard lock(current().mutex);
  current().interrupt = nullptr;
}

}  // namespace morula::cli
