// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "read/xacro.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "parallel/interruption.hpp"
#include "platform/files.hpp"
#include "platform/path_text.hpp"
#include "platform/process.hpp"

namespace morula::robot {

namespace {

constexpr std::size_t most_output_bytes = 64u << 20, most_message_bytes = 500;

/// Whether an attribute has a value that xacro replaces. $(optenv …) alone is read without it.
bool has_expression(const tinyxml2::XMLElement& at) {
  for (const tinyxml2::XMLAttribute* a = at.FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string_view value = a->Value();
    if (value.find("${") != value.npos || value.find("$(arg ") != value.npos || value.find("$(find ") != value.npos)
      return true;
  }
  return false;
}

const tinyxml2::XMLElement* find_below(const tinyxml2::XMLElement& at, bool is_declared) {
  // Every element once, without recursion: nesting is limited by the parser only.
  const tinyxml2::XMLNode* node = &at;
  while (node != nullptr) {
    if (const tinyxml2::XMLElement* element = node->ToElement()) {
      if (std::string_view(element->Name()).starts_with("xacro:") || (is_declared && has_expression(*element)))
        return element;
    }
    if (node->FirstChild() != nullptr) {
      node = node->FirstChild();
      continue;
    }
    while (node != &at && node->NextSibling() == nullptr) node = node->Parent();
    node = node == &at ? nullptr : node->NextSibling();
  }
  return nullptr;
}

/// Reads output and errors of a program to their ends.
void read_all(platform::ChildProgram& program, std::string& text, std::string& message,
              const std::filesystem::path& file) {
  const std::array<const platform::ChildProgram*, 1> waited{&program};
  bool has_text = true, has_message = true;
  while (has_text || has_message) {
    detail::check_interrupt();
    platform::ChildProgram::wait_for_any(waited, 100);
    has_text = has_text && program.read_output(text);
    if (text.size() > most_output_bytes)
      throw FileError(fmt::format("{}: xacro makes more than 64 MiB of it", platform::text_of(file)));
    has_message = has_message && program.read_errors(message);
    message.resize(std::min(message.size(), most_output_bytes / 64));
  }
}

/// The lines of a message as one, cut at a length.
std::string one_line(const std::string& message) {
  std::string line;
  for (const char c : message) {
    const bool blank = static_cast<unsigned char>(c) <= ' ';
    if (!blank || (!line.empty() && line.back() != ' ')) line += blank ? ' ' : c;
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  if (line.size() > most_message_bytes) line = line.substr(0, most_message_bytes) + " …";
  return line;
}

/// A program that ended.
struct Run {
  int not_started = 0;  // the error where it could not be started
  platform::ProcessStatus status;
  std::string text, message;
  bool succeeded() const { return not_started == 0 && !status.by_signal && status.code == 0; }
};

/// Runs xacro on the file, with these options of its own and the arguments of the file.
Run run_xacro(const std::vector<std::string>& own, const std::filesystem::path& file, const ReadOptions& options) {
  std::vector<std::string> words{options.xacro};
  words.insert(words.end(), own.begin(), own.end());
  words.push_back(platform::text_of(std::filesystem::absolute(file)));
  words.insert(words.end(), options.xacro_arguments.begin(), options.xacro_arguments.end());
  Run run;
  try {
    platform::ChildProgram program(words, {.reads_errors = true});
    read_all(program, run.text, run.message, file);
    run.status = program.wait();
  } catch (const std::system_error& error) {
    run.not_started = error.code().value();
  }
  return run;
}

void require_argument(const std::string& argument) {
  const std::size_t at = argument.find(":=");
  if (at != std::string::npos && at > 0 && argument[0] != '-' && argument.find('\0') == std::string::npos) return;
  throw std::invalid_argument(fmt::format("xacro argument \"{}\": give NAME:=VALUE, as prefix:=left_", argument));
}

}  // namespace

const tinyxml2::XMLElement* find_xacro(const Xml& xml) {
  const tinyxml2::XMLElement& root = xml.root();
  if (std::string_view(root.Name()) != "robot") return nullptr;
  const bool is_declared = root.FindAttribute("xmlns:xacro") != nullptr || xml.file().extension() == ".xacro";
  return find_below(root, is_declared);
}

std::string expand_xacro(const std::filesystem::path& file, int line, const ReadOptions& options) {
  if (options.xacro.empty()) {
    fail_at(file, line, "has macros: run xacro on the file first, or name the program as the option xacro");
  }
  for (const std::string& argument : options.xacro_arguments) require_argument(argument);
  Run run = run_xacro({}, file, options);
  if (run.not_started != 0) {
    fail_at(file, line,
            fmt::format("has macros, and the program {} that expands them cannot be run ({}): install it (pip install "
                        "xacro, or ros-DISTRIBUTION-xacro), or name it as the option xacro",
                        options.xacro, platform::reason(run.not_started)));
  }
  if (!run.status.by_signal && run.status.code == 127 && run.text.empty() && run.message.empty()) {
    fail_at(file, line, fmt::format("has macros, and the program {} that expands them cannot be run", options.xacro));
  }
  if (!run.succeeded()) {
    fail_at(
        file, line,
        fmt::format("{} fails: {}", options.xacro, run.message.empty() ? "it says nothing" : one_line(run.message)));
  }
  return std::move(run.text);
}

std::vector<std::filesystem::path> files_of_xacro(const std::filesystem::path& file, const ReadOptions& options) {
  const Run run = run_xacro({"--deps"}, file, options);
  if (!run.succeeded()) return {};
  // Absolute paths with a blank between them; names may also have blanks.
  const auto is_path_at = [&](std::size_t at) {
    // Three letters show it. The last one may be a part of a character, which is no text.
    std::string_view start = std::string_view(run.text).substr(at, 3);
    const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80; };
    start = start.substr(
        0, static_cast<std::size_t>(std::find_if_not(start.begin(), start.end(), is_ascii) - start.begin()));
    return platform::path_of(start).is_absolute();
  };
  std::set<std::filesystem::path> files;
  for (std::size_t begin = 0; begin < run.text.size();) {
    std::size_t end = begin;
    while (end < run.text.size() && !(run.text[end] == ' ' && is_path_at(end + 1))) ++end;
    std::string name = run.text.substr(begin, end - begin);
    while (!name.empty() && (name.back() == '\n' || name.back() == '\r')) name.pop_back();
    std::error_code error;
    const std::filesystem::path path = platform::path_of(name);
    if (path.is_absolute() && std::filesystem::is_regular_file(path, error)) files.insert(path);
    begin = end + 1;
  }
  return {files.begin(), files.end()};
}

}  // namespace morula::robot
