// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The command inside the package: `python -m morula`.
#include <batch/serve.hpp>
#include <batch/worker.hpp>
#include <command_line.hpp>
#include <platform/console.hpp>
#include <shared/interrupt.hpp>

#include "holders.hpp"
#include "module.hpp"

namespace morula::python {

void bind_command(nb::module_& m) {
  m.def(
      "command_line",
      [](std::vector<std::string> arguments, const std::vector<std::string>& program) {
        if (!program.empty()) cli::start_workers_as(program[0], program);
        std::vector<char*> argv;
        for (std::string& argument : arguments) argv.push_back(argument.data());
        argv.push_back(nullptr);
        return without_gil([&] {
          if (cli::is_worker(static_cast<int>(arguments.size()), argv.data())) return cli::serve_batch();
          const bool has_stdout = platform::open_standard_streams();
          cli::watch_signals();
          return cli::command_line(static_cast<int>(arguments.size()), argv.data(), has_stdout);
        });
      },
      nb::arg("arguments"), nb::arg("program") = std::vector<std::string>{},
      "Runs the command; the first argument is its name. program: the command line that starts it again, for the "
      "workers of `batch`. Returns its exit code. It takes over the signals of the process, so it is for `python -m "
      "morula` alone.");
}

}  // namespace morula::python
