// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include "generators/fit/fit_kernels.hpp"
#include "generators/fit/greedy_rows.hpp"
#include "geometry/each_bit.hpp"

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

namespace {

constexpr std::size_t most_cells = 256;

/// Numbers of cells that were found, by their keys, in the order in which they were.
class FoundCells {
 public:
  /// most: beyond `few` a table finds them, at most half full.
  explicit FoundCells(std::size_t most) {
    if (most > few) table_.fill(0);
    hashes_ = most > few;
  }
  std::size_t count() const { return count_; }
  std::uint64_t key(std::size_t i) const { return keys_[i]; }

  /// The number of a cell, or count() if it is new: then add() makes it this.
  std::size_t find(std::uint64_t key) {
    if (!hashes_) {
      std::size_t i = 0;
      while (i < count_ && keys_[i] != key) ++i;
      return i;
    }
    place_ = static_cast<std::size_t>(key * 0x9e3779b97f4a7c15u >> (64 - table_bits));
    for (; table_[place_] != 0; place_ = (place_ + 1) % table_.size())
      if (keys_[table_[place_] - 1u] == key) return table_[place_] - 1u;
    return count_;
  }
  void add(std::uint64_t key) {
    keys_[count_++] = key;
    if (hashes_) table_[place_] = static_cast<std::uint16_t>(count_);
  }

 private:
  static constexpr std::size_t few = 16;
  static constexpr int table_bits = 9;
  static_assert(std::size_t{1} << table_bits >= 2 * most_cells);

  std::array<std::uint64_t, most_cells> keys_;
  std::array<std::uint16_t, std::size_t{1} << table_bits> table_;  // numbers plus one; 0: free
  bool hashes_ = false;
  std::size_t count_ = 0, place_ = 0;
};

}  // namespace

bool occupied_cells(const Lattice& lattice, std::span<const Vec3> points, std::size_t most,
                    std::vector<Vec3>& centers) {
  // No point lies before the origin, so truncation is the floor.
  constexpr double cells_per_axis = 1 << 20;
  most = std::min(most, most_cells);
  // Along an axis without extent all points are in one cell; 0 × ∞ would be none.
  const auto per = [](double edge) { return edge > std::numeric_limits<double>::min() ? 1 / edge : 0; };
  const Vec3 per_edge{per(lattice.edge.x), per(lattice.edge.y), per(lattice.edge.z)};
  FoundCells found(most);
  std::uint64_t recent = ~std::uint64_t{0};  // no cell's
  for (const Vec3& p : points) {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::clamp((p[axis] - lattice.origin[axis]) * per_edge[axis], 0.0, cells_per_axis - 1);
      key = key << 20 | static_cast<std::uint32_t>(cell);
    }
    if (key == std::exchange(recent, key) || found.find(key) != found.count()) continue;
    if (found.count() == most) return false;
    found.add(key);
  }
  centers.clear();
  for (std::size_t i = 0; i < found.count(); ++i) {
    const std::uint64_t key = found.key(i);
    const Vec3 cell{static_cast<double>(key >> 40), static_cast<double>(key >> 20 & 0xfffff),
                    static_cast<double>(key & 0xfffff)};
    Vec3 center;
    for (int axis = 0; axis < 3; ++axis) center[axis] = lattice.origin[axis] + (cell[axis] + 0.5) * lattice.edge[axis];
    centers.push_back(center);
  }
  return true;
}

std::vector<std::uint32_t> greedy_cover(std::span<const Vec3> centers, double radius, std::span<const Vec3> points,
                                        std::size_t most) {
  const std::size_t words = (points.size() + 63) / 64;
  std::vector<std::uint64_t> contained(words * centers.size());
  const double squared_radius = radius * radius * (1 + 1e-12);
  std::vector<double> squares(points.size());
  for (std::size_t c = 0; c < centers.size(); ++c) {
    for (std::size_t i = 0; i < points.size(); ++i) squares[i] = squared_distance(centers[c], points[i]);
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
