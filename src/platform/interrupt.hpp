// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Requests to end this program: Ctrl-C and its like.
#pragma once

#include <string>

namespace morula::platform {

/// Numbers of POSIX signals, on every system.
inline constexpr int hang_up_signal = 1, interrupt_signal = 2, end_signal = 15;

/// Calls `take` with the number of each request to end, on another thread. Requests that were ignored at the start
/// (nohup, background jobs) stay ignored. A closed pipe and a file that grows too large become errors of the write. To
/// be called once, at the beginning. POSIX: SIGINT, SIGTERM and SIGHUP. Windows: Ctrl-C is an interrupt, Ctrl-Break the
/// end; a console window that closes, a log-off and a shutdown hang up, for which `take` is called until it ends the
/// program.
void watch_end_requests(void (*take)(int signal));

/// The text of a signal: "Segmentation fault".
std::string signal_text(int signal);

}  // namespace morula::platform
