// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Command: options added to the parser, and a function to run once they are parsed.
#pragma once

#include <CLI/Option.hpp>
#include <functional>
#include <stdexcept>
#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace morula::cli {

/// Exit codes, the same for every command.
inline constexpr int exit_done = 0;
inline constexpr int exit_check_failed = 1;    ///< a check failed, the result is incomplete, or cannot be reported
inline constexpr int exit_bad_use = 2;         ///< bad options or bad input; nothing was written
inline constexpr int exit_internal_error = 3;  ///< or not enough memory
inline constexpr int exit_nobody_reads = 141;  ///< 128 + SIGPIPE: the reader of standard output has closed it
// 130, 143, 129: ended by Ctrl-C, SIGTERM or SIGHUP, with nothing unfinished left (interrupt.hpp); a study keeps its
// finished cells.

/// Bad use of the command line: what() is one line with the remedy.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Set by the command that was named; returns an exit code.
using Run = std::function<int()>;

// Functions that CLI11 would compile by templates and inline functions in every source are compiled once, in
// command.cpp.

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description);
/// For the types that command.cpp lists.
template <class T>
CLI::Option* add_option(CLI::App& to, const std::string& names, T& value, const std::string& description);
CLI::Option* add_flag(CLI::App& to, const std::string& names, bool& value, const std::string& description);
/// The last lines of the help.
void set_footer(CLI::App& command, const std::string& text);
/// The parser's message, completed by the nearest option and the command for help.
std::string parse_message(const CLI::App& app, const CLI::ParseError& error);
/// Called once the command's arguments are parsed.
void on_use(CLI::App& command, std::function<void()> action);

void add_build(CLI::App& app, Run& run);
void add_measure(CLI::App& app, Run& run);
void add_deform(CLI::App& app, Run& run);
void add_update(CLI::App& app, Run& run);
void add_collide(CLI::App& app, Run& run);
void add_pairs(CLI::App& app, Run& run);
void add_medial(CLI::App& app, Run& run);
void add_bounds(CLI::App& app, Run& run);
void add_info(CLI::App& app, Run& run);
void add_repair(CLI::App& app, Run& run);
void add_paraview(CLI::App& app, Run& run);
void add_formats(CLI::App& app, Run& run);
void add_sample(CLI::App& app, Run& run);
void add_convert(CLI::App& app, Run& run);
void add_completion(CLI::App& app, Run& run);
void add_batch(CLI::App& app, Run& run);

}  // namespace morula::cli
