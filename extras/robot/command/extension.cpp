// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The addition of robots to the command: `robot`.
#include "shared/extension.hpp"

#include <morula/robot/output.hpp>

#include "notices.hpp"

namespace morula::cli {

void add_robot(CLI::App& app, Run& run);

Extension robot_extension() {
  Extension extension;
  extension.commands = {add_robot};
  extension.format_command = "robot";
  for (const robot::OutputFormat& format : robot::output_formats()) extension.format_names.emplace_back(format.name);
  extension.notices = robot_notices();
  return extension;
}

}  // namespace morula::cli
