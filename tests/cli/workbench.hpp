// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A folder of its own for every test, in which the command is run as from a shell.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <support/scratch_folder.hpp>
#include <vector>

namespace morula::test {

/// Whether the command was built with grains, page, robot or study.
bool has_extra(const std::string& name);
bool has_all_extras();
/// Whether the command has this subcommand: those of extras are there where these were built.
bool has_command(const std::string& name);

struct CommandResult {
  int exit_code = -1;
  std::string out;
  std::string err;

  nlohmann::json json() const { return nlohmann::json::parse(out); }
};

inline constexpr const char* no_shell = "there is no POSIX shell";

/// The command under test.
std::filesystem::path command_path();

class Workbench {
 public:
  const std::filesystem::path& folder() const { return folder_.path(); }
  std::filesystem::path operator/(const std::string& name) const { return folder() / name; }
  /// Runs "morula ARGUMENTS" in the folder. POSIX: through the shell. Windows: words in quotation marks are one.
  CommandResult run(const std::string& arguments) const;
  /// Whether there is a POSIX shell, which some tests need to close streams, fill them or set limits.
  static bool has_shell();
  /// Runs a line of it in the folder, where $MORULA is the command.
  CommandResult shell(const std::string& line) const;
  /// As run(), and fails the test unless the command says that all is done.
  CommandResult require(const std::string& arguments) const;
  /// What every refusal is: exit code 2, nothing on stdout, one line on stderr that begins as errors do and holds
  /// `reason`, and nothing touched.
  void expect_refused(const std::string& arguments, const std::string& reason) const;
  /// Whether the command was built with its page, which needs node and npm.
  bool has_page() const;
  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;
  /// Everything in the folder and below, sorted, with sizes and contents hashed: two equal listings, nothing touched.
  std::vector<std::string> listing() const;

 private:
  ScratchFolder folder_;
};

/// A text whose lines are broken for people, as one line: every run of blanks and line breaks is one blank.
inline std::string in_one_line(const std::string& text) {
  std::string line;
  for (const char c : text) {
    const bool blank = c == ' ' || c == '\n';
    if (!blank || line.empty() || line.back() != ' ') line += blank ? ' ' : c;
  }
  return line;
}

/// What a page says it holds: counts, names, places of its data.
inline nlohmann::json page_manifest(const std::string& page) {
  const std::string open = "id=\"morula-manifest\">";
  const std::size_t begin = page.find(open) + open.size();
  return nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

}  // namespace morula::test
