// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The class that stands for integers of 128 bits, against the compiler's.
#include "geometry/wide_integers.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <vector>

namespace morula {
using namespace detail;
namespace {

#ifdef __SIZEOF_INT128__

__extension__ typedef __int128 Builtin;
__extension__ typedef unsigned __int128 BuiltinUnsigned;

std::vector<std::int64_t> numbers() {
  std::vector<std::int64_t> all;
  for (int bit = 0; bit < 63; ++bit)
    for (const std::int64_t near : {-1, 0, 1}) {
      all.push_back((std::int64_t{1} << bit) + near);
      all.push_back(-all.back());
    }
  all.push_back(std::numeric_limits<std::int64_t>::max());
  all.push_back(std::numeric_limits<std::int64_t>::min());
  Random random(1);
  for (int i = 0; i < 60; ++i) {
    const std::uint64_t bits = random.next();
    all.push_back(static_cast<std::int64_t>(bits >> random.next() % 64));
  }
  return all;
}

void expect_same(const Words128& words, Builtin builtin) {
  EXPECT_EQ(static_cast<double>(words), static_cast<double>(builtin));
  // The low 53 bits and more: differences of what a double has lost.
  const Words128 rest = words - Words128(static_cast<std::int64_t>(builtin >> 64)) * Words128(std::int64_t{1} << 32) *
                                    Words128(std::int64_t{1} << 32);
  EXPECT_EQ(static_cast<double>(rest), static_cast<double>(static_cast<std::uint64_t>(builtin)));
  EXPECT_EQ(words > Words128(0), builtin > 0);
}

TEST(WideIntegers, products_and_sums_are_the_compilers) {
  const std::vector<std::int64_t> all = numbers();
  for (const std::int64_t a : all)
    for (const std::int64_t b : all) {
      const BuiltinUnsigned whole =
          static_cast<BuiltinUnsigned>(static_cast<std::uint64_t>(a)) * static_cast<std::uint64_t>(b);
      const Product128 halves = product_by_halves(static_cast<std::uint64_t>(a), static_cast<std::uint64_t>(b));
      ASSERT_EQ(halves.low, static_cast<std::uint64_t>(whole));
      ASSERT_EQ(halves.high, static_cast<std::uint64_t>(whole >> 64));
      expect_same(Words128(a) * Words128(b), static_cast<Builtin>(a) * b);
      expect_same(Words128(a) + Words128(b), static_cast<Builtin>(a) + b);
      expect_same(Words128(a) - Words128(b), static_cast<Builtin>(a) - b);
      EXPECT_EQ(Words128(a) > Words128(b), a > b);
      if (::testing::Test::HasFailure()) FAIL() << a << " and " << b;
    }
}

TEST(WideIntegers, sums_of_products_are_the_compilers) {
  const std::vector<std::int64_t> all = numbers();
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    Words128 sum = 0;
    Builtin expected = 0;
    for (int k = 0; k < 4; ++k) {
      // As in Delaunay: factors of 43 and 62 bits.
      const std::int64_t a = all[random.next() % all.size()] >> 21, b = all[random.next() % all.size()] >> 2;
      sum = k % 2 == 0 ? sum + Words128(a) * Words128(b) : sum - Words128(a) * Words128(b);
      expected = k % 2 == 0 ? expected + static_cast<Builtin>(a) * b : expected - static_cast<Builtin>(a) * b;
    }
    expect_same(sum, expected);
  }
}

#endif

}  // namespace
}  // namespace morula
