// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/fit_kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

// Cells whose middle lies within `half` of `middle`: [begin, end). Positions are not far below zero, so truncation
// serves as floor; proposed balls may reach far beyond the grid.
struct Middles {
  int begin, end;
};

/// The reference that the other kernels reproduce.
namespace plain {

Middles middles_within(float middle, float half, int count) {
  const float lower = middle - half + 0.5F, upper = middle + half + 0.5F, last = static_cast<float>(count);
  return {lower > 0 ? static_cast<int>(std::min(last, lower)) : 0,
          upper > 0 ? static_cast<int>(std::min(last, upper)) : 0};
}

float outside(const GridLines& lines, const LineBall& ball) {
  std::array<float, 4> sums{};
  const float last_cell = static_cast<float>(lines.along - 1);
  const Middles rows = middles_within(ball.row, ball.radius, lines.rows);
  for (int v = rows.begin; v < rows.end; ++v) {
    const float dv = static_cast<float>(v) + 0.5F - ball.row;
    const float in_row = ball.radius * ball.radius - dv * dv;
    if (!(in_row > 0)) continue;
    const Middles row = middles_within(ball.across, std::sqrt(in_row), lines.across);
    // Lines come in fours; those past the end have no chord.
    const int end = row.begin + (row.end - row.begin + 3) / 4 * 4;
    for (int u = row.begin; u < end; ++u) {
      const GridStep* const line = lines.steps + (static_cast<std::size_t>(v) * static_cast<std::size_t>(lines.across) +
                                                  static_cast<std::size_t>(u)) *
                                                     static_cast<std::size_t>(lines.along);
      const float du = static_cast<float>(u) + 0.5F - ball.across;
      const float chord = std::sqrt(std::max(in_row - du * du, 0.0F));
      const auto up_to = [&](float w) {
        const float cell = std::trunc(std::min(std::max(w, 0.0F), last_cell));
        const GridStep& step = line[static_cast<int>(cell)];
        return std::min(step.before + step.slope * std::max(w - cell - step.start, 0.0F), step.after);
      };
      sums[static_cast<std::size_t>(u - row.begin) % 4] += up_to(ball.along + chord) - up_to(ball.along - chord);
    }
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

void make_steps(const OpenLines& lines, std::size_t begin, std::size_t end, float overlap_weight, bool go_on) {
  for (std::size_t k = 0; k < lines.count; ++k) {
    const OutsideCell* const cells = lines.cells + k * lines.along;
    const std::uint8_t* const over = lines.over + k * lines.over_across;
    GridStep* const steps = lines.steps + k * lines.along;
    float sum = go_on ? steps[begin - 1].after : 0;
    for (std::size_t w = begin; w < end; ++w) {
      const OutsideCell& cell = cells[w];
      const float counts = over[w * lines.over_along] != 0 ? overlap_weight : 1.0F, after = sum + cell.total * counts;
      steps[w] = {sum, cell.start, cell.slope * counts, after};
      sum = after;
    }
  }
}

void offer_to(const PointColumns& points, std::size_t i, const Vec3f& center, float square, std::uint32_t number,
              const PowerOwners& owners) {
  const float dx = points.x[i] - center.x, dy = points.y[i] - center.y, dz = points.z[i] - center.z;
  const float power = dx * dx + dy * dy + dz * dz - square;
  if (!(power < owners.power[i] || (power == owners.power[i] && number < owners.owner[i]))) return;
  owners.power[i] = power;
  owners.owner[i] = number;
}

void offer(const PointColumns& points, const Vec3f& center, float square, std::uint32_t number,
           const PowerOwners& owners) {
  for (std::size_t i = 0; i < points.count; ++i) offer_to(points, i, center, square, number, owners);
}

template <class Number>
void numbers_at_most(const Number* numbers, std::size_t count, Number limit, std::uint64_t* bits) {
  for (std::size_t word = 0; 64 * word < count; ++word) bits[word] = 0;
  for (std::size_t i = 0; i < count; ++i) bits[i / 64] |= static_cast<std::uint64_t>(numbers[i] <= limit) << (i % 64);
}

void at_most(const float* numbers, std::size_t count, float limit, std::uint64_t* bits) {
  numbers_at_most(numbers, count, limit, bits);
}

void at_most_in_double(const double* numbers, std::size_t count, double limit, std::uint64_t* bits) {
  numbers_at_most(numbers, count, limit, bits);
}

void squared_distances_in_double(const DoublePointColumns& points, const Vec3& center, double* squares) {
  for (std::size_t i = 0; i < points.count; ++i)
    squares[i] = squared_distance(Vec3{points.x[i], points.y[i], points.z[i]}, center);
}

double exit_of(const DoublePointColumns& points, const DoublePointColumns& directions, std::size_t i,
               const Sphere& ball) {
  const Vec3 offset = Vec3{points.x[i], points.y[i], points.z[i]} - ball.center;
  const double along = dot(offset, Vec3{directions.x[i], directions.y[i], directions.z[i]});
  const double inside = ball.radius * ball.radius - (squared_length(offset) - along * along);
  return inside >= 0 ? std::sqrt(inside) - along : 0;
}

double farthest_exit(const DoublePointColumns& points, const DoublePointColumns& directions, const Sphere& ball) {
  double most = 0;
  for (std::size_t i = 0; i < points.count; ++i) most = std::max(most, exit_of(points, directions, i, ball));
  return most;
}

void cell_numbers(const DoublePointColumns& points, const LatticeCells& cells, std::int32_t* numbers) {
  for (std::size_t i = 0; i < points.count; ++i) {
    const auto x = static_cast<std::int32_t>((points.x[i] - cells.origin.x) * cells.per_edge.x);
    const auto y = static_cast<std::int32_t>((points.y[i] - cells.origin.y) * cells.per_edge.y);
    const auto z = static_cast<std::int32_t>((points.z[i] - cells.origin.z) * cells.per_edge.z);
    numbers[i] = (x * cells.count[1] + y) * cells.count[2] + z;
  }
}

void equal(const std::uint8_t* bytes, std::size_t count, std::uint8_t wanted, std::uint64_t* bits) {
  for (std::size_t word = 0; 64 * word < count; ++word) bits[word] = 0;
  for (std::size_t i = 0; i < count; ++i) bits[i / 64] |= static_cast<std::uint64_t>(bytes[i] == wanted) << (i % 64);
}

void with_less_power(const BallColumns& balls, const double (*corners)[4], std::size_t count, std::uint64_t* bits) {
  for (std::size_t word = 0; 64 * word < balls.count; ++word) bits[word] = 0;
  for (std::size_t i = 0; i < balls.count; ++i)
    for (std::size_t c = 0; c < count; ++c) {
      const double dx = balls.x[i] - corners[c][0], dy = balls.y[i] - corners[c][1], dz = balls.z[i] - corners[c][2];
      const bool less = dx * dx + dy * dy + dz * dz - balls.square[i] < corners[c][3];
      bits[i / 64] |= static_cast<std::uint64_t>(less) << (i % 64);
    }
}

constexpr FitKernels kernels{
    outside,       make_steps,   offer, at_most,        at_most_in_double, squared_distances_in_double,
    farthest_exit, cell_numbers, equal, with_less_power};

}  // namespace plain

#define MORULA_KERNELS "generators/fit/fit_kernels.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<FitKernels> table{MORULA_EVERY_KIND(kernels)};

}  // namespace

std::span<const FitKernels> all_fit_kernels() {
  return table.runnable();
}

const FitKernels& fit_kernels() {
  return table.widest();
}

}  // namespace morula::detail
