// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The morula command: parses, runs one command, turns failures into one line and an exit code.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <morula/io/mesh_file.hpp>
#include <morula/version.hpp>
#include <new>
#include <string>
#include <vector>

#include "command.hpp"
#include "options.hpp"

namespace morula::cli {
namespace {

int fail(int exit_code, std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  fmt::print(stderr, "morula: error: {}\n", message);
  return exit_code;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

/// The parser's message, with what it leaves out: which option was nearly right, and where the help is.
std::string parse_message(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> commands = app.get_subcommands();
  const CLI::App& scope = commands.empty() ? app : *commands.front();
  const std::string help = commands.empty() ? "morula --help" : fmt::format("morula {} --help", scope.get_name());
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    const std::vector<std::string> extras = scope.remaining(true);
    const std::string extra = extras.empty() ? "?" : extras.front();
    if (extra.rfind('-', 0) != 0) return fmt::format("unexpected argument '{}'; see {}", extra, help);
    std::vector<std::string> known;
    for (const CLI::Option* option : scope.get_options()) {
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    }
    const std::string near = nearest_name(extra.substr(0, extra.find('=')), known);
    return fmt::format("unknown option '{}'{}; see {}", extra,
                       near.empty() ? "" : fmt::format(", did you mean {}?", near), help);
  }
  return fmt::format("{}; see {}", error.what(), help);
}

int run(int argc, char** argv) {
  CLI::App app{"Sphere trees that cover a triangle mesh, certified, while it deforms.", "morula"};
  app.set_version_flag("--version", fmt::format("morula {}", version));
  app.require_subcommand(1);
  app.get_formatter()->column_width(36);
  app.footer(
      "Example:\n"
      "  morula sample limb -o limb.obj\n"
      "  morula build limb.obj -o limb.morula\n"
      "  morula measure limb.obj limb.morula\n\n"
      "Exit codes: 0 done, 1 a check failed or the result is incomplete, 2 bad use or bad input, 3 internal error,\n"
      "130 interrupted.");
  Run run;
  add_build(app, run);
  add_measure(app, run);
  add_deform(app, run);
  add_update(app, run);
  add_collide(app, run);
  add_view(app, run);
  add_medial(app, run);
  add_info(app, run);
  add_sample(app, run);
  add_convert(app, run);
  add_demo(app, run);
  add_study(app, run);

  if (argc < 2) {
    fmt::print("{}", app.help());
    return fail(exit_bad_use, "no command; see morula --help");
  }
  const std::string first = argv[1];
  if (first.rfind('-', 0) != 0) check_name("command", first, command_names(app));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);
    return fail(exit_bad_use, parse_message(app, error));
  }
  return run();
}

int guarded(int argc, char** argv) {
  try {
    const int exit_code = run(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      return fail(exit_bad_use, "cannot write to standard output: is the disk full?");
    }
    return exit_code;
  } catch (const UsageError& error) {
    return fail(exit_bad_use, error.what());
  } catch (const FileError& error) {
    return fail(exit_bad_use, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(exit_bad_use, error.what());
  } catch (const std::invalid_argument& error) {
    return fail(exit_bad_use, error.what());
  } catch (const std::bad_alloc&) {
    return fail(exit_internal_error, "not enough memory");
  } catch (const std::exception& error) {
    return fail(exit_internal_error, fmt::format("internal: {}; please report it", error.what()));
  }
}

}  // namespace
}  // namespace morula::cli

int main(int argc, char** argv) {
  return morula::cli::guarded(argc, argv);
}
