// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The loops of a fit: every kind of kernels gives the same bits, and what it is to compute.
#include "generators/fit/fit_kernels.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <vector>

namespace morula {
using namespace detail;
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

float uniform(Random& random, double least, double most) {
  return static_cast<float>(random.uniform(least, most));
}
std::size_t below(Random& random, std::size_t end) {
  return std::min(end - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(end)));
}

// Lines with empty space at random places of their cells: from where it starts, `slope` a cell.
struct Lines {
  int along, across, rows;
  std::vector<OutsideCell> cells;
  std::vector<std::uint8_t> over;
  std::vector<GridStep> steps;
  static constexpr float overlap_weight = 0.15F;

  Lines(int n, int nu, int nv, std::uint64_t seed) : along(n), across(nu), rows(nv) {
    Random random(seed);
    const std::size_t count = static_cast<std::size_t>(n) * static_cast<std::size_t>(nu) * static_cast<std::size_t>(nv);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t kind = below(random, 3);
      if (kind == 0) cells.push_back({0, 0, 0});
      if (kind == 1) cells.push_back({0, 0.3F, 0.3F});
      if (kind == 2) {
        const float start = uniform(random, 0, 0.9), slope = uniform(random, 0.1, 1);
        cells.push_back({start, slope, slope * uniform(random, 0, 1 - start)});
      }
      over.push_back(static_cast<std::uint8_t>(below(random, 4) == 0 ? 1 + below(random, 255) : 0));
    }
    cells.push_back({0, 0, 0});
    steps.resize(count + 4 * static_cast<std::size_t>(n));
    const auto cells_along = static_cast<std::size_t>(n);
    all_fit_kernels().front().make_steps(
        {cells.data(), cells_along, over.data(), cells_along, 1, steps.data(), count / cells_along}, 0, cells_along,
        overlap_weight, false);
  }
  GridLines lines() const { return {steps.data(), along, across, rows}; }

  // Empty space of a line between two places, in double, cell by cell.
  double between(int u, int v, double from, double to) const {
    double sum = 0;
    for (int w = 0; w < along; ++w) {
      const std::size_t cell = static_cast<std::size_t>((v * across + u) * along + w);
      const auto up_to = [&](double x) {
        const double in_cell = std::clamp(x - w, 0.0, 1.0) - static_cast<double>(cells[cell].start);
        return std::min(static_cast<double>(cells[cell].slope) * std::max(in_cell, 0.0),
                        static_cast<double>(cells[cell].total));
      };
      sum += (up_to(to) - up_to(from)) * (over[cell] != 0 ? static_cast<double>(overlap_weight) : 1.0);
    }
    return sum;
  }
  double outside(const LineBall& b) const {
    double sum = 0;
    const double x = static_cast<double>(b.along), y = static_cast<double>(b.across), z = static_cast<double>(b.row),
                 r = static_cast<double>(b.radius);
    for (int v = 0; v < rows; ++v)
      for (int u = 0; u < across; ++u) {
        const double square = r * r - (u + 0.5 - y) * (u + 0.5 - y) - (v + 0.5 - z) * (v + 0.5 - z);
        if (square > 0) sum += between(u, v, x - std::sqrt(square), x + std::sqrt(square));
      }
    return sum;
  }
};

TEST(FitKernels, outside_is_the_empty_space_on_all_lines_with_the_same_bits) {
  Random random(3);
  const auto check = [](const Lines& grid, const LineBall& ball) {
    const float first = all_fit_kernels().front().outside(grid.lines(), ball);
    const double exact = grid.outside(ball);
    EXPECT_NEAR(static_cast<double>(first), exact, 1e-3 + 2e-4 * exact) << "radius " << ball.radius;
    for (const FitKernels& kernels : all_fit_kernels())
      ASSERT_EQ(std::bit_cast<std::uint32_t>(kernels.outside(grid.lines(), ball)), std::bit_cast<std::uint32_t>(first))
          << "kind " << &kernels - all_fit_kernels().data() << ", radius " << ball.radius;
  };
  for (int round = 0; round < 60; ++round) {
    const auto size = [&] { return 3 + static_cast<int>(below(random, 40)); };
    const Lines grid(size(), size(), size(), random.next());
    for (int i = 0; i < 20; ++i) {
      const double most = 0.5 * std::min({grid.along, grid.across, grid.rows});
      const float r = uniform(random, 0.01, most);
      const double room = static_cast<double>(r);
      check(grid, {uniform(random, room, grid.along - room), uniform(random, room, grid.across - room),
                   uniform(random, room, grid.rows - room), r});
      // At the middles and borders of cells, where distances are multiples of a half.
      const float half = std::round(2 * r) / 2;
      if (half > 0 && 2 * half <= 2 * most) check(grid, {half, half, half, half});
    }
  }
  // So large that its lines do not fit the list of those that are looked at together.
  const Lines wide(70, 150, 150, 5);
  for (const float r : {20.0F, 34.5F}) check(wide, {35.1F, 70.3F, 80.7F, r});
  const Lines flat(5, 300, 5, 6);
  check(flat, {2.5F, 150, 2.5F, 2.5F});
}

