// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/free_space.hpp"

#include <algorithm>
#include <cmath>

#include "simd/float4.hpp"

namespace morula::detail {

FreeSpace::FreeSpace(const ObjectLines& lines, const Sphere& around, double spacing, std::vector<Sphere> others)
    : middle_(around.center),
      radius_(around.radius / lines.cell()),
      cell_(lines.cell()),
      tolerance_(static_cast<float>(lines.tolerance() / lines.cell())),
      in_lattice_(lines.to_lattice(around.center)),
      stride_(std::max(1, static_cast<int>(spacing / lines.cell()))) {
  // Balls that reach deepest come first: one or two of them have most lines to themselves.
  const auto key = [&](const Sphere& s) { return distance(s.center, middle_) - s.radius; };
  std::stable_sort(others.begin(), others.end(), [&](const Sphere& a, const Sphere& b) { return key(a) < key(b); });
  std::vector<Ball> balls(others.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < others.size(); ++i) {
      const Vec3 c = lines.to_lattice(others[i].center);
      balls[i] = {c[axis], c[(axis + 1) % 3], c[(axis + 2) % 3],
                  std::max(0.0, others[i].radius - lines.tolerance()) / cell_};
    }
    trace(lines, axis, balls);
  }
}

// The lines of one axis. The lattice's lines are at the middles of cells.
void FreeSpace::trace(const ObjectLines& lines, int axis, std::span<const Ball> others) {
  const double cu = in_lattice_[(axis + 1) % 3] - 0.5, cv = in_lattice_[(axis + 2) % 3] - 0.5;
  const auto first = [&](double low) { return static_cast<int>(std::ceil(low / stride_)) * stride_; };
  std::vector<Ball> row;
  for (int v = first(cv - radius_); v < cv + radius_; v += stride_) {
    const double dv = v - cv, in_row = radius_ * radius_ - dv * dv;
    if (!(in_row > 0)) continue;
    const double half_row = std::sqrt(in_row);
    row.clear();
    for (const Ball& b : others) {
      const double away = v + 0.5 - b.v, square = b.radius * b.radius - away * away;
      if (square > 0) row.push_back({b.along, b.u, b.v, square});  // here the square of the radius in the row
    }
    for (int u = first(cu - half_row); u < cu + half_row; u += stride_) {
      const double du = u - cu, square = in_row - du * du;
      if (square > 0) trace_line(lines, axis, u, v, std::sqrt(square), row);
    }
  }
  for (Segments& p = segments_[static_cast<std::size_t>(axis)]; p.u.size() % 4 != 0;) p.add(0, 0, 0, 0, 0);
}

void FreeSpace::trace_line(const ObjectLines& lines, int axis, int u, int v, double half, std::span<const Ball> row) {
  const double middle = in_lattice_[axis], from = middle - half, to = middle + half;
  // Covered space: one interval that grows, and the intervals that do not touch it.
  Interval taken{to, from};
  apart_.clear();
  const auto take = [&](double begin, double end) {
    if (!(end > from && begin < to)) return;
    if (taken.begin > taken.end)
      taken = {begin, end};
    else if (begin <= taken.end && end >= taken.begin)
      taken = {std::min(begin, taken.begin), std::max(end, taken.end)};
    else
      apart_.push_back({begin, end});
  };
  const auto crossings = lines.line(axis, u, v);
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
    take(static_cast<double>(crossings[i].at), static_cast<double>(crossings[i + 1].at));
  for (const Ball& b : row) {
    if (taken.begin <= from && taken.end >= to) return;
    const double away = u + 0.5 - b.u, square = b.radius - away * away;
    if (!(square > 0)) continue;
    const double reach = std::sqrt(square);
    take(b.along - reach, b.along + reach);
  }

  const ObjectLines::WeightsAlong weights = lines.weights_along(axis, u, v);
  const double blocks_end = static_cast<double>(weights.block) * weights.blocks;
  Segments& segments = segments_[static_cast<std::size_t>(axis)];
  const auto line_u = static_cast<float>(u + 0.5 - in_lattice_[(axis + 1) % 3]),
             line_v = static_cast<float>(v + 0.5 - in_lattice_[(axis + 2) % 3]);
  const auto add = [&](double at, double end) {
    while (at < end) {
      double next = end;
      int block = -1;
      if (at < 0) {
        next = std::min(next, 0.0);
      } else if (at < blocks_end) {
        block = static_cast<int>(at / weights.block);
        next = std::min(next, static_cast<double>(weights.block) * (block + 1));
      }
      segments.add(line_u, line_v, at - middle, next - middle, weights[block]);
      at = next;
    }
  };
  double at = from;
  if (!apart_.empty()) {
    if (taken.begin <= taken.end) apart_.push_back(taken);
    std::sort(apart_.begin(), apart_.end(), [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
    for (const Interval& i : apart_) {
      if (i.begin > at) add(at, std::min(i.begin, to));
      at = std::max(at, i.end);
      if (at >= to) break;
    }
  } else if (taken.begin <= taken.end) {
    add(from, taken.begin);
    at = std::max(from, taken.end);
  }
  add(at, to);
}

void FreeSpace::Segments::add(float line_u, float line_v, double from, double to, float counts) {
  u.push_back(line_u);
  v.push_back(line_v);
  begin.push_back(static_cast<float>(from));
  end.push_back(static_cast<float>(to));
  weight.push_back(counts);
}

Vec3f FreeSpace::to_cells(const Vec3& p) const {
  return Vec3f((p - middle_) / cell_);
}

Vec3 FreeSpace::from_cells(const Vec3f& p) const {
  return middle_ + Vec3{p.x, p.y, p.z} * cell_;
}

bool FreeSpace::is_inside(const Vec3f& center, float radius) const {
  const float room = static_cast<float>(radius_) - radius;
  return room >= 0 && center.x * center.x + center.y * center.y + center.z * center.z <= room * room;
}

float FreeSpace::cost(const Vec3f& center, float whole_radius, float enough) const {
  const float radius = std::max(0.0F, whole_radius - tolerance_);
  float total = 0;
  for (std::size_t a = 0; a < 3 && total <= enough; ++a) {
    const Segments& p = segments_[a];
    const Float4 zero(0.0F), square(radius * radius), along(center[static_cast<int>(a)]),
        across_u(center[static_cast<int>((a + 1) % 3)]), across_v(center[static_cast<int>((a + 2) % 3)]);
    Float4 sum(0.0F);
    for (std::size_t i = 0; i < p.u.size(); i += 4) {
      const Float4 du = Float4::load(&p.u[i]) - across_u, dv = Float4::load(&p.v[i]) - across_v;
      const Float4 half = sqrt(max(square - du * du - dv * dv, zero));
      const Float4 in = min(Float4::load(&p.end[i]), along + half) - max(Float4::load(&p.begin[i]), along - half);
      sum = sum + Float4::load(&p.weight[i]) * max(in, zero);
    }
    total += (sum[0] + sum[1]) + (sum[2] + sum[3]);
  }
  return total;
}

}  // namespace morula::detail
