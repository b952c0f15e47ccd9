// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/interrupt.hpp"

#include <fcntl.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): POSIX has more in it
#include <unistd.h>

#include <array>
#include <cerrno>
#include <morula/io/whole_output.hpp>
#include <mutex>
#include <system_error>
#include <thread>

#include "shared/console.hpp"

namespace morula::cli {
namespace {

constexpr std::array watched{SIGINT, SIGTERM, SIGHUP};

// A signal handler may do next to nothing: it writes the signal's number here, and a thread reads it.
int pipe_in = -1;
int pipe_out = -1;

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
  _exit(say_interrupted(128 + signal, written.empty() ? "; nothing unfinished was left behind" : written));
}

}  // namespace

extern "C" {
static void pass_on(int signal) {
  const int error = errno;
  const auto number = static_cast<unsigned char>(signal);
  const ssize_t written = write(pipe_in, &number, 1);
  static_cast<void>(written);
  errno = error;
}
}

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
  signal(SIGPIPE, SIG_IGN);
#ifdef SIGXFSZ
  signal(SIGXFSZ, SIG_IGN);
#endif
  int ends[2];
  if (pipe(ends) != 0) return;
  for (const int end : ends) fcntl(end, F_SETFD, FD_CLOEXEC);
  pipe_out = ends[0];
  pipe_in = ends[1];
  try {
    std::thread([] {
      for (;;) {
        unsigned char number = 0;
        const ssize_t count = read(pipe_out, &number, 1);
        if (count == 1) take_signal(number);
        if (count == 0 || (count < 0 && errno != EINTR)) return;
      }
    }).detach();
  } catch (const std::system_error&) {
    return;  // no thread to be had: signals end the program as they always do
  }
  for (const int number : watched) {
    struct sigaction before {};
    if (sigaction(number, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = pass_on;
    action.sa_flags = SA_RESTART;
    sigaction(number, &action, nullptr);
  }
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