TEST(FitKernels, steps_are_the_sums_of_the_cells_before) {
  Random random(4);
  for (std::size_t count = 1; count < 40; ++count) {
    const std::size_t n = 3 + below(random, 30);
    const Lines source(static_cast<int>(n), static_cast<int>(count), 1, random.next());
    const std::size_t begin = below(random, n), end = begin + 1 + below(random, n - begin);
    // What balls have lies along lines or across them, with something between.
    const std::size_t apart = 1 + below(random, 3), over_along = count % 2 == 0 ? apart : apart * count,
                      over_across = count % 2 == 0 ? apart * n : apart;
    std::vector<std::uint8_t> over(apart * n * count);
    for (std::uint8_t& o : over) o = static_cast<std::uint8_t>(below(random, 3) == 0 ? 1 + below(random, 255) : 0);
    constexpr GridStep untouched{-7, -7, -7, -7};
    for (const FitKernels& kernels : all_fit_kernels()) {
      std::vector<GridStep> steps(n * count, untouched);
      const OpenLines open{source.cells.data(), n, over.data(), over_across, over_along, steps.data(), count};
      // At once, or some cells after the others.
      const std::size_t middle = begin + below(random, end - begin);
      if (middle > begin) kernels.make_steps(open, begin, middle, 0.6F, false);
      kernels.make_steps(open, middle, end, 0.6F, middle > begin);
      for (std::size_t line = 0; line < count; ++line) {
        float sum = 0;
        for (std::size_t w = 0; w < n; ++w) {
          const GridStep& step = steps[line * n + w];
          if (w < begin || w >= end) {
            EXPECT_EQ(step.before, untouched.before);
            continue;
          }
          const OutsideCell& cell = source.cells[line * n + w];
          const float counts = over[line * over_across + w * over_along] != 0 ? 0.6F : 1.0F;
          EXPECT_EQ(step.before, sum);
          sum += cell.total * counts;
          EXPECT_EQ(step.start, cell.start);
          EXPECT_EQ(step.slope, cell.slope * counts);
          EXPECT_EQ(step.after, sum);
        }
      }
    }
  }
}

TEST(FitKernels, points_go_to_the_ball_of_least_power_and_lowest_number) {
  Random random(5);
  for (const std::size_t count : {1, 2, 3, 4, 5, 8, 9, 15, 16, 17, 40, 100, 1030}) {
    // On a few places, so that powers are equal.
    std::vector<float> x, y, z;
    for (std::size_t i = 0; i < count; ++i)
      for (std::vector<float>* column : {&x, &y, &z}) column->push_back(std::round(uniform(random, -3, 3)));
    const PointColumns points{x.data(), y.data(), z.data(), count};
    struct Ball {
      Vec3f center;
      float square;
    };
    std::vector<Ball> balls;
    std::vector<std::uint32_t> order;
    for (std::uint32_t b = 0; b < 12; ++b) {
      const auto place = [&] { return std::round(uniform(random, -3, 3)); };
      const float px = place(), py = place(), pz = place();
      balls.push_back({{px, py, pz}, std::round(uniform(random, 0, 4))});
      order.insert(order.begin() + static_cast<std::ptrdiff_t>(below(random, order.size() + 1)), b);
    }
    for (const FitKernels& kernels : all_fit_kernels()) {
      std::vector<float> power(count, infinity);
      std::vector<std::uint32_t> owner(count, 0);
      for (const std::uint32_t b : order)
        kernels.offer(points, balls[b].center, balls[b].square, b, {power.data(), owner.data()});
      for (std::size_t i = 0; i < count; ++i) {
        const auto power_of = [&](const Ball& b) {
          return squared_length(Vec3f{x[i], y[i], z[i]} - b.center) - b.square;
        };
        std::uint32_t best = 0;
        for (std::uint32_t b = 1; b < balls.size(); ++b)
          if (power_of(balls[b]) < power_of(balls[best])) best = b;
        ASSERT_EQ(owner[i], best) << count << " points, kind " << &kernels - all_fit_kernels().data();
        ASSERT_EQ(power[i], power_of(balls[best]));
      }
    }
  }
}

