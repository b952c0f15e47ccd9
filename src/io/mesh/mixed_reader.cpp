// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/mixed_reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "io/text_scanner.hpp"
#include "io/whole_file.hpp"
#include "platform/decimal.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {
namespace {

constexpr std::string_view blank_bytes = " \t\r\n\v\f";

bool is_blank(char c) {
  return blank_bytes.find(c) != blank_bytes.npos;
}

}  // namespace

MixedReader::MixedReader(std::filesystem::path path, std::string_view bytes)
    : path_(std::move(path)), bytes_(bytes), line_end_(line_end_of(bytes)) {}

std::string_view MixedReader::line() {
  const std::size_t end = std::min(bytes_.find(line_end_, at_), bytes_.size());
  std::string_view text = bytes_.substr(at_, end - at_);
  at_ = std::min(end + 1, bytes_.size());
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  return text;
}

std::string_view MixedReader::word() {
  poll_interrupt_();
  while (at_ < bytes_.size() && is_blank(bytes_[at_])) ++at_;
  const std::size_t begin = at_;
  while (at_ < bytes_.size() && !is_blank(bytes_[at_])) ++at_;
  return bytes_.substr(begin, at_ - begin);
}

std::string_view MixedReader::peek() {
  const std::size_t before = at_;
  const std::string_view text = word();
  at_ = before;
  return text;
}

std::string_view MixedReader::require_word(std::string_view what) {
  const std::string_view text = word();
  if (text.empty()) cut_short(what);
  return text;
}

std::uint64_t MixedReader::text_count(std::string_view what) {
  const std::int64_t value = text_integer(what);
  if (value < 0) fail(std::string(what) + " is " + std::to_string(value) + ", less than none");
  return static_cast<std::uint64_t>(value);
}

double MixedReader::text_number(std::string_view what) {
  std::string_view text = require_word(what);
  const std::string_view whole = text;
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  if (begins_with_old_nonfinite(text)) finite(std::numeric_limits<double>::quiet_NaN(), what);
  double value = 0;
  const std::from_chars_result read = platform::read_number(text.data(), text.data() + text.size(), value);
  if (read.ptr != text.data() + text.size() || read.ec == std::errc::invalid_argument)
    fail(in_quotes(whole) + " is not a number, but " + std::string(what) + " should be here");
  // A number below the smallest double may be 0; one beyond the largest is an error.
  if (read.ec == std::errc::result_out_of_range) fail(in_quotes(whole) + " is out of range for " + std::string(what));
  return finite(value, what);
}

std::int64_t MixedReader::text_integer(std::string_view what) {
  const std::string_view text = require_word(what);
  std::int64_t value = 0;
  const std::from_chars_result read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec == std::errc::result_out_of_range) fail(in_quotes(text) + " is out of range for " + std::string(what));
  if (read.ec != std::errc() || read.ptr != text.data() + text.size())
    fail(in_quotes(text) + " is not a whole number, but " + std::string(what) + " should be here");
  return value;
}

double MixedReader::finite(double value, std::string_view what) const {
  if (!std::isfinite(value)) fail(std::string(what) + " is not finite; remove or repair it where the file was made");
  return value;
}

void MixedReader::skip_bytes(std::uint64_t count, std::string_view what) {
  if (count > bytes_left()) cut_short(what);
  at_ += static_cast<std::size_t>(count);
}

std::size_t MixedReader::at_most(std::uint64_t count, std::size_t least_bytes) const {
  return static_cast<std::size_t>(std::min<std::uint64_t>(count, bytes_left() / least_bytes + 1));
}

std::size_t MixedReader::require_room(std::uint64_t count, std::size_t least_bytes, std::string_view what) const {
  if (at_most(count, least_bytes) < count)
    fail("the file counts " + std::to_string(count) + " " + std::string(what) + ", but has only " +
         std::to_string(bytes_left()) + " bytes left; it was cut short, or the count is wrong");
  return static_cast<std::size_t>(count);
}

void MixedReader::cut_short(std::string_view what) const {
  fail("the file ends inside " + std::string(what) + "; it was cut short, or its counts are wrong");
}

void MixedReader::fail(const std::string& problem) const {
  if (is_binary_) throw FileError(platform::text_of(path_) + ": byte " + std::to_string(at_) + ": " + problem);
  const std::string_view before = bytes_.substr(0, at_ > 0 ? at_ - 1 : 0);
  const auto line = 1 + std::count(before.begin(), before.end(), line_end_);
  throw FileError(platform::text_of(path_) + ":" + std::to_string(line) + ": " + problem);
}

}  // namespace morula::detail
