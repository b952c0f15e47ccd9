// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Numbers as text: the shortest digits that read back as the same bits, in every locale.
#pragma once

#include <charconv>
#include <string>

namespace morula::detail {

template <class Number>
void append_number(std::string& text, Number value) {
  char digits[32];  // the longest double takes 24 characters
  const std::to_chars_result written = std::to_chars(digits, digits + sizeof digits, value);
  text.append(digits, written.ptr);
}

}  // namespace morula::detail
