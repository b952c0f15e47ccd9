// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// std::from_chars, also for numbers with a point where the C++ library has it for integers alone: libc++ before version
// 20, and those of macOS that are as old.
#pragma once

#include <charconv>
#include <type_traits>

// libc++ 20 and later say whether the system for which is compiled has the function.
#if !defined(_LIBCPP_VERSION)
#define MORULA_STANDARD_READS_DECIMALS 1
#elif defined(_LIBCPP_AVAILABILITY_HAS_FROM_CHARS_FLOATING_POINT)
#define MORULA_STANDARD_READS_DECIMALS _LIBCPP_AVAILABILITY_HAS_FROM_CHARS_FLOATING_POINT
#else
#define MORULA_STANDARD_READS_DECIMALS 0
#endif

namespace morula::platform {

#if !defined(_WIN32)
/// std::from_chars for a double, by strtod_l: the same number, length and error in every locale and rounding mode. It
/// copies the digits. Not on Windows, whose libraries all have the function.
std::from_chars_result read_decimal(const char* begin, const char* end, double& value);
#endif

/// std::from_chars: the number at the beginning of [begin, end), in every locale.
template <class Number>
std::from_chars_result read_number(const char* begin, const char* end, Number& value) {
  if constexpr (std::is_integral_v<Number> || MORULA_STANDARD_READS_DECIMALS)
    return std::from_chars(begin, end, value);
  else
    return read_decimal(begin, end, value);
}

}  // namespace morula::platform
