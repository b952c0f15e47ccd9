// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Decimal numbers read without the function of the standard library, judged by it and by texts whose numbers are known.
#include "platform/decimal.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cfenv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <vector>

#if defined(__SSE2__) && !defined(__APPLE__)
#include <xmmintrin.h>
#endif

// Windows has no other than that of the standard library.
#if !defined(_WIN32)

namespace morula::test {
namespace {

constexpr double untouched = 1234.5;

struct Read {
  double value = untouched;
  std::size_t length = 0;
  std::errc error{};
};

template <class Function>
Read read_by(Function function, const std::string& text) {
  // No zero follows the text.
  const std::vector<char> alone(text.begin(), text.end());
  Read read;
  const std::from_chars_result result = function(alone.data(), alone.data() + alone.size(), read.value);
  read.length = static_cast<std::size_t>(result.ptr - alone.data());
  read.error = result.ec;
  return read;
}

Read read(const std::string& text) {
  return read_by(platform::read_decimal, text);
}

void expect_same(const Read& found, const Read& expected, const std::string& text) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(found.value), std::bit_cast<std::uint64_t>(expected.value)) << text;
  EXPECT_EQ(found.length, expected.length) << text;
  EXPECT_EQ(found.error, expected.error) << text;
}

double random_double(std::mt19937_64& random) {
  for (;;) {
    const auto value = std::bit_cast<double>(random());
    if (std::isfinite(value)) return value;
  }
}

template <class... Format>
std::string written(double value, Format... format) {
  std::string text(2000, ' ');
  text.resize(static_cast<std::size_t>(std::to_chars(text.data(), text.data() + text.size(), value, format...).ptr -
                                       text.data()));
  return text;
}

#if MORULA_STANDARD_READS_DECIMALS
std::vector<std::string> odd_texts() {
  const std::string zeros(400, '0');
  std::vector<std::string> texts{"",
                                 "-",
                                 "+1",
                                 "+",
                                 ".",
                                 "-.",
                                 "e5",
                                 ".e5",
                                 " 1",
                                 "\n1",
                                 "1 ",
                                 "1,5",
                                 "0x10",
                                 "0x1p3",
                                 "1_000",
                                 "0",
                                 "-0",
                                 "0.0",
                                 "-0.0e9",
                                 "0e99999",
                                 "0e-99999",
                                 "00012",
                                 "1.",
                                 ".5",
                                 "-.5",
                                 "1.e2",
                                 ".5e1",
                                 "5.e",
                                 "1e",
                                 "1e+",
                                 "1e-",
                                 "1e+x",
                                 "1E5",
                                 "1e05",
                                 "1e+05",
                                 "1e-05",
                                 "1.2.3",
                                 "1e5.5",
                                 "1e5e5",
                                 "12abc",
                                 "1d5",
                                 "1f",
                                 "inf",
                                 "-inf",
                                 "INF",
                                 "Infinity",
                                 "-iNfInItY",
                                 "infinit",
                                 "infx",
                                 "in",
                                 "i",
                                 "+inf",
                                 "nan",
                                 "-nan",
                                 "NaN",
                                 "nan()",
                                 "nan(12_aZ)",
                                 "nan(",
                                 "nan(1",
                                 "nan(-)",
                                 "na",
                                 "nanx",
                                 "nan(a b)",
                                 "1e308",
                                 "1e309",
                                 "-1e309",
                                 "1.7976931348623157e308",
                                 "1.7976931348623158e308",
                                 "1.7976931348623159e308",
                                 "1e-307",
                                 "2.2250738585072011e-308",
                                 "2.2250738585072014e-308",
                                 "4.9e-324",
                                 "5e-324",
                                 "2.5e-324",
                                 "2.4e-324",
                                 "1e-324",
                                 "-1e-400",
                                 "1e99999999999999999999",
                                 "1e-99999999999999999999",
                                 "9007199254740993",
                                 "9007199254740992.9999999999999999999999",
                                 "9007199254740993.00000000000000000000000000001",
                                 "0." + zeros + "1e401",
                                 "1" + zeros + "e-400",
                                 "1" + zeros,
                                 "0." + zeros + "1"};
  return texts;
}

/// The number halfway between a double and the next one, in all its digits.
std::string halfway(double value) {
  const double next = std::nextafter(value, 2 * value);
  const long double middle = (static_cast<long double>(value) + static_cast<long double>(next)) / 2;
  std::string text(1200, ' ');
  text.resize(static_cast<std::size_t>(std::snprintf(text.data(), text.size(), "%.1100Lg", middle)));
  return text;
}

Read standard(const std::string& text) {
  Read read = read_by(
      [](const char* begin, const char* end, double& value) { return std::from_chars(begin, end, value); }, text);
  // The standard leaves the value of a number out of range as it is; libc++ 20 sets it to infinity or zero.
  if (read.error == std::errc::result_out_of_range) read.value = untouched;
  return read;
}

