// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Console: messages to people beside the result, and the files that are there in the end.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>

namespace morula::cli {

/// On stderr, as it is. Nobody may be listening: that is no reason to fail.
void say_text(const std::string& text) noexcept;
template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  say_text(fmt::format(format, std::forward<Args>(args)...));
}

/// Are notes and errors from now on one line of JSON each, as asked for with --json:
/// {"note": "…"} or {"error": "…", "exit_code": 2}?
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

/// Makes sure that the three standard streams are open: a file that is written must not become one of them. False when
/// stdout was closed.
bool open_standard_streams();

/// An output that is complete: said when what follows goes wrong.
void note_written(const std::filesystem::path& path);
/// "; a and b are written"; nothing when nothing is.
std::string written_so_far();

}  // namespace morula::cli