TEST(FitKernels, numbers_at_most_a_limit_are_bits) {
  Random random(6);
  for (const std::size_t count : {1, 3, 4, 15, 16, 63, 64, 65, 100, 128, 301})
    for (const FitKernels& kernels : all_fit_kernels()) {
      std::vector<float> numbers;
      for (std::size_t i = 0; i < count; ++i) numbers.push_back(std::round(uniform(random, -4, 4)));
      std::vector<std::uint64_t> bits((count + 63) / 64, ~std::uint64_t{0});
      kernels.at_most(numbers.data(), count, 1, bits.data());
      for (std::size_t i = 0; i < 64 * bits.size(); ++i)
        ASSERT_EQ(bits[i / 64] >> (i % 64) & 1u, i < count && numbers[i] <= 1 ? 1u : 0u) << i << " of " << count;
      // The next double is another number.
      std::vector<double> in_double(numbers.begin(), numbers.end());
      for (std::size_t i = 0; i < count; i += 3) in_double[i] = std::nextafter(1.0, i % 2 == 0 ? 0.0 : 2.0);
      kernels.at_most_in_double(in_double.data(), count, 1, bits.data());
      for (std::size_t i = 0; i < 64 * bits.size(); ++i)
        ASSERT_EQ(bits[i / 64] >> (i % 64) & 1u, i < count && in_double[i] <= 1 ? 1u : 0u) << i << " of " << count;
    }
}

TEST(FitKernels, squared_distances_are_those_of_vectors) {
  Random random(7);
  for (const std::size_t count : {1, 2, 3, 7, 8, 9, 31, 100})
    for (const FitKernels& kernels : all_fit_kernels()) {
      const Vec3 center{uniform(random, -4, 4), uniform(random, -4, 4), uniform(random, -4, 4)};
      std::vector<double> x, y, z, squares(count + 1, -1);
      for (std::size_t i = 0; i < count; ++i) {
        x.push_back(random.uniform(-4, 4));
        y.push_back(random.uniform(-4, 4));
        z.push_back(random.uniform(-4, 4));
      }
      kernels.squared_distances_in_double({x.data(), y.data(), z.data(), count}, center, squares.data());
      for (std::size_t i = 0; i < count; ++i)
        ASSERT_EQ(squares[i], squared_distance(Vec3{x[i], y[i], z[i]}, center)) << i << " of " << count;
      EXPECT_EQ(squares[count], -1);
    }
}

// Where a point that goes along its normal leaves a ball: halving the way there and back, by distances alone.
TEST(FitKernels, farthest_exits_are_where_distances_say) {
  Random random(9);
  for (int repeat = 0; repeat < 20; ++repeat)
    for (const std::size_t count : {1, 2, 3, 7, 8, 9, 31, 100}) {
      const Sphere ball{{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}, 2};
      std::vector<double> x, y, z, nx, ny, nz;
      double expected = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const auto direction = [&] {
          return normalized(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
        };
        // Every third on the ball, a bit outside of which rounding may put it.
        const Vec3 point = ball.center + direction() * (i % 3 == 0 ? ball.radius : random.uniform(0, ball.radius));
        const Vec3 normal = direction();
        x.push_back(point.x), y.push_back(point.y), z.push_back(point.z);
        nx.push_back(normal.x), ny.push_back(normal.y), nz.push_back(normal.z);
        double inside = 0, outside = 10;
        for (int step = 0; step < 60; ++step) {
          const double middle = 0.5 * (inside + outside);
          (distance(point + normal * middle, ball.center) < ball.radius ? inside : outside) = middle;
        }
        expected = std::max(expected, inside);
      }
      const DoublePointColumns points{x.data(), y.data(), z.data(), count},
          normals{nx.data(), ny.data(), nz.data(), count};
      const double first = all_fit_kernels()[0].farthest_exit(points, normals, ball);
      EXPECT_NEAR(first, expected, 1e-12) << count;
      for (const FitKernels& kernels : all_fit_kernels())
        EXPECT_EQ(kernels.farthest_exit(points, normals, ball), first) << count;
    }
}

