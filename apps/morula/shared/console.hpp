// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Console: messages to people besides the result, and the list of complete files.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>

namespace morula::cli {

/// Writes text to stderr, unchanged. A failed write is ignored.
void say_text(const std::string& text) noexcept;
template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  say_text(fmt::format(format, std::forward<Args>(args)...));
}

/// Sets whether all following notes and errors are one line of JSON each, as requested by --json: {"note": "…"} or
/// {"error": "…", "exit_code": 2}.
void write_messages_as_json(bool yes);
/// "morula: note: …", on stderr.
void note_text(const std::string& text);
template <class... Args>
void note(fmt::format_string<Args...> format, Args&&... args) {
  note_text(fmt::format(format, std::forward<Args>(args)...));
}
/// "morula: error: …", on stderr, in one line; returns the exit code.
int complain_text(int exit_code, std::string text);
template <class... Args>
int complain(int exit_code, fmt::format_string<Args...> format, Args&&... args) {
  return complain_text(exit_code, fmt::format(format, std::forward<Args>(args)...));
}
/// "morula: interrupted…", on stderr; returns the exit code.
int say_interrupted(int exit_code, const std::string& what_is_left);

/// Notes a complete output, which is reported if a later step fails.
void note_written(const std::filesystem::path& path);
/// "; a and b are written"; empty when there are none.
std::string written_so_far();

}  // namespace morula::cli
