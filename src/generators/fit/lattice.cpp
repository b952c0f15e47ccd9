// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "generators/fit/fit_kernels.hpp"
#include "generators/fit/greedy_rows.hpp"

namespace morula::detail {

Axes principal_axes(std::span<const Vec3> points) {
  Vec3 mean{};
  for (const Vec3& p : points) mean += p;
  mean = mean / static_cast<double>(std::max<std::size_t>(1, points.size()));
  double m[3][3]{};
  for (const Vec3& p : points) {
    const Vec3 d = p - mean;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m[i][j] += d[i] * d[j];
  }
  // Jacobi rotations: a 3 × 3 symmetric matrix is diagonal to rounding after a few sweeps.
  Axes axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  constexpr int sweeps = 12;
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (m[p][q] == 0) continue;
        const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const double t = (theta >= 0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 3; ++k) {
          const double kp = m[k][p], kq = m[k][q];
          m[k][p] = c * kp - s * kq;
          m[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < 3; ++k) {
          const double pk = m[p][k], qk = m[q][k];
          m[p][k] = c * pk - s * qk;
          m[q][k] = s * pk + c * qk;
        }
        const Vec3 ap = axes[p], aq = axes[q];
        axes[p] = ap * c - aq * s;
        axes[q] = ap * s + aq * c;
      }
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return m[a][a] > m[b][b]; });
  return {normalized(axes[order[0]]), normalized(axes[order[1]]), normalized(axes[order[2]])};
}

Axes turned_by_45_degrees(const Axes& axes, int axis) {
  const Vec3 a = axes[(axis + 1) % 3], b = axes[(axis + 2) % 3];
  constexpr double half_root = 0.5 * std::numbers::sqrt2;
  Axes turned = axes;
  turned[(axis + 1) % 3] = (a + b) * half_root;
  turned[(axis + 2) % 3] = (b - a) * half_root;
  return turned;
}

std::vector<Vec3> in_axes(const Axes& axes, std::span<const Vec3> points) {
  std::vector<Vec3> local;
  local.reserve(points.size());
  for (const Vec3& p : points) local.push_back({dot(p, axes[0]), dot(p, axes[1]), dot(p, axes[2])});
  return local;
}

Vec3 out_of_axes(const Axes& axes, const Vec3& local) {
  return axes[0] * local.x + axes[1] * local.y + axes[2] * local.z;
}

LatticePoints::LatticePoints(std::span<const Vec3> points) {
  for (const Vec3& p : points) x_.push_back(p.x), y_.push_back(p.y), z_.push_back(p.z), box_.add(p);
}

bool LatticePoints::occupied_cells(const Lattice& lattice, std::size_t most, std::vector<Vec3>& centers) const {
  // No point has a coordinate below the origin's, so truncation is the floor. Along an axis without extent all points
  // are in one cell; 0 × ∞ would be none.
  const auto per = [](double edge) { return edge > std::numeric_limits<double>::min() ? 1 / edge : 0; };
  LatticeCells cells{lattice.origin, {per(lattice.edge.x), per(lattice.edge.y), per(lattice.edge.z)}, {}};
  // Roundings keep the order of numbers: no point is beyond the cell of the upper corner.
  for (int axis = 0; axis < 3; ++axis)
    cells.count[static_cast<std::size_t>(axis)] =
        1 + static_cast<std::int32_t>((box_.upper[axis] - lattice.origin[axis]) * cells.per_edge[axis]);
  const auto [nx, ny, nz] = cells.count;
  std::vector<std::uint64_t> met(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny * nz) / 64 + 1);
  constexpr std::size_t some = 64;
  std::array<std::int32_t, some> numbers;
  centers.clear();
  for (std::size_t first = 0; first < x_.size(); first += some) {
    const std::size_t count = std::min(some, x_.size() - first);
    fit_kernels().cell_numbers(from(first, count), cells, numbers.data());
    for (std::size_t i = 0; i < count; ++i) {
      const std::int32_t number = numbers[i];
      std::uint64_t& word = met[static_cast<std::size_t>(number) / 64];
      const std::uint64_t bit = std::uint64_t{1} << (number % 64);
      if ((word & bit) != 0) continue;
      if (centers.size() == most) return false;
      word |= bit;
      const std::array<std::int32_t, 3> cell{number / nz / ny, number / nz % ny, number % nz};
      Vec3 center;
      for (int axis = 0; axis < 3; ++axis)
        center[axis] = lattice.origin[axis] + (cell[static_cast<std::size_t>(axis)] + 0.5) * lattice.edge[axis];
      centers.push_back(center);
    }
  }
  return true;
}

std::vector<std::uint32_t> LatticePoints::greedy_cover(std::span<const Vec3> centers, double radius,
                                                       std::size_t most) const {
  const std::size_t words = (x_.size() + 63) / 64;
  std::vector<std::uint64_t> contained(words * centers.size());
  const double squared_radius = radius * radius * (1 + 1e-12);
  std::vector<double> squares(x_.size());
  for (std::size_t c = 0; c < centers.size(); ++c) {
    fit_kernels().squared_distances_in_double(from(0, x_.size()), centers[c], squares.data());
    fit_kernels().at_most_in_double(squares.data(), squares.size(), squared_radius, &contained[c * words]);
  }
  GreedyRows rows(contained, words);
  std::vector<std::uint32_t> chosen;
  while (chosen.size() <= most) {
    const GreedyRows::Choice best = rows.choose();
    if (best.new_bits == 0) break;
    chosen.push_back(best.row);
  }
  return chosen;
}

}  // namespace morula::detail
