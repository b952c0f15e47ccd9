// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/accuracy/measure.hpp>
#include <vector>

#include "accuracy/usable_spheres.hpp"
#include "parallel/interruption.hpp"

namespace morula {

namespace {

struct Interval {
  double lower, upper;
  bool operator<(const Interval& other) const { return lower < other.lower; }
};

struct Moments {
  double volume = 0;
  Vec3 first{};
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  /// Adds a square column of side `edge` about (x, y).
  void add(double x, double y, double edge, const Interval& z) {
    const double height = z.upper - z.lower, mass = edge * edge * height, middle = 0.5 * (z.lower + z.upper);
    const double spread = edge * edge / 12;
    volume += mass;
    first += mass * Vec3{x, y, middle};
    xx += mass * (x * x + spread);
    yy += mass * (y * y + spread);
    zz += mass * (middle * middle + height * height / 12);
    xy += mass * x * y;
    xz += mass * x * middle;
    yz += mass * y * middle;
  }
  /// Adds the union of intervals, at least one, with z from middle_z.
  void add_union(double x, double y, double edge, double middle_z, std::vector<Interval>& column) {
    std::sort(column.begin(), column.end());
    Interval open = column.front();
    const auto close = [&] { add(x, y, edge, {open.lower - middle_z, open.upper - middle_z}); };
    for (const Interval& next : column) {
      if (next.lower > open.upper) {
        close();
        open = next;
      } else {
        open.upper = std::max(open.upper, next.upper);
      }
    }
    close();
  }
};

}  // namespace

UnionMass union_mass(std::span<const Sphere> spheres, int resolution) {
  const Box box = detail::box_of(spheres);
  UnionMass result;
  const double side = box.is_empty() ? 0 : std::max(box.extent().x, box.extent().y);
  if (!(side > 0)) return result;
  const double edge = side / resolution;
  // Moments are about the middle, so that spheres far from the origin lose no digits.
  const Vec3 middle = box.center();
  const auto columns_x = static_cast<int>(std::ceil(box.extent().x / edge)),
             columns_y = static_cast<int>(std::ceil(box.extent().y / edge));
  Moments moments;
  std::vector<std::vector<Interval>> row(static_cast<std::size_t>(std::max(1, columns_x)));
  for (int j = 0; j < columns_y; ++j) {
    detail::check_interrupt();
    const double y = box.lower.y + (j + 0.5) * edge;
    for (auto& column : row) column.clear();
    for (const Sphere& s : spheres) {
      const double across = s.radius * s.radius - (y - s.center.y) * (y - s.center.y);
      if (!(across > 0)) continue;
      const double reach = std::sqrt(across);
      const int begin = std::max(0, static_cast<int>((s.center.x - reach - box.lower.x) / edge) - 1);
      const int end = std::min(columns_x, static_cast<int>((s.center.x + reach - box.lower.x) / edge) + 2);
      for (int i = begin; i < end; ++i) {
        const double dx = box.lower.x + (i + 0.5) * edge - s.center.x, deep = across - dx * dx;
        if (deep > 0)
          row[static_cast<std::size_t>(i)].push_back({s.center.z - std::sqrt(deep), s.center.z + std::sqrt(deep)});
      }
    }
    for (int i = 0; i < columns_x; ++i) {
      auto& column = row[static_cast<std::size_t>(i)];
      if (!column.empty())
        moments.add_union(box.lower.x + (i + 0.5) * edge - middle.x, y - middle.y, edge, middle.z, column);
    }
  }
  if (!(moments.volume > 0)) return result;
  const Vec3 c = moments.first / moments.volume;
  const double v = moments.volume;
  const double xx = moments.xx - v * c.x * c.x, yy = moments.yy - v * c.y * c.y, zz = moments.zz - v * c.z * c.z;
  result.volume = v;
  result.center = middle + c;
  result.inertia = {yy + zz, -(moments.xy - v * c.x * c.y), -(moments.xz - v * c.x * c.z),
                    xx + zz, -(moments.yz - v * c.y * c.z), xx + yy};
  return result;
}

ConvergedMass converged_union_mass(std::span<const Sphere> spheres, double tolerance) {
  constexpr int coarsest = 80, finest = 2560;
  ConvergedMass result{union_mass(spheres, coarsest), 0};
  for (int resolution = 2 * coarsest; resolution <= finest; resolution *= 2) {
    const UnionMass finer = union_mass(spheres, resolution);
    const auto share = [](double change, double of) { return of > 0 ? std::abs(change) / of : 0.0; };
    // All entries are compared with the largest: those off the diagonal may be 0.
    double largest = 0;
    for (const std::size_t axis : {0, 3, 5}) largest = std::max(largest, finer.inertia[axis]);
    double change = share(finer.volume - result.solid.volume, finer.volume);
    for (std::size_t i = 0; i < finer.inertia.size(); ++i) {
      change = std::max(change, share(finer.inertia[i] - result.solid.inertia[i], largest));
    }
    result = {finer, change};
    if (change <= tolerance) break;
  }
  return result;
}

}  // namespace morula