TEST(FitKernels, cells_have_the_points_between_their_faces) {
  Random random(10);
  const LatticeCells cells{{-4.5, -5, -4}, {1 / 0.75, 0, 1 / 1.25}, {12, 1, 7}};
  for (const std::size_t count : {1, 2, 3, 7, 8, 9, 31, 64})
    for (const FitKernels& kernels : all_fit_kernels()) {
      std::vector<double> x, y, z;
      for (std::size_t i = 0; i < count; ++i) {
        x.push_back(-4.5 + 0.125 * static_cast<double>(below(random, 72)));  // on faces as well
        y.push_back(random.uniform(-4, 4));
        z.push_back(random.uniform(-4, 4));
      }
      std::vector<std::int32_t> numbers(count + 1, -1);
      kernels.cell_numbers({x.data(), y.data(), z.data(), count}, cells, numbers.data());
      for (std::size_t i = 0; i < count; ++i) {
        const int along_x = numbers[i] / 7, along_z = numbers[i] % 7;
        ASSERT_TRUE(-4.5 + 0.75 * along_x <= x[i] && x[i] < -4.5 + 0.75 * (along_x + 1)) << i << " of " << count;
        ASSERT_TRUE(-4 + 1.25 * along_z <= z[i] && z[i] < -4 + 1.25 * (along_z + 1)) << i << " of " << count;
      }
      EXPECT_EQ(numbers[count], -1);
    }
}

TEST(FitKernels, bytes_equal_to_one_are_bits) {
  Random random(8);
  for (const std::size_t count : {1, 7, 63, 64, 65, 128, 200, 333})
    for (const FitKernels& kernels : all_fit_kernels())
      for (const std::size_t wanted : {0, 1, 127, 128, 255}) {
        std::vector<std::uint8_t> bytes;
        for (std::size_t i = 0; i < count; ++i)
          bytes.push_back(static_cast<std::uint8_t>(below(random, 2) == 0 ? wanted : below(random, 256)));
        std::vector<std::uint64_t> bits((count + 63) / 64, ~std::uint64_t{0});
        kernels.equal(bytes.data(), count, static_cast<std::uint8_t>(wanted), bits.data());
        for (std::size_t i = 0; i < 64 * bits.size(); ++i)
          ASSERT_EQ(bits[i / 64] >> (i % 64) & 1u, i < count && bytes[i] == wanted ? 1u : 0u) << i << " of " << count;
      }
}

TEST(FitKernels, balls_with_less_power_at_a_corner_are_bits) {
  Random random(7);
  for (const std::size_t count : {8, 16, 64, 72, 136})
    for (const std::size_t corners : {1, 3, 7}) {
      std::vector<double> x, y, z, square;
      for (std::size_t i = 0; i < count; ++i) {
        for (std::vector<double>* column : {&x, &y, &z}) column->push_back(std::round(random.uniform(-3, 3)));
        square.push_back(i % 5 == 4 ? -std::numeric_limits<double>::infinity() : std::round(random.uniform(0, 5)));
      }
      std::vector<std::array<double, 4>> at(corners);
      for (std::array<double, 4>& c : at)
        for (double& number : c) number = std::round(random.uniform(-3, 3));
      for (const FitKernels& kernels : all_fit_kernels()) {
        std::vector<std::uint64_t> bits((count + 63) / 64, ~std::uint64_t{0});
        kernels.with_less_power({x.data(), y.data(), z.data(), square.data(), count},
                                reinterpret_cast<const double(*)[4]>(at.data()), corners, bits.data());
        for (std::size_t i = 0; i < 64 * bits.size(); ++i) {
          bool less = false;
          if (i < count)
            for (const auto& [cx, cy, cz, power] : at)
              less = less || squared_length(Vec3{x[i], y[i], z[i]} - Vec3{cx, cy, cz}) - square[i] < power;
          ASSERT_EQ(bits[i / 64] >> (i % 64) & 1u, less ? 1u : 0u) << i << " of " << count;
        }
      }
    }
}

}  // namespace
}  // namespace morula
