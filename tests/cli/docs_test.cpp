// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page about the command line shows commands that work, and mentions every command and every option.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "workbench.hpp"

namespace morula::test {
namespace {

std::vector<std::string> page_lines() {
  std::ifstream file(MORULA_CLI_PAGE);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// `hasty`: options that spare builds work which the page does not ask for.
void expect_commands_do_what_the_page_shows(const std::string& hasty) {
  const std::vector<std::string> lines = page_lines();
  const Workbench bench;
  std::size_t commands = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string start = "$ morula ";
    // The demo and the study have tests of their own, and they are the slowest commands.
    if (lines[i].rfind(start, 0) != 0 || lines[i].rfind(start + "demo", 0) == 0) continue;
    if (lines[i].rfind(start + "study", 0) == 0) continue;
    ++commands;
    std::string command = lines[i].substr(start.size());
    if (command.rfind("build", 0) == 0 && command.find("--method") == std::string::npos) command += hasty;
    const CommandResult result = bench.run(command);
    const bool shows_error = i + 1 < lines.size() && lines[i + 1].rfind("morula: error: ", 0) == 0;
    if (shows_error) {
      EXPECT_EQ(result.exit_code, 2) << lines[i];
      EXPECT_EQ(result.err, lines[i + 1] + "\n");
    } else {
      EXPECT_EQ(result.exit_code, 0) << lines[i] << '\n' << result.err;
    }
  }
  EXPECT_GE(commands, 10u);
}

TEST(CliPage, its_commands_do_what_it_shows_with_hasty_builds) {
  expect_commands_do_what_the_page_shows(" --quality draft");
}

TEST(LongCliPage, its_commands_do_what_it_shows) {
  expect_commands_do_what_the_page_shows("");
}

TEST(CliPage, mentions_every_option_of_every_command) {
  std::string page;
  for (const std::string& line : page_lines()) page += line + '\n';
  const Workbench bench;
  for (const char* command : {"build", "measure", "deform", "update", "collide", "view", "medial", "info", "sample",
                              "convert", "demo", "study"}) {
    EXPECT_NE(page.find("## " + std::string(command) + "\n"), std::string::npos) << command;
    std::istringstream words(bench.require(std::string(command) + " --help").out);
    for (std::string word; words >> word;) {
      const std::size_t dashes = word.find("--");
      if (dashes == std::string::npos) continue;
      const std::size_t end = word.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-", dashes);
      const std::string option = word.substr(dashes, end - dashes);
      if (option == "--help" || option == "--output") continue;
      EXPECT_NE(page.find(option), std::string::npos) << command << ' ' << option;
    }
  }
}

}  // namespace
}  // namespace morula::test
