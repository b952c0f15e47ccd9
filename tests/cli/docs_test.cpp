// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// README and the pages of docs show commands that work: blocks marked `sh` run as pasted, in an empty folder a page,
// with the command on the path, and blocks marked `console` show what happens. The pages about the command line mention
// every command and every option.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>

#include "workbench.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> command_pages{"docs/reference/cli.md", "docs/reference/cli_collide.md",
                                             "docs/reference/bounds.md", "extras/study/docs/cli_study.md"};

/// README and every page of docs and of the extras, by name.
std::vector<std::string> all_pages() {
  std::vector<std::string> pages{"README.md"};
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(MORULA_PAGES) / "docs"))
    if (entry.path().extension() == ".md") pages.push_back(fs::relative(entry.path(), MORULA_PAGES).generic_string());
  for (const auto& extra : fs::directory_iterator(fs::path(MORULA_PAGES) / "extras")) {
    if (!fs::is_directory(extra.path() / "docs")) continue;
    for (const auto& entry : fs::directory_iterator(extra.path() / "docs"))
      if (entry.path().extension() == ".md") pages.push_back(fs::relative(entry.path(), MORULA_PAGES).generic_string());
  }
  std::sort(pages.begin() + 1, pages.end());
  return pages;
}

std::vector<std::string> page_lines(const std::string& page) {
  std::ifstream file(fs::path(MORULA_PAGES) / page);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

struct Block {
  std::string page;
  std::size_t line = 0;  ///< of its fence, from 1
  std::string language;
  std::vector<std::string> lines;
};

std::vector<Block> blocks_of(const std::string& page) {
  std::vector<Block> blocks;
  bool open = false;
  const std::vector<std::string> lines = page_lines(page);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].rfind("```", 0) == 0) {
      open = !open;
      if (open) blocks.push_back({page, i + 1, lines[i].substr(3), {}});
    } else if (open) {
      blocks.back().lines.push_back(lines[i]);
    }
  }
  return blocks;
}

/// The command on the path, as somebody has it who installed it. hasty: builds that leave the method and the quality
/// open are done in quality draft.
class Reader {
 public:
  explicit Reader(bool hasty) {
    bench_.require("--version");
    fs::create_directory(bench_ / "bin");
    fs::create_directory(bench_ / "empty");
    std::string script = "#!/bin/sh\n";
    if (hasty)
      script +=
          "case \"$*\" in\n"
          "  *--method*|*--quality*) ;;\n"
          "  build*) set -- \"$@\" --quality draft ;;\n"
          "esac\n";
    // A build without node and npm has no page, and says so: that is tested elsewhere.
    script += "[ \"$1\" = view ] || exec '" MORULA_COMMAND
              "' \"$@\"\n"
              "said=$('" MORULA_COMMAND
              "' \"$@\" 2>&1)\n"
              "code=$?\n"
              "case $said in *'built without its page'*) exit 0 ;; esac\n"
              "printf '%s\\n' \"$said\"\n"
              "exit $code\n";
    bench_.write("bin/morula", script);
    fs::permissions(bench_ / "bin/morula", fs::perms::owner_all);
  }
  CommandResult shell(const std::string& line, const std::string& folder = "empty") const {
    return bench_.shell("PATH=\"$PWD/bin:$PATH\"; cd " + folder + "; " + line);
  }
  /// Beside the files of pasted blocks, which are brought up to date there: what a console leaves, no block finds.
  CommandResult console(const std::string& line) const {
    fs::copy(bench_ / "empty", bench_ / "consoles", fs::copy_options::recursive | fs::copy_options::update_existing);
    return shell(line, "consoles");
  }
  /// Line for line as pasted, up to the first command that fails.
  void paste(const Block& block) const {
    std::string script = "set -e\n";
    for (const std::string& line : block.lines) script += line + '\n';
    bench_.write("pasted", script);
    const CommandResult result = shell("sh ../pasted");
    EXPECT_EQ(result.exit_code, 0) << block.page << ':' << block.line << '\n' << result.out << result.err;
  }

 private:
  Workbench bench_;
};

TEST(Pages, the_first_block_of_readme_runs_as_pasted_with_hasty_builds) {
  if (!Workbench::has_shell()) GTEST_SKIP() << no_shell;
  if (!has_all_extras()) GTEST_SKIP() << "pages show commands of extras";
  const std::vector<Block> blocks = blocks_of("README.md");
  const auto first = std::find_if(blocks.begin(), blocks.end(), [](const Block& b) { return b.language == "sh"; });
  ASSERT_NE(first, blocks.end());
  Reader(true).paste(*first);
}

/// Only blocks that are marked are run, so none that shows the command may be without a mark: `bash` is for scripts of
/// a clone, which pages alone do not have.
TEST(Pages, mark_every_block_of_commands) {
  for (const std::string& page : all_pages())
    for (const Block& block : blocks_of(page)) {
      if (block.language == "sh" || block.language == "console") continue;
      for (const std::string& line : block.lines)
        EXPECT_NE(line.rfind("morula ", 0), 0u) << page << ':' << block.line << ": " << line;
    }
}

