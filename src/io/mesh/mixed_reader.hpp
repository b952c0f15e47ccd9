// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files that mix lines of words with blocks of binary numbers, such as VTK's legacy files and Gmsh's.
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "io/byte_reader.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {

/// Every error is a FileError that names the line, or in binary files the byte. Words may lie on any line.
class MixedReader {
 public:
  /// bytes must outlive the reader.
  MixedReader(std::filesystem::path path, std::string_view bytes);

  /// Makes all following numbers binary.
  void set_binary(std::endian order) {
    is_binary_ = true;
    order_ = order;
  }
  bool is_binary() const { return is_binary_; }
  std::size_t bytes_left() const { return bytes_.size() - at_; }
  std::size_t at() const { return at_; }
  void seek(std::size_t at) { at_ = at; }
  /// The place of the next occurrence of a text; std::string_view::npos when there is none.
  std::size_t find(std::string_view text) const { return bytes_.find(text, at_); }

  /// The rest of this line without blanks at its ends, in either mode; steps over its end.
  std::string_view line();
  /// The next word on any line, in either mode; empty at the end of the file.
  std::string_view word();
  /// The word that word() will return.
  std::string_view peek();
  /// The next word; throws at the end of the file.
  std::string_view require_word(std::string_view what);
  /// A word that is a count, in either mode.
  std::uint64_t text_count(std::string_view what);

  /// A number in the present mode: a word, or the bytes of Value.
  template <class Value>
  double number(std::string_view what) {
    if (!is_binary_) return text_number(what);
    return finite(static_cast<double>(raw<Value>(what)), what);
  }
  template <class Value>
  std::int64_t integer(std::string_view what) {
    if (!is_binary_) return text_integer(what);
    return static_cast<std::int64_t>(raw<Value>(what));
  }
  void skip_bytes(std::uint64_t count, std::string_view what);
  /// Checks at intervals whether to go on; called for every row of binary numbers. The functions for words check by
  /// themselves.
  void begin_row() { poll_interrupt_(); }

  /// The number of elements that the rest of the file can hold, at most `count`, if each takes at least so many bytes.
  std::size_t at_most(std::uint64_t count, std::size_t least_bytes) const;
  /// Like at_most, but throws if the file cannot hold them.
  std::size_t require_room(std::uint64_t count, std::size_t least_bytes, std::string_view what) const;

  [[noreturn]] void fail(const std::string& problem) const;

 private:
  template <class Value>
  Value raw(std::string_view what) {
    if (sizeof(Value) > bytes_left()) cut_short(what);
    const Value value = load<Value>(bytes_.data() + at_, order_);
    at_ += sizeof(Value);
    return value;
  }
  [[noreturn]] void cut_short(std::string_view what) const;
  double text_number(std::string_view what);
  std::int64_t text_integer(std::string_view what);
  double finite(double value, std::string_view what) const;

  std::filesystem::path path_;
  std::string_view bytes_;
  char line_end_;
  std::size_t at_ = 0;
  InterruptPoller poll_interrupt_{1u << 14};
  bool is_binary_ = false;
  std::endian order_ = std::endian::little;
};

}  // namespace morula::detail
