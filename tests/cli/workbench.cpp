// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "workbench.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "platform/process.hpp"

namespace morula::test {
namespace {

using platform::ChildProgram;

#ifdef _WIN32
/// Words of a line as PowerShell tells them apart, without its comment, and with \$ and \" in quotation marks as POSIX
/// shells do.
std::vector<std::string> words_of_line(const std::string& line) {
  std::vector<std::string> words;
  bool is_open = false;
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    const bool is_blank = c == ' ' || c == '\n';
    if (quote == 0 && is_blank) {
      is_open = false;
      continue;
    }
    if (!is_open && c == '#') break;
    if (!is_open) words.emplace_back();
    is_open = true;
    const bool is_doubled = c == '\'' && quote == c && i + 1 < line.size() && line[i + 1] == c;
    if (is_doubled) {
      words.back() += line[++i];
    } else if (quote == 0 && (c == '"' || c == '\'')) {
      quote = c;
    } else if (c == quote) {
      quote = 0;
    } else {
      const bool is_escape =
          quote == '"' && c == '\\' && i + 1 < line.size() && (line[i + 1] == '$' || line[i + 1] == '"');
      words.back() += is_escape ? line[++i] : c;
    }
  }
  return words;
}

/// Another current folder for as long as this lives.
class InFolder {
 public:
  explicit InFolder(const std::filesystem::path& folder) : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(folder);
  }
  ~InFolder() { std::filesystem::current_path(before_); }
  InFolder(const InFolder&) = delete;
  InFolder& operator=(const InFolder&) = delete;

 private:
  std::filesystem::path before_;
};
#endif

}  // namespace

std::filesystem::path command_path() {
  static const std::filesystem::path path = std::filesystem::absolute(MORULA_COMMAND);
  return path;
}

bool has_extra(const std::string& name) {
  return std::string(MORULA_BUILT_EXTRAS).find(" " + name + " ") != std::string::npos;
}

bool has_all_extras() {
  return has_extra("grains") && has_extra("page") && has_extra("robot") && has_extra("study");
}

bool has_command(const std::string& name) {
  if (name == "clump") return has_extra("grains");
  if (name == "view") return has_extra("page");
  if (name == "demo" || name == "study") return has_extra("study");
  return name != "robot" || has_extra("robot");
}

#ifdef _WIN32
bool Workbench::has_shell() {
  return false;
}

CommandResult Workbench::shell(const std::string& line) const {
  throw std::logic_error("there is no shell for: " + line);
}

CommandResult Workbench::run(const std::string& arguments) const {
  std::vector<std::string> words = words_of_line(arguments);
  words.insert(words.begin(), command_path().string());
  const InFolder here(folder());
  ChildProgram program(words[0], words, {.reads_errors = true});
  const std::array<const ChildProgram*, 1> waited{&program};
  CommandResult result;
  for (bool has_output = true, has_errors = true; has_output || has_errors;) {
    ChildProgram::wait_for_any(waited, 100);
    has_output = has_output && program.read_output(result.out);
    has_errors = has_errors && program.read_errors(result.err);
  }
  const platform::ProcessStatus status = program.wait();
  result.exit_code = status.by_signal ? -1 : status.code;
  return result;
}
#else
bool Workbench::has_shell() {
  return true;
}

CommandResult Workbench::run(const std::string& arguments) const {
  return shell("\"$MORULA\" " + arguments);
}

CommandResult Workbench::shell(const std::string& command) const {
  // Beside the folder, so that the listing holds what the command wrote and nothing else.
  const std::string out = folder().string() + ".out";
  const std::string err = folder().string() + ".err";
  const std::string line = "cd '" + folder().string() + "' && MORULA='" + command_path().string() + "' && { " +
                           command + "\n} >'" + out + "' 2>'" + err + "' </dev/null";
  const platform::ProcessStatus status = ChildProgram({"sh", "-c", line}, {}).wait();
  CommandResult result;
  result.exit_code = status.by_signal ? -1 : status.code;
  result.out = bytes_of(out);
  result.err = bytes_of(err);
  std::filesystem::remove(out);
  std::filesystem::remove(err);
  return result;
}
#endif

CommandResult Workbench::require(const std::string& arguments) const {
  CommandResult result = run(arguments);
  EXPECT_EQ(result.exit_code, 0) << "morula " << arguments << "\n" << result.out << result.err;
  return result;
}

void Workbench::expect_refused(const std::string& arguments, const std::string& reason) const {
  const std::vector<std::string> before = listing();
  const CommandResult result = run(arguments);
  EXPECT_EQ(result.exit_code, 2) << "morula " << arguments << "\n" << result.out << result.err;
  EXPECT_EQ(result.out, "") << "morula " << arguments;
  EXPECT_EQ(result.err.rfind("morula: error: ", 0), 0u) << "morula " << arguments << "\n" << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find(reason), std::string::npos) << "morula " << arguments << "\n" << result.err;
  EXPECT_EQ(listing(), before) << "morula " << arguments;
}

bool Workbench::has_page() const {
  return has_extra("page") &&
         run("view no.obj no.morula -o no.html").err.find("built without its page: ") == std::string::npos;
}

void Workbench::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder() / name, std::ios::binary) << text;
}

std::string Workbench::read(const std::string& name) const {
  return bytes_of(folder() / name);
}

std::vector<std::string> Workbench::listing() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder())) {
    std::string line = std::filesystem::relative(entry.path(), folder()).generic_string();
    if (entry.is_regular_file()) line += ' ' + std::to_string(std::hash<std::string>{}(bytes_of(entry.path())));
    names.push_back(line);
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace morula::test
