// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/console.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>
#include <vector>

#include "shared/name_text.hpp"

namespace morula::cli {
namespace {

struct Written {
  std::mutex mutex;
  std::vector<std::string> names;
};
// Never destroyed: a signal may come after main.
Written& written() {
  static Written& all = *new Written;
  return all;
}

std::atomic<bool> as_json{false};

std::string json_line(const nlohmann::ordered_json& json) {
  return json.dump() + "\n";
}

}  // namespace

void write_messages_as_json(bool yes) {
  as_json = yes;
}

void note_text(const std::string& text) {
  say_text(as_json ? json_line({{"note", text_of_name(text)}}) : "morula: note: " + text + "\n");
}

int complain_text(int exit_code, std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  say_text(as_json ? json_line({{"error", text_of_name(text)}, {"exit_code", exit_code}})
                   : "morula: error: " + text + "\n");
  return exit_code;
}

int say_interrupted(int exit_code, const std::string& what_is_left) {
  const std::string text = "interrupted" + what_is_left;
  say_text(as_json ? json_line({{"error", text_of_name(text)}, {"exit_code", exit_code}}) : "morula: " + text + "\n");
  return exit_code;
}

void say_text(const std::string& text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void note_written(const std::filesystem::path& path) {
  const std::lock_guard lock(written().mutex);
  written().names.push_back(path.string());
}

std::string written_so_far() {
  const std::lock_guard lock(written().mutex);
  const std::vector<std::string>& names = written().names;
  if (names.empty()) return {};
  return fmt::format("; {} {} written", fmt::join(names, " and "), names.size() > 1 ? "are" : "is");
}

}  // namespace morula::cli
