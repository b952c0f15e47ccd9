// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "toolbox/shell_word.hpp"

#include <algorithm>
#include <string_view>

namespace morula::toolbox {

std::string shell_word(const std::string& word) {
#ifdef _WIN32
  constexpr std::string_view harmless = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+=:\\";
  constexpr const char* apostrophe = "''";
  const char quote = word.find_first_of("$`%'\"") == std::string::npos ? '"' : '\'';
#else
  constexpr std::string_view harmless = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+=:,@%";
  constexpr const char* apostrophe = "'\\''";
  constexpr char quote = '\'';
#endif
  const auto is_harmless = [&](char c) {
    return harmless.find(c) != std::string_view::npos || static_cast<unsigned char>(c) >= 0x80;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_harmless)) return word;
  std::string text(1, quote);
  for (const char c : word) text += c == '\'' && quote == c ? std::string(apostrophe) : std::string(1, c);
  return text + quote;
}

}  // namespace morula::toolbox
