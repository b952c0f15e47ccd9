// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Two functions of std::to_chars for doubles with a given number of digits. Those of the standard library have tables
// of 100 kB; these take the digits from snprintf, which computes them exactly, too.
#include <__algorithm/copy_n.h>
#include <__charconv/to_chars_result.h>

#include <__config>
#include <cstdint>
#include <cstdio>

_LIBCPP_BEGIN_NAMESPACE_STD

namespace {

// 309 digits before the point, and the 1100 of the longest precision that differs from zeros.
constexpr int longest = 1500;

to_chars_result written(char* first, char* last, const char* format, double value, uint32_t precision) {
  if (precision > 1100) return {last, errc::value_too_large};
  char text[longest];
  const int size = snprintf(text, sizeof text, format, static_cast<int>(precision), value);
  if (size < 0 || size >= longest || size > last - first) return {last, errc::value_too_large};
  std::copy_n(text, size, first);
  return {first + size, errc{}};
}

}  // namespace

[[nodiscard]] to_chars_result __d2fixed_buffered_n(char* first, char* last, double value, uint32_t precision) {
  return written(first, last, "%.*f", value, precision);
}
[[nodiscard]] to_chars_result __d2exp_buffered_n(char* first, char* last, double value, uint32_t precision) {
  return written(first, last, "%.*e", value, precision);
}

_LIBCPP_END_NAMESPACE_STD
