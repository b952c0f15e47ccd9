// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/anchors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/sampling.hpp>
#include <optional>

namespace morula {
namespace {

Vec3 as_double(const LocalPoint& p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}
Vec3f position(const LocalPoint& p) {
  return {p.x, p.y, p.z};
}

void sort_unique(std::vector<std::uint32_t>& indices) {
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
}

// For each of 16 directions the candidate that lies best in it: near, but not sideways. A candidate at the very centre
// would win in every direction, so distances below a fifth of the radius count as that.
std::vector<std::uint32_t> best_by_direction(const Vec3& center, double radius, std::span<const LocalPoint> points,
                                             std::span<const std::uint32_t> candidates) {
  std::vector<std::uint32_t> chosen;
  if (candidates.empty()) return chosen;
  for (const Vec3& direction : fibonacci_directions(16)) {
    std::uint32_t best = candidates[0];
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : candidates) {
      const Vec3 offset = as_double(points[i]) - center;
      const double cost = 7 * std::max(length(offset), 0.2 * radius) - 6 * dot(offset, direction);
      if (cost < least) least = cost, best = i;
    }
    chosen.push_back(best);
  }
  sort_unique(chosen);
  return chosen;
}

// How many dimensions points span, and as many of them, one more than dimensions, that show it: two far apart, the one
// farthest from their line, the one farthest from their plane. The first again where there is none.
struct Span {
  int dimensions = 0;  // 0 a point, 1 a line, 2 a plane, 3 space
  std::array<std::uint32_t, 4> points{};
};
Span span_of(std::span<const LocalPoint> points, std::span<const std::uint32_t> indices) {
  // Below these shares of the extent a deviation may be the rounding of float positions.
  constexpr double line_rounding = 1e-5, plane_rounding = 1e-4;
  const auto farthest = [&](double above, const auto& measure) {
    std::optional<std::uint32_t> found;
    for (const std::uint32_t i : indices)
      if (const double m = measure(as_double(points[i])); m > above) above = m, found = i;
    return found;
  };
  Span span;
  span.points.fill(indices[0]);
  const Vec3 any = as_double(points[indices[0]]);
  const auto first = farthest(0, [&](const Vec3& p) { return distance(p, any); });
  if (!first) return span;
  const Vec3 p = as_double(points[*first]);
  const auto second = farthest(0, [&](const Vec3& q) { return distance(p, q); });
  const double extent = distance(p, as_double(points[*second]));
  span.dimensions = 1;
  span.points = {*first, *second, *first, *first};
  const Vec3 along = (as_double(points[*second]) - p) / extent;
  const auto third = farthest(line_rounding * extent, [&](const Vec3& q) { return length(cross(along, q - p)); });
  if (!third) return span;
  span.dimensions = 2;
  span.points[2] = *third;
  const Vec3 normal = normalized(cross(along, as_double(points[*third]) - p));
  const auto fourth = farthest(plane_rounding * extent, [&](const Vec3& q) { return std::abs(dot(normal, q - p)); });
  if (!fourth) return span;
  span.dimensions = 3;
  span.points[3] = *fourth;
  return span;
}

// Sixteen by direction; where they span less than the candidates do, also four that show it. A centre far to one side
// of all candidates would otherwise be tied to a single point, and nothing could tell how it has turned.
std::vector<std::uint32_t> choose_anchors(const Vec3& center, double radius, std::span<const LocalPoint> points,
                                          std::span<const std::uint32_t> candidates) {
  std::vector<std::uint32_t> chosen = best_by_direction(center, radius, points, candidates);
  if (chosen.empty()) return chosen;
  const Span possible = span_of(points, candidates);
  if (span_of(points, chosen).dimensions < possible.dimensions) {
    chosen.insert(chosen.end(), possible.points.begin(), possible.points.end());
    sort_unique(chosen);
  }
  return chosen;
}

// Solves the symmetric positive definite system a x = (1, 0, 0, 0) by Cholesky; nothing when it is singular.
using Matrix4 = std::array<std::array<double, 4>, 4>;
using Vector4 = std::array<double, 4>;
std::optional<Vector4> solve_for_first_unit(Matrix4 a) {
  double largest = 0;
  for (int i = 0; i < 4; ++i) largest = std::max(largest, a[i][i]);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = a[i][j];
      for (int k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      if (i == j && !(sum > 1e-10 * largest)) return std::nullopt;
      a[i][j] = i == j ? std::sqrt(sum) : sum / a[j][j];
    }
  }
  Vector4 x{1, 0, 0, 0};
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= a[i][k] * x[k];
    x[i] /= a[i][i];
  }
  for (int i = 4; i-- > 0;) {
    for (int k = i + 1; k < 4; ++k) x[i] -= a[k][i] * x[k];
    x[i] /= a[i][i];
  }
  return x;
}

