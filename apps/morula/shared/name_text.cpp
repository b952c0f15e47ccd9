// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/name_text.hpp"

#include <array>
#include <cstddef>

namespace morula::cli {
namespace {

struct Utf8Form {
  unsigned char first_low, first_high, second_low, second_high;
  std::size_t length;
};
// The well-formed sequences of Unicode: neither overlong ones, nor surrogates, nor above 10FFFF.
constexpr std::array<Utf8Form, 8> utf8_forms{{{0xC2, 0xDF, 0x80, 0xBF, 2},
                                              {0xE0, 0xE0, 0xA0, 0xBF, 3},
                                              {0xE1, 0xEC, 0x80, 0xBF, 3},
                                              {0xED, 0xED, 0x80, 0x9F, 3},
                                              {0xEE, 0xEF, 0x80, 0xBF, 3},
                                              {0xF0, 0xF0, 0x90, 0xBF, 4},
                                              {0xF1, 0xF3, 0x80, 0xBF, 4},
                                              {0xF4, 0xF4, 0x80, 0x8F, 4}}};

// Bytes of the character at the beginning; 0 where there is none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return 1;
  for (const Utf8Form& form : utf8_forms) {
    if (byte(0) < form.first_low || byte(0) > form.first_high) continue;
    if (text.size() < form.length || byte(1) < form.second_low || byte(1) > form.second_high) return 0;
    for (std::size_t i = 2; i < form.length; ++i)
      if ((byte(i) & 0xC0) != 0x80) return 0;
    return form.length;
  }
  return 0;
}

int digit_of(char c) {
  return c >= '0' && c <= '9' ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

}  // namespace

std::string text_of_name(std::string_view name) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string text;
  bool is_text = name.find("\\x") == std::string_view::npos;
  for (std::size_t i = 0; i < name.size();) {
    const std::size_t length = utf8_length(name.substr(i));
    if (length == 0) {
      is_text = false;
      const auto byte = static_cast<unsigned char>(name[i++]);
      text += {'\\', 'x', digits[byte >> 4], digits[byte & 15]};
      continue;
    }
    // mutant batch-name-backslash: `if (name[i] == '\\') text += '\\'` -> `static_cast<void>(0)`
    if (name[i] == '\\') text += '\\';
    text += name.substr(i, length);
    i += length;
  }
  return is_text ? std::string(name) : text;
}

std::string name_of_text(std::string_view text) {
  if (text.find("\\x") == std::string_view::npos) return std::string(text);
  std::string name;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_byte =
        text.substr(i, 2) == "\\x" && i + 3 < text.size() && digit_of(text[i + 2]) >= 0 && digit_of(text[i + 3]) >= 0;
    if (is_byte) {
      name += static_cast<char>(16 * digit_of(text[i + 2]) + digit_of(text[i + 3]));
      i += 3;
    } else {
      name += text[i];
      if (text.substr(i, 2) == "\\\\") ++i;
    }
  }
  return name;
}

}  // namespace morula::cli
