// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/vector.hpp>
#include <simd/float4.hpp>
#include <simd/processors.hpp>
#include <vector>

namespace morula {
using namespace detail;
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

// What lanes of both types are made of: ordinary numbers, and those that compilers and processors disagree about.
std::vector<float> specimens() {
  std::vector<float> all{0.0f,     -0.0f,     1.0f,        -1.0f,     0.1f,         1e-40f,      -1e-40f, 1e38f,
                         infinity, -infinity, 16777216.0f, 0x1p-126f, not_a_number, 123456.789f, 3.0f,    -7.5f};
  Random random(4);
  for (int i = 0; i < 64; ++i) all.push_back(static_cast<float>(random.uniform(-1000, 1000)));
  return all;
}

// The bits of lanes; all that is not a number is the same.
template <class Four>
std::vector<std::uint64_t> bits(const Four& four) {
  std::vector<std::uint64_t> all;
  for (int lane = 0; lane < 4; ++lane)
    all.push_back(four[lane] == four[lane] ? std::bit_cast<std::uint32_t>(four[lane]) : ~std::uint64_t{0});
  return all;
}
std::vector<std::uint64_t> bits_of_doubles(double a, double b) {
  std::vector<std::uint64_t> all;
  for (const double x : {a, b}) all.push_back(x == x ? std::bit_cast<std::uint64_t>(x) : ~std::uint64_t{0});
  return all;
}

// Every operation on four lanes of a and b, as lists of bits in one order.
template <class Four>
std::vector<std::vector<std::uint64_t>> every_operation(const float* four_a, const float* four_b) {
  const Four a = Four::load(four_a), b = Four::load(four_b);
  std::vector<std::vector<std::uint64_t>> all;
  for (const Four& f : {a + b, a - b, a * b, a / b, -a, min(a, b), max(a, b), min(b, a), max(b, a), sqrt(a)})
    all.push_back(bits(f));
  std::vector<std::uint64_t> masks;
  for (const float lane : (not_numbers(a) | not_numbers(b)).lanes())
    masks.push_back(std::bit_cast<std::uint32_t>(lane));
  all.push_back(masks);
  all.push_back(bits(Four::read_three(reinterpret_cast<const std::byte*>(four_a))));
  return all;
}

TEST(Float4, operations_agree_with_the_scalar_twin_bit_for_bit) {
  const std::vector<float> values = specimens();
  for (std::size_t i = 0; i + 4 <= values.size(); ++i)
    for (std::size_t j = 0; j + 4 <= values.size(); ++j)
      ASSERT_EQ(every_operation<Float4>(&values[i], &values[j]), every_operation<ScalarFloat4>(&values[i], &values[j]))
          << i << " " << j;
}

template <class Four>
void expect_the_meaning_of_every_operation() {
  const std::array<float, 4> four{4.0f, -2.25f, 0.5f, 9.0f};
  const Four a = Four::load(four.data()), two(2.0f);
  EXPECT_EQ((a + two).lanes(), (std::array{6.0f, -0.25f, 2.5f, 11.0f}));
  EXPECT_EQ((a - two).lanes(), (std::array{2.0f, -4.25f, -1.5f, 7.0f}));
  EXPECT_EQ((a * two).lanes(), (std::array{8.0f, -4.5f, 1.0f, 18.0f}));
  EXPECT_EQ((a / two).lanes(), (std::array{2.0f, -1.125f, 0.25f, 4.5f}));
  EXPECT_EQ((-a).lanes(), (std::array{-4.0f, 2.25f, -0.5f, -9.0f}));
  EXPECT_EQ(min(a, two).lanes(), (std::array{2.0f, -2.25f, 0.5f, 2.0f}));
  EXPECT_EQ(max(a, two).lanes(), (std::array{4.0f, 2.0f, 2.0f, 9.0f}));
  EXPECT_EQ(sqrt(a * a).lanes(), (std::array{4.0f, 2.25f, 0.5f, 9.0f}));
  EXPECT_EQ(largest_lane(a), 9.0f);
  EXPECT_EQ(Four::counting().lanes(), (std::array{0.0f, 1.0f, 2.0f, 3.0f}));
  EXPECT_EQ(Four(Vec3f{1, 2, 3}).lanes(), (std::array{1.0f, 2.0f, 3.0f, 0.0f}));
  EXPECT_EQ(Four{}.lanes(), (std::array{0.0f, 0.0f, 0.0f, 0.0f}));
  // The second where one is not a number, and where they are equal.
  const Four none(not_a_number), zero(0.0f), minus(-0.0f);
  EXPECT_EQ(min(none, two)[0], 2.0f);
  EXPECT_EQ(max(none, two)[0], 2.0f);
  EXPECT_TRUE(std::isnan(min(two, none)[0]));
  EXPECT_TRUE(std::isnan(max(two, none)[0]));
  EXPECT_TRUE(std::signbit(max(zero, minus)[0]));
  EXPECT_FALSE(std::signbit(min(minus, zero)[0]));
  EXPECT_EQ(std::bit_cast<std::uint32_t>(not_numbers(none)[3]), ~0u);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(not_numbers(Four(infinity))[3]), 0u);

