// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The morula command: parses, runs one command, turns failures into one line and an exit code.
#pragma once

namespace morula::cli {

/// argv as main gets it: argv[argc] is null. Throws nothing. has_stdout: standard output was open when the program
/// started. parse_only: stops before the command does anything.
int command_line(int argc, char** argv, bool has_stdout = true, bool parse_only = false);

}  // namespace morula::cli
