// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A text for external parsers that checks for interruption while it is read.
#pragma once

#include <cstddef>
#include <iterator>
#include <string_view>

#include "parallel/interruption.hpp"

namespace morula::detail {

/// Its iterators check at every 65,536th character whether to go on. It serves parsers of JSON: a callback of the
/// parser could also check, but nlohmann's parser takes quadratic time for long lists if it has a callback.
class InterruptibleText {
 public:
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    Iterator(const char* at, const char* begin) : at_(at), begin_(begin) {}
    const char& operator*() const { return *at_; }
    Iterator& operator++() {
      // mutant looks-json-read: `if ((++at_ - begin_) % 65536 == 0) check_interrupt()` -> `++at_`
      if ((++at_ - begin_) % 65536 == 0) check_interrupt();
      return *this;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const char *at_, *begin_;
  };

  explicit InterruptibleText(std::string_view text) : text_(text) {}
  Iterator begin() const { return {text_.data(), text_.data()}; }
  Iterator end() const { return {text_.data() + text_.size(), text_.data()}; }

 private:
  std::string_view text_;
};

}  // namespace morula::detail
