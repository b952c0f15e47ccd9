// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What shells complete by: every option that the help knows, and nothing else.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>

#include "workbench.hpp"

namespace morula::test {
namespace {

const std::vector<std::string> some_commands{"build", "update", "collide", "sample", "info"};

std::set<std::string> words_like(const std::string& text, const char* pattern) {
  const std::regex expression(pattern);
  std::set<std::string> words;
  for (std::sregex_iterator at(text.begin(), text.end(), expression), end; at != end; ++at) words.insert((*at)[1]);
  return words;
}

// The options as the help lists them: at the beginning of a line, before two spaces.
std::set<std::string> options_in_help(const Workbench& bench, const std::string& command) {
  const std::string help = bench.require(command + " --help").out;
  std::set<std::string> options;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("  -", 0) == 0)
      for (const std::string& name : words_like(line.substr(0, 36), "(--[a-z0-9-]+)")) options.insert(name);
  return options;
}

std::set<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

// What bash would offer for the last of these words.
std::set<std::string> completed(const Workbench& bench, const std::string& words) {
  bench.write("complete.bash", "source <(\"$MORULA\" completion bash)\ncompopt() { echo FILES; }\nCOMP_WORDS=(morula " +
                                   words +
                                   ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_morula\necho \"${COMPREPLY[@]}\"\n");
  const CommandResult result = bench.shell("MORULA=$MORULA bash complete.bash");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  return words_of(result.out);
}

TEST(Completion, of_bash_offers_what_the_help_lists) {
  if (!Workbench::has_shell()) GTEST_SKIP() << no_shell;
  const Workbench bench;
  EXPECT_EQ(completed(bench, "me"), (std::set<std::string>{"measure", "medial"}));
  for (const std::string& command : some_commands) {
    std::set<std::string> offered = completed(bench, command + " --");
    EXPECT_EQ(offered.erase("--help"), 1u);
    std::set<std::string> known = options_in_help(bench, command);
    EXPECT_GT(known.size(), 2u);
    known.erase("--help");
    EXPECT_EQ(offered, known) << command;
  }
}

TEST(Completion, of_bash_offers_values_and_files) {
  if (!Workbench::has_shell()) GTEST_SKIP() << no_shell;
  const Workbench bench;
  EXPECT_EQ(completed(bench, "build --method g"), std::set<std::string>{"grid"});
  EXPECT_EQ(completed(bench, "update --rule app"), (std::set<std::string>{"approach1", "approach2"}));
  EXPECT_EQ(completed(bench, "build --output x"), std::set<std::string>{"FILES"});
  EXPECT_EQ(completed(bench, "build lim"), std::set<std::string>{"FILES"});
  EXPECT_EQ(completed(bench, "build --nested lim"), std::set<std::string>{"FILES"}) << "a flag takes no value";
  EXPECT_EQ(completed(bench, "sample to"), (std::set<std::string>{"tool", "torus"}));
  EXPECT_EQ(completed(bench, "nonsense x"), std::set<std::string>{});
}

TEST(Completion, of_other_shells_and_the_manual_name_every_option) {
  const Workbench bench;
  const std::string zsh = bench.require("completion zsh").out, fish = bench.require("completion fish").out,
                    man = std::regex_replace(bench.require("completion man").out, std::regex("\\\\-"), "-");
  EXPECT_EQ(zsh.rfind("#compdef morula\n", 0), 0u);
  for (const std::string& command : some_commands) {
    EXPECT_NE(fish.find("-a " + command + " "), std::string::npos);
    const std::size_t page = man.find(".SS morula " + command + "\n");
    ASSERT_NE(page, std::string::npos);
    const std::set<std::string> in_manual =
        words_like(man.substr(page, man.find("\n.S", page + 1) - page), "[ ,](--[a-z0-9-]+)");
    const std::size_t in_zsh = zsh.find("    " + command + ") _arguments");
    ASSERT_NE(in_zsh, std::string::npos);
    const std::string zsh_of_command = zsh.substr(in_zsh, zsh.find(";;", in_zsh) - in_zsh);
    for (const std::string& option : options_in_help(bench, command)) {
      EXPECT_TRUE(in_manual.contains(option)) << command << " " << option;
      EXPECT_NE(zsh_of_command.find("'" + option + "["), std::string::npos) << command << " " << option;
      EXPECT_NE(fish.find("__fish_seen_subcommand_from " + command + "' ", 0), std::string::npos);
      EXPECT_NE(fish.find(" -l " + option.substr(2) + " "), std::string::npos) << option;
    }
  }
  bench.expect_refused("completion powershell", "unknown shell 'powershell'; known: bash, zsh, fish, man");
}

// Quotes that do not match would end the function early: every shell at hand reads what is meant for it.
TEST(Completion, is_read_by_the_shells_that_are_here) {
  if (!Workbench::has_shell()) GTEST_SKIP() << no_shell;
  const Workbench bench;
  for (const std::string shell : {"bash", "zsh", "fish"}) {
    if (bench.shell("command -v " + shell).exit_code != 0) continue;
    const CommandResult read = bench.shell("\"$MORULA\" completion " + shell + " > it && " + shell + " -n it");
    EXPECT_EQ(read.exit_code, 0) << shell << ": " << read.err;
  }
}

}  // namespace
}  // namespace morula::test
