// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/interrupt.hpp"

#include <fcntl.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): POSIX has more in it
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <thread>

namespace morula::platform {
namespace {

constexpr std::array watched{SIGINT, SIGTERM, SIGHUP};

// A signal handler may do next to nothing: it writes the signal's number here, and a thread reads it.
int pipe_in = -1;
int pipe_out = -1;

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

void watch_end_requests(void (*take)(int signal)) {
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
    std::thread([take] {
      for (;;) {
        unsigned char number = 0;
        const ssize_t count = read(pipe_out, &number, 1);
        if (count == 1) take(number);
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

std::string signal_text(int signal) {
  return strsignal(signal);
}

}  // namespace morula::platform