TEST(Decimal, is_read_as_by_the_standard_library) {
  for (const std::string& text : odd_texts()) expect_same(read(text), standard(text), text);
  std::mt19937_64 random(5);
  for (int i = 0; i < 20000; ++i) {
    const double value = random_double(random);
    for (const std::string& text : {written(value), written(value, std::chars_format::scientific, i % 30),
                                    written(value, std::chars_format::fixed)})
      expect_same(read(text), standard(text), text);
    // Coordinates of meshes.
    const double small = std::ldexp(static_cast<double>(random() >> 11), -50);
    for (const std::string& text : {written(small), written(small, std::chars_format::fixed, i % 20)})
      expect_same(read(text), standard(text), text);
  }
}

TEST(Decimal, texts_of_random_characters_are_read_as_by_the_standard_library) {
  std::mt19937_64 random(6);
  const std::string characters = "00123456789..eE+--infanty()_ x";
  for (int i = 0; i < 200000; ++i) {
    std::string text;
    for (std::uint64_t n = random() % 12; n > 0; --n) text += characters[random() % characters.size()];
    expect_same(read(text), standard(text), text);
  }
}

TEST(Decimal, halves_between_doubles_are_rounded_as_by_the_standard_library) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 5000; ++i) {
    const double value = std::abs(random_double(random));
    if (value > 1e300) continue;
    const std::string middle = halfway(value);
    const std::size_t mantissa_end = std::min(middle.find('e'), middle.size());
    const std::string above = middle.substr(0, mantissa_end) +
                              (middle.find('.') == std::string::npos ? ".0001" : "0001") + middle.substr(mantissa_end);
    for (const std::string& text : {middle, above}) expect_same(read(text), standard(text), text);
  }
}
#endif

TEST(Decimal, known_texts_have_their_numbers) {
  const double inf = std::numeric_limits<double>::infinity();
  const auto out = std::errc::result_out_of_range, wrong = std::errc::invalid_argument;
  expect_same(read("-12.5e1,"), {-125, 7, {}}, "the number before a comma");
  expect_same(read("0x10"), {0, 1, {}}, "no digits of base 16");
  expect_same(read("1e+"), {1, 1, {}}, "an exponent without digits");
  expect_same(read("-0"), {-0.0, 2, {}}, "a negative zero");
  expect_same(read("-Infinity"), {-inf, 9, {}}, "infinity");
  expect_same(read("9007199254740993"), {9007199254740992.0, 16, {}}, "a tie, to even");
  expect_same(read("9007199254740993.000000000000000000001"), {9007199254740994.0, 38, {}}, "above a tie");
  expect_same(read("4.9e-324"), {std::numeric_limits<double>::denorm_min(), 8, {}}, "the least");
  expect_same(read("-1e-400"), {untouched, 7, out}, "too small");
  expect_same(read("1e400x"), {untouched, 5, out}, "too large");
  for (const char* text : {"", "-", ".", "+1", " 1", "e5", "-.e5", "in"})
    expect_same(read(text), {untouched, 0, wrong}, text);
}

TEST(Decimal, shortest_digits_have_the_bits_they_came_from) {
  std::mt19937_64 random(8);
  for (int i = 0; i < 20000; ++i) {
    const double value = random_double(random);
    const std::string text = written(value);
    expect_same(read(text), {value, text.size(), {}}, text);
  }
}

// A thread's own rounding changes no number.
TEST(Decimal, is_rounded_to_nearest_in_every_mode) {
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    ASSERT_EQ(std::fesetround(mode), 0);
    const Read tenth = read("0.1"), third = read("-0.3333333333333333333333");
    const int now = std::fegetround();
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(now, mode);
    expect_same(tenth, {0.1, 3, {}}, "0.1");
    expect_same(third, {-1.0 / 3, 25, {}}, "a third");
  }
}

#if defined(__SSE2__) && !defined(__APPLE__)
// Nor does its flushing of denormal numbers, as of audio threads and programs built with -ffast-math.
TEST(Decimal, denormal_numbers_are_read_where_they_are_flushed) {
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040);
  const Read least = read("5e-324"), negative = read("-1e-310"), none = read("1e-400");
  _mm_setcsr(before);
  expect_same(least, {std::numeric_limits<double>::denorm_min(), 6, {}}, "the least");
  expect_same(negative, {-1e-310, 7, {}}, "a negative one");
  expect_same(none, {untouched, 6, std::errc::result_out_of_range}, "too small");
}
#endif

// The function that readers call takes integers, too.
TEST(Decimal, read_number_reads_integers_and_decimals) {
  const std::string text = "-42.5";
  std::int64_t whole = 0;
  EXPECT_EQ(platform::read_number(text.data(), text.data() + text.size(), whole).ptr, text.data() + 3);
  EXPECT_EQ(whole, -42);
  double decimal = 0;
  EXPECT_EQ(platform::read_number(text.data(), text.data() + text.size(), decimal).ptr, text.data() + 5);
  EXPECT_EQ(decimal, -42.5);
}

}  // namespace
}  // namespace morula::test

#endif
