// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/interrupt.hpp"

#include "platform/windows/errors.hpp"

namespace morula::platform {
namespace {

void (*take_request)(int signal) = nullptr;

// Windows calls it on a thread of its own.
BOOL WINAPI pass_on(DWORD event) {
  switch (event) {
    case CTRL_C_EVENT:
      take_request(interrupt_signal);
      return TRUE;
    case CTRL_BREAK_EVENT:
      take_request(end_signal);
      return TRUE;
    case CTRL_CLOSE_EVENT:
    case CTRL_LOGOFF_EVENT:
    case CTRL_SHUTDOWN_EVENT:
      // The system ends the program once this returns: the first call may only request a stop, the second one ends it.
      take_request(hang_up_signal);
      take_request(hang_up_signal);
      return TRUE;
    default:
      return FALSE;
  }
}

}  // namespace

void watch_end_requests(void (*take)(int signal)) {
  take_request = take;
  SetConsoleCtrlHandler(pass_on, TRUE);
}

std::string signal_text(int signal) {
  switch (signal) {
    case 4:
      return "Illegal instruction";
    case 6:
      return "Aborted";
    case 8:
      return "Arithmetic exception";
    case 9:
      return "Killed";
    case 11:
      return "Segmentation fault";
    default:
      return "signal " + std::to_string(signal);
  }
}

}  // namespace morula::platform
