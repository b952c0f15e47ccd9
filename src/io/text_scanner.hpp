// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A scanner of text files, line by line and word by word, whose errors name the line. Shared by all text formats.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "parallel/interruption.hpp"

namespace morula::detail {

/// The line end of a text: carriage return if it has these and no line feed, as in files of old Macintoshes; else line
/// feed.
char line_end_of(std::string_view text);

/// Whether the text begins with a nonfinite number as old Visual C++ writes it: 1.#IND, -1.#INF, 1.#QNAN, …?
bool begins_with_old_nonfinite(std::string_view text);

/// A scanner starts ahead of the first line; next_line() steps onto it. Words are separated by blanks; carriage returns
/// are blanks, unless they alone end lines, so all line ends work. Every error is a FileError "FILE:LINE: what is
/// wrong; remedy".
class TextScanner {
 public:
  struct Syntax {
    char comment = '\n';           ///< character that starts a comment, which lasts to the end of the line; '\n': no
                                   ///< comments
    bool backslash_joins = false;  ///< whether a backslash at the end of a line continues it on the next
    char line_end = '\0';          ///< end of lines; '\0': by line_end_of()
  };

  /// text must outlive the scanner.
  TextScanner(std::filesystem::path path, std::string_view text) : TextScanner(std::move(path), text, Syntax{}) {}
  TextScanner(std::filesystem::path path, std::string_view text, Syntax syntax);

  /// Leaves the rest of this line and goes to the next one that holds a word. False at the end of the file.
  bool next_line();
  /// Like next_line(), but the file must not end here: `done` of `total` rows of this kind were read.
  void require_line(std::uint64_t done, std::uint64_t total, std::string_view kind);
  /// Whether no word is left on this line.
  bool at_line_end();
  /// Throws FileError if the line has more words; `expected` describes the complete line.
  void require_line_end(std::string_view expected);
  /// The next word of this line; empty at its end.
  std::string_view word();
  /// Takes back the last characters of a word.
  void back_up(std::size_t characters) { at_ -= characters; }

  /// `what` names the value in messages, as in "a coordinate". Both functions accept a leading plus.
  double number(std::string_view what);  ///< a finite number
  std::int64_t integer(std::string_view what);
  std::uint64_t count(std::string_view what);  ///< an integer that is not negative

  std::size_t line() const { return line_; }
  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }
  /// The text that follows this line.
  std::string_view after_line() const;

  [[noreturn]] void fail(const std::string& problem) const { fail_at(line_, problem); }
  [[noreturn]] void fail_at(std::size_t line, const std::string& problem) const;

 private:
  bool is_blank(char c) const;
  bool ends_word(char c) const;
  template <class Value>
  Value value(std::string_view what, const char* kind);

  std::filesystem::path path_;
  const char* at_;
  const char* end_;
  std::size_t line_ = 0;
  Syntax syntax_;
  // mutant looks-scanner: `4096` -> `1u << 30`
  InterruptPoller poll_interrupt_{4096};
};

}  // namespace morula::detail
