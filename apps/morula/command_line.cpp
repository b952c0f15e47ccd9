// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <morula/io/mesh_file.hpp>
#include <morula/version.hpp>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "licenses.hpp"
#include "next_steps.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/extension.hpp"
#include "shared/interrupt.hpp"
#include "shared/options.hpp"

namespace morula::cli {
namespace {

int fail(int exit_code, std::string message) {
  return complain_text(exit_code, std::move(message));
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

/// The check comes ahead of parsing, because an error in parsing has to be reported in the same form.
bool has_json_option(int argc, char** argv) {
  return std::any_of(argv + 1, argv + std::max(argc, 1),
                     [](const char* word) { return std::string(word) == "--json"; });
}

bool takes_value(const CLI::App& app, const std::string& option) {
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (const CLI::Option* known = command->get_option_no_throw(option)) return known->get_items_expected_max() > 0;
  return false;
}

/// The index of the first word that is no option and no value of one: the place of a command. Options ahead of it are
/// rejected, but only once the command is known, so an unknown command is reported first. words.size() if options of
/// the program itself come before it, or there is no such word.
std::size_t command_place(const CLI::App& app, const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].empty() || words[i][0] != '-') return i;
    if (app.get_option_no_throw(words[i]) != nullptr) break;
    if (takes_value(app, words[i])) ++i;
  }
  return words.size();
}

/// Text for stdout that stands above the error, whatever the two streams lead to.
void print_first(const std::string& text) {
  fmt::print("{}", text);
  std::fflush(stdout);
}

/// For a first word that is no command: the error, and unless messages are JSON the commands to paste.
int reject_word(const CLI::App& app, const std::vector<std::string>& words, std::size_t at, bool as_json) {
  std::vector<std::string> options;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
  const NextSteps next = next_steps(words, at, command_names(app), options);
  if (!as_json) print_first(next.lines);
  return fail(exit_bad_use, next.error);
}

int run(int argc, char** argv, bool parse_only) {
  const bool as_json = has_json_option(argc, argv);
  write_messages_as_json(as_json);
  CLI::App app{"Sphere trees that cover a triangle mesh, certified, while it deforms.", "morula"};
  app.set_version_flag("--version", fmt::format("morula {}", version));
  bool licenses = false;
  app.add_flag("--licenses", licenses, "Print the licenses of the compiled components and exit");
  app.require_subcommand(1);
  app.get_formatter()->column_width(36);
  app.footer(
      "Example:\n"
      "  morula sample limb -o limb.obj\n"
      "  morula build limb.obj -o limb.morula\n"
      "  morula measure limb.obj limb.morula\n\n"
      "Exit codes: 0 done; 1 a check failed, the result is incomplete, or its report could not be printed;\n"
      "2 bad use or bad input, nothing written; 3 not enough memory, or an internal error; 130 Ctrl-C,\n"
      "143 SIGTERM and 129 SIGHUP, with no unfinished files left; 141 if standard output is closed.");
  Run run;
  add_build(app, run);
  add_measure(app, run);
  add_deform(app, run);
  add_update(app, run);
  add_collide(app, run);
  add_pairs(app, run);
  add_medial(app, run);
  add_bounds(app, run);
  add_info(app, run);
  add_repair(app, run);
  add_paraview(app, run);
  add_formats(app, run);
  add_sample(app, run);
  add_convert(app, run);
  add_batch(app, run);
  for (const Extension& extension : extensions())
    for (const auto add : extension.commands) add(app, run);
  add_completion(app, run);

  if (argc < 2) {
    print_first(first_steps(command_names(app)));
    return fail(exit_bad_use, "no command; see morula --help");
  }
  const std::string first = argv[1];
  if (first == "--licenses" && argc == 2) {
    if (!parse_only) fmt::print("{}", license_texts());
    return exit_done;
  }
  const std::vector<std::string> words(argv + 1, argv + argc), commands = command_names(app);
  const std::size_t place = command_place(app, words);
  if (place < words.size() && std::find(commands.begin(), commands.end(), words[place]) == commands.end())
    return reject_word(app, words, place, as_json);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);
    return fail(exit_bad_use, parse_message(app, error));
  }
  return parse_only ? exit_done : run();
}

/// The work is done, but its report cannot be printed. A closed reader, as in `morula … | head`, needs no more output,
/// and is no error to report.
int fail_to_print(int error) {
  if (error == EPIPE) return exit_nobody_reads;
  return fail(exit_check_failed,
              fmt::format("standard output cannot be written ({}){}",
                          error != 0 ? std::generic_category().message(error) : "it is closed", written_so_far()));
}

}  // namespace

std::string parse_message(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> commands = app.get_subcommands();
  const CLI::App& scope = commands.empty() ? app : *commands.front();
  const std::string help = commands.empty() ? "morula --help" : fmt::format("morula {} --help", scope.get_name());
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    // Words before the command are left to the program, those after it to the command.
    std::vector<std::string> extras = scope.remaining(true);
    const bool before_command = extras.empty();
    if (before_command) extras = app.remaining(false);
    const std::string extra = extras.empty() ? "?" : extras.front();
    if (extra.rfind('-', 0) != 0) return fmt::format("unexpected argument '{}'; see {}", extra, help);
    std::vector<std::string> known;
    for (const CLI::Option* option : scope.get_options()) {
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    }
    const std::string name = extra.substr(0, extra.find('='));
    if (before_command && std::find(known.begin(), known.end(), name) != known.end()) {
      return fmt::format("'{0}' comes after the command: morula {1} … {0}; see {2}", extra, scope.get_name(), help);
    }
    const std::string near = nearest_name(name, known);
    return fmt::format("unknown option '{}'{}; see {}", extra,
                       near.empty() ? "" : fmt::format(", did you mean {}?", near), help);
  }
  const bool lacks_tree =
      dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && std::string(error.what()).rfind("TREE ", 0) == 0;
  return fmt::format("{}{}; see {}", error.what(), lacks_tree ? "; morula build MESH -o TREE makes one" : "", help);
}

int command_line(int argc, char** argv, bool has_stdout, bool parse_only) {
  try {
    const int exit_code = run(argc, argv, parse_only);
    errno = 0;
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) return fail_to_print(errno);
    return has_stdout ? exit_code : fail_to_print(0);
  } catch (const UsageError& error) {
    return fail(exit_bad_use, error.what());
  } catch (const FileError& error) {
    return fail(exit_bad_use, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(exit_bad_use, error.what());
  } catch (const std::invalid_argument& error) {
    return fail(exit_bad_use, error.what());
  } catch (const std::bad_alloc&) {
    return fail(exit_internal_error, fmt::format("not enough memory{}", written_so_far()));
  } catch (const std::system_error& error) {
    if (std::ferror(stdout) != 0) return fail_to_print(error.code().value());
    return fail(exit_internal_error, fmt::format("{}{}", error.what(), written_so_far()));
  } catch (const std::exception& error) {
    return fail(exit_internal_error, fmt::format("internal: {}; please report it", error.what()));
  }
}

}  // namespace morula::cli
