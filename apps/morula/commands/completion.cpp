// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula completion: what shells complete words by, and the manual page; both made from the commands as they are.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/rules.hpp>
#include <morula/version.hpp>

#include "commands/bounds/evaluators.hpp"
#include "shared/command.hpp"
#include "shared/options.hpp"

namespace morula::cli {
namespace {

struct Argument {
  std::vector<std::string> names;  // with their dashes; none: positional
  std::string label;               // of its value; empty for a flag
  std::string description;
  std::vector<std::string> values;  // that it may have, where they are few; else files are offered
};
struct Command {
  std::string name, description, usage;
  std::vector<Argument> arguments;
};

template <class Values>
std::vector<std::string> choice_names(const Values& values) {
  std::vector<std::string> names;
  for (const auto value : values) names.emplace_back(name(value));
  return names;
}

std::vector<std::string> values_of(const std::string& command, const CLI::Option& option) {
  const std::string first = option.get_lnames().empty() ? option.get_name() : option.get_lnames().front();
  if (first == "method") return choice_names(all_methods());
  if (first == "quality") return choice_names(all_qualities());
  if (first == "optimizer") return choice_names(all_optimizers());
  if (first == "reducers") return choice_names(all_reductions());
  if (first == "evaluator") return evaluator_names();
  if (first == "rule" || first == "rules") return choice_names(all_rules());
  if (command == "sample" && option.get_positional()) return {sample_body_names().begin(), sample_body_names().end()};
  if (command == "completion" && option.get_positional()) return {"bash", "zsh", "fish", "man"};
  return {};
}

std::vector<Command> commands_of(const CLI::App& app) {
  std::vector<Command> commands;
  for (const CLI::App* found : app.get_subcommands([](const CLI::App*) { return true; })) {
    Command& command = commands.emplace_back(Command{found->get_name(), found->get_description(), {}, {}});
    for (const CLI::Option* option : found->get_options()) {
      Argument argument;
      for (const std::string& letter : option->get_snames()) argument.names.push_back("-" + letter);
      for (const std::string& word : option->get_lnames()) argument.names.push_back("--" + word);
      if (option->get_items_expected_max() != 0)
        argument.label = option->get_type_name().empty() ? "VALUE" : option->get_type_name();
      if (argument.names.empty()) argument.label = option->get_name();
      argument.description = option->get_description();
      argument.values = values_of(command.name, *option);
      command.arguments.push_back(std::move(argument));
    }
  }
  return commands;
}

std::vector<std::string> option_names(const Command& command) {
  std::vector<std::string> all;
  for (const Argument& argument : command.arguments)
    all.insert(all.end(), argument.names.begin(), argument.names.end());
  return all;
}

std::vector<std::string> names_of_commands(const std::vector<Command>& commands) {
  std::vector<std::string> names;
  for (const Command& command : commands) names.push_back(command.name);
  return names;
}

// The values that a positional argument may have; the commands have one such argument at most.
std::vector<std::string> positional_values(const Command& command) {
  for (const Argument& argument : command.arguments)
    if (argument.names.empty() && !argument.values.empty()) return argument.values;
  return {};
}

std::string bash(const std::vector<Command>& commands) {
  std::string text = fmt::format(
      "# Completion of morula {} for bash; made by: morula completion bash\n"
      "_morula() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} words= values=\n"
      "  COMPREPLY=()\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    mapfile -t COMPREPLY < <(compgen -W \"{} --help --version --licenses\" -- \"$word\")\n"
      "    return\n"
      "  fi\n"
      "  case ${{COMP_WORDS[1]}} in\n",
      version, fmt::join(names_of_commands(commands), " "));
  for (const Command& command : commands) {
    text += fmt::format("    {})\n      words='{}'\n", command.name, fmt::join(option_names(command), " "));
    if (const auto values = positional_values(command); !values.empty())
      text += fmt::format("      values='{}'\n", fmt::join(values, " "));
    text += "      case $before in\n";
    std::vector<std::string> with_files;
    for (const Argument& argument : command.arguments) {
      if (argument.names.empty() || argument.label.empty()) continue;
      if (argument.values.empty())
        with_files.insert(with_files.end(), argument.names.begin(), argument.names.end());
      else
        text += fmt::format("        {}) mapfile -t COMPREPLY < <(compgen -W '{}' -- \"$word\"); return ;;\n",
                            fmt::join(argument.names, "|"), fmt::join(argument.values, " "));
    }
    if (!with_files.empty())
      text += fmt::format("        {}) compopt -o default; return ;;\n", fmt::join(with_files, "|"));
    text += "      esac ;;\n";
  }
  text +=
      "    *) return ;;\n"
      "  esac\n"
      "  if [[ $word == -* ]]; then\n"
      "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
      "  elif [ -n \"$values\" ]; then\n"
      "    mapfile -t COMPREPLY < <(compgen -W \"$values\" -- \"$word\")\n"
      "  else\n"
      "    compopt -o default\n"
      "  fi\n"
      "}\n"
      "complete -F _morula morula\n";
  return text;
}

// For single quotes, and for descriptions that end at a bracket or a colon.
std::string for_shell(std::string_view text, std::string_view escaped = "") {
  std::string text_of;
  for (const char c : text) {
    if (c == '\'')
      text_of += "'\\''";
    else if (escaped.find(c) != std::string_view::npos)
      text_of += {'\\', c};
    else
      text_of += c == '\n' ? ' ' : c;
  }
  return text_of;
}

std::string zsh(const std::vector<Command>& commands) {
  std::string text = fmt::format(
      "#compdef morula\n"
      "# Completion of morula {} for zsh; made by: morula completion zsh\n"
      "_morula() {{\n"
      "  local -a commands\n"
      "  commands=(\n",
      version);
  for (const Command& command : commands)
    text += fmt::format("    '{}:{}'\n", command.name, for_shell(command.description, ":"));
  text +=
      "  )\n"
      "  if (( CURRENT == 2 )); then\n"
      "    _describe command commands\n"
      "    return\n"
      "  fi\n"
      "  shift words; (( CURRENT-- ))\n"
      "  case $words[1] in\n";
  for (const Command& command : commands) {
    text += fmt::format("    {}) _arguments", command.name);
    for (const Argument& argument : command.arguments) {
      const std::string values =
          argument.values.empty() ? "_files" : fmt::format("({})", fmt::join(argument.values, " "));
      if (argument.names.empty()) {
        text += fmt::format(" \\\n      '*:{}:{}'", for_shell(argument.label, ":"), values);
        continue;
      }
      for (const std::string& name : argument.names) {
        text += fmt::format(" \\\n      '{}[{}]", name, for_shell(argument.description, "[]"));
        if (!argument.label.empty()) text += fmt::format(":{}:{}", for_shell(argument.label, ":"), values);
        text += "'";
      }
    }
    text += " ;;\n";
  }
  text += "  esac\n}\n_morula \"$@\"\n";
  return text;
}

std::string fish(const std::vector<Command>& commands) {
  std::string text = fmt::format("# Completion of morula {} for fish; made by: morula completion fish\n", version);
  for (const Command& command : commands)
    text += fmt::format("complete -c morula -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name,
                        for_shell(command.description));
  for (const Command& command : commands)
    for (const Argument& argument : command.arguments) {
      text += fmt::format("complete -c morula -n '__fish_seen_subcommand_from {}'", command.name);
      for (const std::string& name : argument.names)
        text += name.rfind("--", 0) == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (!argument.values.empty())
        text += fmt::format(" -x -a '{}'", fmt::join(argument.values, " "));
      else if (!argument.label.empty() && !argument.names.empty())
        text += " -r -F";
      text += fmt::format(" -d '{}'\n", for_shell(argument.description));
    }
  return text;
}

// Text of a manual page: backslashes, dashes that are typed, and lines that would begin with a request.
std::string troff(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\\')
      safe += "\\e";
    else if (c == '-')
      safe += "\\-";
    else if ((c == '.' || c == '\'') && (safe.empty() || safe.back() == '\n'))
      safe += fmt::format("\\&{}", c);
    else
      safe += c;
  }
  return safe;
}

std::string manual(const CLI::App& app, const std::vector<Command>& commands) {
  std::string text = fmt::format(
      ".TH MORULA 1 \"\" \"morula {0}\" \"User Commands\"\n"
      ".SH NAME\nmorula \\- {1}\n"
      ".SH SYNOPSIS\n.B morula\n.I COMMAND\n.RI [ OPTION ...]\n"
      ".SH DESCRIPTION\n"
      "Builds trees of spheres over triangle meshes, keeps them certified to cover while the meshes deform, measures "
      "how\n"
      "well they fit, and answers collision queries.\n"
      ".SH COMMANDS\n",
      version, troff("sphere trees that cover a triangle mesh, certified, while it deforms"));
  for (const Command& command : commands) {
    text += fmt::format(".SS morula {}\n{}\n", command.name, troff(command.description));
    for (const Argument& argument : command.arguments) {
      text += fmt::format(
          ".TP\n.B {}",
          troff(argument.names.empty() ? argument.label : fmt::format("{}", fmt::join(argument.names, ", "))));
      if (!argument.names.empty() && !argument.label.empty()) text += fmt::format(" {}", troff(argument.label));
      text += fmt::format("\n{}\n", troff(argument.description));
    }
    const std::string footer = app.get_subcommand(command.name)->get_footer();
    if (!footer.empty()) text += fmt::format(".PP\n.nf\n{}\n.fi\n", troff(footer));
  }
  text += fmt::format(".SH EXAMPLES AND EXIT STATUS\n.nf\n{}\n.fi\n", troff(app.get_footer()));
  return text;
}

struct CompletionArguments {
  std::string kind;
};

}  // namespace

void add_completion(CLI::App& app, Run& run) {
  const auto o = std::make_shared<CompletionArguments>();
  CLI::App* command =
      add_command(app, "completion", "Print what a shell completes morula's words by, or the manual page");
  add_option(*command, "kind", o->kind, "bash, zsh, fish, or man")->required();
  set_footer(*command,
             "Example:\n"
             "  morula completion bash > ~/.local/share/bash-completion/completions/morula\n"
             "  morula completion zsh > \"${fpath[1]}/_morula\"\n"
             "  morula completion fish > ~/.config/fish/completions/morula.fish\n"
             "  morula completion man > morula.1 && man ./morula.1");
  on_use(*command, [&app, &run, o] {
    run = [&app, o] {
      check_name("shell", o->kind, {"bash", "zsh", "fish", "man"});
      const std::vector<Command> commands = commands_of(app);
      fmt::print("{}", o->kind == "bash"   ? bash(commands)
                       : o->kind == "zsh"  ? zsh(commands)
                       : o->kind == "fish" ? fish(commands)
                                           : manual(app, commands));
      return exit_done;
    };
  });
}

}  // namespace morula::cli
