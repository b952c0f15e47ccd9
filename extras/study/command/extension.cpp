// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The subcommands of the study: `demo` and `study`.
#include "shared/extension.hpp"

namespace morula::cli {

void add_demo(CLI::App& app, Run& run);
void add_study(CLI::App& app, Run& run);

Extension study_extension() {
  Extension extension;
  extension.commands = {add_demo, add_study};
  return extension;
}

}  // namespace morula::cli