  std::array<int, 4> whole{};
  EXPECT_EQ((a * Four(1.5f)).truncated(whole).lanes(), (std::array{6.0f, -3.0f, 0.0f, 13.0f}));
  EXPECT_EQ(whole, (std::array{6, -3, 0, 13}));
  LocalPoint point;
  a.store(point);
  EXPECT_EQ(Four::load(point).lanes(), four);

  Four rows[4];
  for (int row = 0; row < 4; ++row) rows[row] = Four(static_cast<float>(10 * row)) + Four::counting();
  Four x = rows[0], y = rows[1], z = rows[2];
  Four::transpose_points(x, y, z, rows[3]);
  Four::transpose(rows[0], rows[1], rows[2], rows[3]);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) EXPECT_EQ(rows[row][column], static_cast<float>(10 * column + row));
  EXPECT_EQ(x.lanes(), rows[0].lanes());
  EXPECT_EQ(y.lanes(), rows[1].lanes());
  EXPECT_EQ(z.lanes(), rows[2].lanes());
}

TEST(Float4, operations_mean_what_they_say) {
  expect_the_meaning_of_every_operation<Float4>();
  expect_the_meaning_of_every_operation<ScalarFloat4>();
}

template <class Two, class Four>
std::vector<std::vector<std::uint64_t>> every_operation_on_doubles(const double* two_a, const double* two_b) {
  const Two a = Two::load(two_a), b = Two::load(two_b);
  std::vector<std::vector<std::uint64_t>> all;
  for (const Two& two : {a + b, a - b, a * b, -a, min(a, b), max(a, b)}) {
    double stored[2];
    two.store(stored);
    all.push_back(bits_of_doubles(stored[0], stored[1]));
    all.push_back(bits_of_doubles(two[0], two[1]));
  }
  all.push_back(bits(Four::rounded(a, b)));
  return all;
}

TEST(Double2, operations_agree_with_the_scalar_twin_bit_for_bit) {
  std::vector<double> values;
  for (const float x : specimens()) values.push_back(static_cast<double>(x) * (1 + 0x1p-30));
  for (std::size_t i = 0; i + 2 <= values.size(); ++i)
    for (std::size_t j = 0; j + 2 <= values.size(); ++j)
      ASSERT_EQ((every_operation_on_doubles<Double2, Float4>(&values[i], &values[j])),
                (every_operation_on_doubles<ScalarDouble2, ScalarFloat4>(&values[i], &values[j])))
          << i << " " << j;
}

TEST(Double2, reads_numbers_of_any_alignment_and_rounds_to_the_nearest) {
  alignas(16) std::array<std::byte, 40> bytes{};
  const double doubles[2]{0.1, -3e5};
  const float floats[2]{0.1f, -3e5f};
  for (std::size_t at = 0; at < 16; ++at) {
    std::memcpy(&bytes[at], doubles, sizeof doubles);
    const Double2 read = Double2::read<double>(&bytes[at]);
    EXPECT_EQ(read[0], 0.1);
    EXPECT_EQ(read[1], -3e5);
    std::memcpy(&bytes[at], floats, sizeof floats);
    const Double2 widened = Double2::read<float>(&bytes[at]);
    EXPECT_EQ(widened[0], static_cast<double>(0.1f));
    EXPECT_EQ(widened[1], -3e5);
  }
  EXPECT_EQ(Float4::rounded(Double2(0.1, 1e300), Double2(-0.3)).lanes(), (std::array{0.1f, infinity, -0.3f, -0.3f}));
}

TEST(KernelTable, has_a_row_for_every_kind_and_hands_out_those_that_run) {
  struct Rows {
    std::size_t number;
  };
  KernelTable<Rows> table{};
  for (std::size_t kind = 0; kind < compiled_kinds; ++kind) table.of_kind[kind].number = kind;
  const std::size_t runnable = runnable_kinds();
  ASSERT_LE(runnable, compiled_kinds);
  for (std::size_t most = 1; most <= compiled_kinds; ++most) {
    allow_kinds(most);
    EXPECT_EQ(table.runnable().size(), std::min(most, runnable));
    EXPECT_EQ(table.widest().number + 1, std::min(most, runnable));
    EXPECT_EQ(table.runnable().front().number, 0u);
  }
  allow_kinds(compiled_kinds);
  EXPECT_EQ(runnable_kinds(), runnable);
  EXPECT_STREQ(kind_name(0), "plain loops");
}

}  // namespace
}  // namespace morula