// Weights that add up to 1 and put the weighted sum of y at zero, as nearly as `ridge` lets them, with the least sum of
// w^2 (0.2 + |y|): near anchors count more. y: about the centre, in radii.
std::optional<std::vector<double>> least_weights(std::span<const Vec3> y, double ridge) {
  Matrix4 normal{};
  std::vector<Vector4> rows;
  for (const Vec3& p : y) rows.push_back({1, p.x, p.y, p.z});
  const auto cost = [&](std::size_t i) { return 0.2 + length(y[i]); };
  for (std::size_t i = 0; i < y.size(); ++i)
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) normal[r][c] += rows[i][r] * rows[i][c] / cost(i);
  for (int r = 1; r < 4; ++r) normal[r][r] += ridge;
  const auto multiplier = solve_for_first_unit(normal);
  if (!multiplier) return std::nullopt;
  std::vector<double> w(y.size());
  double sum = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    for (int r = 0; r < 4; ++r) w[i] += rows[i][r] * (*multiplier)[r];
    w[i] /= cost(i);
    sum += w[i];
  }
  for (double& weight : w) weight /= sum;
  return w;
}

// Convex weights that reproduce the centre: solve, drop the most negative anchor, solve again. Zero for dropped ones;
// nothing when none are found while four remain.
std::optional<std::vector<double>> convex_weights(std::span<const Vec3> y) {
  std::vector<std::size_t> kept(y.size());
  for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = i;
  while (kept.size() >= 4) {
    std::vector<Vec3> kept_y;
    for (const std::size_t i : kept) kept_y.push_back(y[i]);
    const auto w = least_weights(kept_y, 0.0);
    if (!w) return std::nullopt;
    const auto lowest = std::min_element(w->begin(), w->end());
    if (*lowest >= 0) {
      std::vector<double> all(y.size());
      for (std::size_t i = 0; i < kept.size(); ++i) all[kept[i]] = (*w)[i];
      return all;
    }
    kept.erase(kept.begin() + (lowest - w->begin()));
  }
  return std::nullopt;
}

// Weights for a centre outside the hull of its anchors: nearly affine, but never so large that they magnify noise.
std::vector<double> bounded_weights(std::span<const Vec3> y) {
  constexpr double most_magnification = 12;  // largest sum of |w|
  const auto n = static_cast<double>(y.size());
  std::vector<double> w = least_weights(y, 1e-3 * n).value_or(std::vector<double>(y.size(), 1 / n));
  double magnitude = 0;
  for (const double weight : w) magnitude += std::abs(weight);
  if (magnitude > most_magnification)
    for (double& weight : w) weight = 1 / n + (weight - 1 / n) * (most_magnification - 1) / (magnitude + 1);
  return w;
}

// An orthonormal frame that turns with three points; total, and the same for the same points. Where they do not tell a
// direction, some perpendicular one is as good: then all anchors lie on a line (or in a point), and what matters of the
// remainder is its share along the line and its length.
struct Axes {
  Vec3f a, b, c;
};
Axes axes_of(const Vec3f& p, const Vec3f& q, const Vec3f& r) {
  const Vec3f a = normalized(q - p), side = r - p;
  Vec3f b = side - a * dot(a, side);
  constexpr float parallel = 1e-12f;
  if (!(squared_length(b) > parallel * squared_length(side))) {
    const Vec3f size{std::abs(a.x), std::abs(a.y), std::abs(a.z)};
    const Vec3f least = size.x <= size.y && size.x <= size.z ? Vec3f{1, 0, 0}
                        : size.y <= size.z                   ? Vec3f{0, 1, 0}
                                                             : Vec3f{0, 0, 1};
    b = cross(a, least);
  }
  // Once more: where b was a small difference, rounding has left it a share along a, and then distances would change.
  b = normalized(b, {0, 1, 0});
  b = normalized(b - a * dot(a, b), {0, 1, 0});
  return {a, b, cross(a, b)};
}
Vec3f carried(const CenterTie& tie, std::span<const LocalPoint> points) {
  const Axes f =
      axes_of(position(points[tie.frame[0]]), position(points[tie.frame[1]]), position(points[tie.frame[2]]));
  return f.a * tie.in_frame.x + f.b * tie.in_frame.y + f.c * tie.in_frame.z;
}

}  // namespace

