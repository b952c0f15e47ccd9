// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "workbench.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>

namespace morula::test {

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

CommandResult Workbench::run(const std::string& arguments) const {
  return shell("\"$MORULA\" " + arguments);
}

CommandResult Workbench::shell(const std::string& command) const {
  // Beside the folder, so that the listing holds what the command wrote and nothing else.
  const std::string out = folder().string() + ".out";
  const std::string err = folder().string() + ".err";
  const std::string line = "cd '" + folder().string() + "' && MORULA='" MORULA_COMMAND "' && { " + command + "\n} >'" +
                           out + "' 2>'" + err + "' </dev/null";
  const int status = std::system(line.c_str());
  CommandResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  result.out = bytes_of(out);
  result.err = bytes_of(err);
  std::filesystem::remove(out);
  std::filesystem::remove(err);
  return result;
}

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
    std::string line = std::filesystem::relative(entry.path(), folder()).string();
    if (entry.is_regular_file()) line += ' ' + std::to_string(std::hash<std::string>{}(bytes_of(entry.path())));
    names.push_back(line);
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace morula::test