/// The words of what a command prints, in any order, without what differs from run to run: times, how lines are broken
/// and which of two streams came first. Of the study numbers are kept, but for those of the cost of updates, which are
/// times; of other commands every number counts as the same, since columns of their tables are times.
std::vector<std::string> steady_words(const std::vector<std::string>& lines, bool with_numbers) {
  static const std::regex time(R"(<?\b[0-9][0-9.,]* ?(ns|µs|us|ms|s|min)(/v)?(?![A-Za-z]))");
  static const std::regex number(R"([<+-]?[0-9][0-9.,e+-]*%?)");
  std::string text;
  for (const std::string& line : lines) text += line + ' ';
  text = in_one_line(text);
  // The times of updates in a study differ from run to run.
  const std::size_t cost = text.find("Nanoseconds per vertex on this machine");
  if (cost != std::string::npos) text.erase(cost, text.find(" Further claims", cost) - cost);
  text = std::regex_replace(text, time, "TIME");
  if (!with_numbers) text = std::regex_replace(text, number, "N");
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) {
    // Bars and rules of tables are as long as numbers say.
    const bool drawn = std::all_of(word.begin(), word.end(),
                                   [](char c) { return c == '-' || (static_cast<unsigned char>(c) & 0x80u) != 0; });
    if (!drawn) words.push_back(word);
  }
  std::sort(words.begin(), words.end());
  return words;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Blocks of a page run as pasted, one after another; what it shows of a command, from the line after "$ ..." to the
/// next one, is what the command prints.
TEST(LongPages, run_as_pasted_and_show_what_their_commands_print) {
  if (!Workbench::has_shell()) GTEST_SKIP() << no_shell;
  if (!has_all_extras()) GTEST_SKIP() << "pages show commands of extras";
  std::size_t pasted = 0, commands = 0;
  for (const std::string& page : all_pages()) {
    const Reader reader(false);
    for (const Block& block : blocks_of(page)) {
      if (block.language == "sh") {
        ++pasted;
        reader.paste(block);
      }
      if (block.language != "console") continue;
      for (std::size_t i = 0; i < block.lines.size(); ++i) {
        const std::string& line = block.lines[i];
        if (line.rfind("$ ", 0) != 0) continue;
        ++commands;
        std::vector<std::string> shown;
        while (i + 1 < block.lines.size() && block.lines[i + 1].rfind("$ ", 0) != 0) shown.push_back(block.lines[++i]);
        const CommandResult result = reader.console(line.substr(2));
        const bool shows_error = std::any_of(
            shown.begin(), shown.end(), [](const std::string& text) { return text.rfind("morula: error: ", 0) == 0; });
        EXPECT_EQ(result.exit_code, shows_error ? 2 : 0) << page << ": " << line << '\n' << result.err;
        const bool with_numbers = line.rfind("$ morula study", 0) == 0;
        EXPECT_EQ(steady_words(shown, with_numbers), steady_words(lines_of(result.out + result.err), with_numbers))
            << page << ": " << line
            << "\nIf what it prints is right: tests/cli/refresh_docs.py build/release/bin/morula " << page;
      }
    }
  }
  EXPECT_GE(pasted, 10u);
  EXPECT_GE(commands, 20u);
}

/// A line of the page for Windows as this system has it: elsewhere paths have slashes.
std::string of_this_system(std::string line) {
#ifndef _WIN32
  std::replace(line.begin(), line.end(), '\\', '/');
#endif
  return line;
}

/// The session of the page for Windows, as PowerShell reads it: `mkdir` and morula.
TEST(WindowsPage, shows_what_its_commands_print) {
  const Workbench bench;
  std::size_t commands = 0;
  for (const Block& block : blocks_of("docs/how-to/windows.md")) {
    if (block.language != "powershell") continue;
    for (std::size_t i = 0; i < block.lines.size(); ++i) {
      const std::string line = of_this_system(block.lines[i]);
      ASSERT_EQ(line.rfind("PS> ", 0), 0u) << line;
      std::vector<std::string> shown;
      while (i + 1 < block.lines.size() && block.lines[i + 1].rfind("PS> ", 0) != 0)
        shown.push_back(of_this_system(block.lines[++i]));
      if (line.rfind("PS> mkdir ", 0) == 0) {
        std::string folder = line.substr(10);
        std::erase(folder, '"');
        fs::create_directories(bench / folder);
        continue;
      }
      ASSERT_EQ(line.rfind("PS> morula ", 0), 0u) << line;
      ++commands;
      const CommandResult result = bench.run(line.substr(11));
      const bool shows_error = !shown.empty() && shown[0].rfind("morula: error: ", 0) == 0;
      EXPECT_EQ(result.exit_code, shows_error ? 2 : 0) << line << '\n' << result.err;
      EXPECT_EQ(steady_words(shown, false), steady_words(lines_of(result.out + result.err), false))
          << line << '\n'
          << result.out << result.err;
    }
  }
  EXPECT_GE(commands, 8u);
}

TEST(CliPages, mention_every_option_of_every_command) {
  std::string text;
  for (const std::string& page : command_pages)
    for (const std::string& line : page_lines(page)) text += line + '\n';
  const Workbench bench;
  for (const char* command : {"build", "measure", "deform", "update", "collide", "view", "medial", "info", "sample",
                              "convert", "demo", "study", "pairs"}) {
    if (!has_command(command)) continue;
    EXPECT_NE(text.find("\n## " + std::string(command) + "\n"), std::string::npos) << command;
    std::istringstream words(bench.require(std::string(command) + " --help").out);
    for (std::string word; words >> word;) {
      const std::size_t dashes = word.find("--");
      if (dashes == std::string::npos) continue;
      const std::size_t end = word.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-", dashes);
      const std::string option = word.substr(dashes, end - dashes);
      if (option == "--help" || option == "--output") continue;
      EXPECT_NE(text.find(option), std::string::npos) << command << ' ' << option;
    }
  }
}

}  // namespace
}  // namespace morula::test