void Anchors::tie(const Vec3f& center, float radius, std::span<const LocalPoint> rest_points,
                  std::span<const std::uint32_t> candidates) {
  CenterTie tie;
  tie.rest_center = center;
  tie.begin = static_cast<std::uint32_t>(points_.size());
  const Vec3 c0(center);
  const std::vector<std::uint32_t> chosen = choose_anchors(c0, static_cast<double>(radius), rest_points, candidates);
  std::vector<Vec3> x, y;
  double reach = 0;
  for (const std::uint32_t i : chosen) {
    x.push_back(as_double(rest_points[i]));
    reach = std::max(reach, distance(x.back(), c0));
  }
  for (const Vec3& p : x) y.push_back((p - c0) / (reach > 0 ? reach : 1.0));

  const Span span = chosen.empty() ? Span{} : span_of(rest_points, chosen);
  tie.degenerate = span.dimensions < 3;
  std::optional<std::vector<double>> w;
  if (!tie.degenerate) w = convex_weights(y);
  const bool convex = w.has_value();
  if (!convex)
    w = tie.degenerate ? std::vector<double>(x.size(), 1 / static_cast<double>(x.size())) : bounded_weights(y);

  Vec3 sum{};
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += x[i] * (*w)[i];
    if ((*w)[i] == 0) continue;
    points_.push_back(chosen[i]);
    weights_.push_back(static_cast<float>((*w)[i]));
  }
  tie.end = static_cast<std::uint32_t>(points_.size());
  // Narrowing may leave the sum a little off 1, and then the centre would lag behind when the whole body moves.
  if (tie.begin < tie.end) {
    double total = 0;
    for (std::uint32_t i = tie.begin; i < tie.end; ++i) total += static_cast<double>(weights_[i]);
    const auto heaviest = std::max_element(weights_.begin() + tie.begin, weights_.begin() + tie.end);
    *heaviest = static_cast<float>(static_cast<double>(*heaviest) + (1 - total));
  }
  tie.rest_sum = weighted_sum(tie, rest_points);

  if (!convex && !x.empty()) {
    const Vec3 remainder = c0 - sum;
    tie.carries = length(remainder) > 1e-7 * static_cast<double>(radius);
    for (int k = 0; k < 3; ++k) tie.frame[k] = span.points[k];
    const Axes f = axes_of(position(rest_points[tie.frame[0]]), position(rest_points[tie.frame[1]]),
                           position(rest_points[tie.frame[2]]));
    tie.in_frame = Vec3f(Vec3{dot(remainder, Vec3(f.a)), dot(remainder, Vec3(f.b)), dot(remainder, Vec3(f.c))});
    tie.rest_carried = carried(tie, rest_points);
  }
  ties_.push_back(tie);
}

void Anchors::append(const Anchors& others) {
  const auto offset = static_cast<std::uint32_t>(points_.size());
  for (CenterTie tie : others.ties_) {
    tie.begin += offset;
    tie.end += offset;
    ties_.push_back(tie);
  }
  points_.insert(points_.end(), others.points_.begin(), others.points_.end());
  weights_.insert(weights_.end(), others.weights_.begin(), others.weights_.end());
}

Vec3f Anchors::weighted_sum(const CenterTie& tie, std::span<const LocalPoint> points) const noexcept {
  Float4 sum(0.0f);
  for (std::uint32_t i = tie.begin; i < tie.end; ++i)
    sum = sum + Float4(weights_[i]) * Float4::load(points[points_[i]]);
  LocalPoint result;
  sum.store(result);
  return position(result);
}

Vec3f Anchors::center(std::size_t k, std::span<const LocalPoint> points) const noexcept {
  const CenterTie& tie = ties_[k];
  Vec3f center = tie.rest_center + (weighted_sum(tie, points) - tie.rest_sum);
  if (tie.carries) center = center + (carried(tie, points) - tie.rest_carried);
  return center;
}

}  // namespace morula
