// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/text_scanner.hpp"

#include <charconv>
#include <cmath>
#include <cstring>
#include <morula/io/mesh_file.hpp>

#include "io/whole_file.hpp"
#include "platform/decimal.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {

char line_end_of(std::string_view text) {
  return text.find('\n') == text.npos && text.find('\r') != text.npos ? '\r' : '\n';
}

bool begins_with_old_nonfinite(std::string_view text) {
  if (text.starts_with('+') || text.starts_with('-')) text.remove_prefix(1);
  if (!text.starts_with("1.#")) return false;
  text.remove_prefix(3);
  return text.starts_with("IND") || text.starts_with("INF") || text.starts_with("QNAN") || text.starts_with("SNAN");
}

bool TextScanner::is_blank(char c) const {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || (c == '\r' && syntax_.line_end != '\r');
}

bool TextScanner::ends_word(char c) const {
  return is_blank(c) || c == syntax_.line_end || c == syntax_.comment || (c == '\\' && syntax_.backslash_joins);
}

TextScanner::TextScanner(std::filesystem::path path, std::string_view text, Syntax syntax)
    : path_(std::move(path)), syntax_(syntax) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (text.substr(0, byte_order_mark.size()) == byte_order_mark) text.remove_prefix(byte_order_mark.size());
  if (syntax_.line_end == '\0') syntax_.line_end = line_end_of(text);
  // Without comments the character is the line end, which ends a word anyway.
  if (syntax_.comment == '\n') syntax_.comment = syntax_.line_end;
  at_ = text.data();
  end_ = at_ + text.size();
}

bool TextScanner::next_line() {
  if (line_ == 0) {
    line_ = 1;
    if (!at_line_end()) return true;
  }
  while (at_ < end_) {
    poll_interrupt_();
    const std::string_view rest = after_line();
    if (rest.empty()) {
      at_ = end_;
      break;
    }
    at_ = rest.data();
    ++line_;
    if (!at_line_end()) return true;
  }
  return false;
}

void TextScanner::require_line(std::uint64_t done, std::uint64_t total, std::string_view kind) {
  if (!next_line())
    fail("the file ends after " + std::to_string(done) + " of " + std::to_string(total) + " " + std::string(kind) +
         "; it was cut short, or its counts are wrong");
}

bool TextScanner::at_line_end() {
  while (at_ < end_) {
    if (is_blank(*at_)) {
      ++at_;
    } else if (*at_ == '\\' && syntax_.backslash_joins) {
      const char* next = at_ + 1;
      while (next < end_ && is_blank(*next)) ++next;
      if (next < end_ && *next != syntax_.line_end) return false;
      if (next < end_) {
        ++next;
        ++line_;
      }
      at_ = next;
    } else {
      return *at_ == syntax_.line_end || *at_ == syntax_.comment;
    }
  }
  return true;
}

void TextScanner::require_line_end(std::string_view expected) {
  if (!at_line_end())
    fail(in_quotes(word()) + " follows " + std::string(expected) + " on this line, where nothing should");
}

std::string_view TextScanner::word() {
  if (at_line_end()) return {};
  const char* begin = at_;
  // It takes at least one character: a backslash that joins no line is a word like any other.
  do ++at_;
  while (at_ < end_ && !ends_word(*at_));
  return {begin, static_cast<std::size_t>(at_ - begin)};
}

template <class Value>
Value TextScanner::value(std::string_view what, const char* kind) {
  if (at_line_end()) fail("the line ends where " + std::string(what) + " should be");
  const char* const begin = at_;
  if (begins_with_old_nonfinite({at_, bytes_left()}))
    fail(std::string(what) + " is not finite; remove or repair it where the file was made");
  // from_chars takes no plus; "+-1" must not be accepted.
  if (*at_ == '+' && at_ + 1 < end_ && at_[1] != '-') ++at_;
  Value result{};
  const std::from_chars_result parsed = platform::read_number(at_, end_, result);
  at_ = parsed.ptr;
  const bool stops_well = at_ == end_ || ends_word(*at_);
  if (parsed.ec == std::errc() && stops_well) return result;
  at_ = begin;
  const std::string_view text = word();
  if (parsed.ec == std::errc::result_out_of_range && stops_well)
    fail(in_quotes(text) + " is out of range for " + std::string(what));
  fail(in_quotes(text) + " is not " + kind + ", but " + std::string(what) + " should be here");
}

double TextScanner::number(std::string_view what) {
  const double result = value<double>(what, "a number");
  if (!std::isfinite(result)) fail(std::string(what) + " is not finite; remove or repair it where the file was made");
  return result;
}

std::int64_t TextScanner::integer(std::string_view what) {
  return value<std::int64_t>(what, "a whole number");
}

std::uint64_t TextScanner::count(std::string_view what) {
  const std::int64_t result = integer(what);
  if (result < 0) fail(std::string(what) + " is " + std::to_string(result) + ", less than none");
  return static_cast<std::uint64_t>(result);
}

std::string_view TextScanner::after_line() const {
  const void* newline = at_ == end_ ? nullptr : std::memchr(at_, syntax_.line_end, bytes_left());
  if (!newline) return {};
  const char* next = static_cast<const char*>(newline) + 1;
  return {next, static_cast<std::size_t>(end_ - next)};
}

void TextScanner::fail_at(std::size_t line, const std::string& problem) const {
  throw FileError(platform::text_of(path_) + ":" + std::to_string(line) + ": " + problem);
}

}  // namespace morula::detail
