// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Runs a command beside the test, which can send it Ctrl-C or another signal that ends it.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "workbench.hpp"

namespace morula::test {

/// Requests to end that this system can send to a program, numbered as in platform/interrupt.hpp, and the exit codes
/// that they lead to. The first one is Ctrl-C. Windows has Ctrl-C and Ctrl-Break, Wine
/// Ctrl-C alone; a closing window cannot be sent.
std::vector<std::pair<int, int>> requests_to_end();

class RunningCommand {
 public:
  /// Starts "morula ARGUMENTS" in the folder. Its output is dropped; its errors go to a file.
  RunningCommand(const Workbench& bench, const std::vector<std::string>& arguments,
                 const std::filesystem::path& errors);
  /// Ends it if it still runs.
  ~RunningCommand();
  RunningCommand(const RunningCommand&) = delete;
  RunningCommand& operator=(const RunningCommand&) = delete;

  /// Whether send() reaches a command here. On Windows it needs a console, which Wine does not always make.
  static bool can_send();
  static constexpr const char* cannot_send = "no key can be pressed: programs have no console here";

  /// Sends one of requests_to_end().
  void send(int signal) const;
  bool is_running() const;
  /// The exit code; -1 when it did not end by itself.
  int wait();
  /// Ends the command at once, so that it cannot clean up.
  void kill();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula::test
