// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <platform/console.hpp>

#include "batch/serve.hpp"
#include "command_line.hpp"
#include "shared/interrupt.hpp"

int main(int argc, char** argv) {
  if (morula::cli::is_worker(argc, argv)) return morula::cli::serve_batch();
  const bool has_stdout = morula::platform::open_standard_streams();
  morula::cli::watch_signals();
  return morula::cli::command_line(argc, argv, has_stdout);
}
