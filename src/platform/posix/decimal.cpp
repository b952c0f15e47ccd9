// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "platform/decimal.hpp"

#include <locale.h>
#include <stdlib.h>
#if defined(__APPLE__) || defined(__FreeBSD__)
#include <xlocale.h>
#endif

#include <bit>
#include <cfenv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>
#include <string>
#include <string_view>

namespace morula::platform {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Past a word in any case at the beginning of the text; null if there is none.
const char* past_word(const char* at, const char* end, std::string_view word) {
  for (const char c : word) {
    if (at == end || lower(*at) != c) return nullptr;
    ++at;
  }
  return at;
}

/// Past "nan" and, if it is complete, "(letters, digits and underscores)".
const char* past_payload(const char* at, const char* end) {
  if (at == end || *at != '(') return at;
  for (const char* next = at + 1; next != end; ++next) {
    if (*next == ')') return next + 1;
    if (!is_digit(*next) && *next != '_' && !(lower(*next) >= 'a' && lower(*next) <= 'z')) break;
  }
  return at;
}

const char* past_digits(const char* at, const char* end) {
  while (at != end && is_digit(*at)) ++at;
  return at;
}

/// Past digits with at most one point; null if there is no digit.
const char* past_mantissa(const char* begin, const char* end) {
  const char* at = past_digits(begin, end);
  if (at == end || *at != '.') return at == begin ? nullptr : at;
  const char* const fraction = at + 1;
  const char* const last = past_digits(fraction, end);
  return at == begin && last == fraction ? nullptr : last;
}

const char* past_exponent(const char* begin, const char* end) {
  if (begin == end || lower(*begin) != 'e') return begin;
  const char* at = begin + 1;
  if (at != end && (*at == '+' || *at == '-')) ++at;
  const char* const last = past_digits(at, end);
  // mutant decimal-exponent: `last == at ? begin : last` -> `last`
  return last == at ? begin : last;
}

bool is_zero(std::string_view mantissa) {
  return mantissa.find_first_not_of("0.") == std::string_view::npos;
}

/// The double nearest to a number with a point, whatever the locale and the rounding mode of the thread are.
double rounded(const std::string& text) {
  static const locale_t c_locale = newlocale(LC_ALL_MASK, "C", nullptr);
  if (c_locale == nullptr) throw std::bad_alloc();
  const int mode = std::fegetround();
  // mutant decimal-rounding: `std::fesetround(FE_TONEAREST)` -> ``
  std::fesetround(FE_TONEAREST);
  const double result = strtod_l(text.c_str(), nullptr, c_locale);
  std::fesetround(mode);
  return result;
}

}  // namespace

std::from_chars_result read_decimal(const char* begin, const char* end, double& value) {
  const bool is_negative = begin != end && *begin == '-';
  const char* const first = begin + is_negative;
  if (const char* const last = past_word(first, end, "nan")) {
    value = is_negative ? -std::numeric_limits<double>::quiet_NaN() : std::numeric_limits<double>::quiet_NaN();
    return {past_payload(last, end), std::errc()};
  }
  if (const char* const last = past_word(first, end, "inf")) {
    value = is_negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
    const char* const longer = past_word(last, end, "inity");
    return {longer == nullptr ? last : longer, std::errc()};
  }
  const char* const mantissa_end = past_mantissa(first, end);
  if (mantissa_end == nullptr) return {begin, std::errc::invalid_argument};
  const char* const last = past_exponent(mantissa_end, end);
  const double number = rounded(std::string(first, last));
  // By bits: a thread that flushes denormal numbers compares them equal to 0.
  // mutant decimal-vanishing: `std::bit_cast<std::uint64_t>(number) == 0` -> `false`
  const bool vanishes =
      std::bit_cast<std::uint64_t>(number) == 0 && !is_zero({first, static_cast<std::size_t>(mantissa_end - first)});
  if (vanishes || std::isinf(number)) return {last, std::errc::result_out_of_range};
  value = is_negative ? -number : number;
  return {last, std::errc()};
}

}  // namespace morula::platform
