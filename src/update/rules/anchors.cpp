// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/anchors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/vector.hpp>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "simd/float4.hpp"
#include "update/points/kernels.hpp"
#include "update/points/turned_axes.hpp"

namespace morula::detail {
namespace {

// Choice of anchors: the points that a center is tied to, and their weights. It is made once, when a body is made.
struct AnchorChoice {
  std::vector<std::uint32_t> points;  // ascending
  std::vector<double> weights;        // one per point, none zero; they add up to 1
  bool reproduces = false;            // the weighted sum is the center; otherwise it falls short of it
  bool degenerate = false;            // fewer than four anchors that span space: equal weights
  // Three anchors that show how all of them turn; repeated ones if they are collinear or fewer.
  std::array<std::uint32_t, 3> axes{};
};

using Indices = std::vector<std::uint32_t>;

Vec3 as_double(const LocalPoint& p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}

void sort_unique(Indices& indices) {
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
}

// For each of 16 directions the candidate that lies best in it: near, but not sideways. A candidate at the very center
// would win in every direction, so distances below a fifth of the radius count as that.
Indices best_by_direction(const Vec3& center, double radius, std::span<const LocalPoint> points,
                          std::span<const std::uint32_t> candidates) {
  constexpr int count = 16;
  const std::vector<Vec3> directions = fibonacci_directions(count);
  double x[count], y[count], z[count], least[count];
  Indices chosen(count, candidates[0]);
  for (int k = 0; k < count; ++k) {
    const Vec3& d = directions[static_cast<std::size_t>(k)];
    x[k] = d.x, y[k] = d.y, z[k] = d.z, least[k] = std::numeric_limits<double>::infinity();
  }
  for (const std::uint32_t i : candidates) {
    const Vec3 offset = as_double(points[i]) - center;
    const double away = 7 * std::max(length(offset), 0.2 * radius);
    double cost[count];
    bool better = false;
    for (int k = 0; k < count; ++k) {
      cost[k] = away - 6 * (offset.x * x[k] + offset.y * y[k] + offset.z * z[k]);
      better |= cost[k] < least[k];
    }
    if (!better) continue;
    for (int k = 0; k < count; ++k)
      if (cost[k] < least[k]) least[k] = cost[k], chosen[static_cast<std::size_t>(k)] = i;
  }
  sort_unique(chosen);
  return chosen;
}

// The number of dimensions that points span, and points that show it, one more than dimensions: two far apart, the one
// farthest from their line, the one farthest from their plane. The first again if there is none.
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

// Solves the symmetric positive definite system a x = (1, 0, 0, 0) by Cholesky; nothing if it is singular.
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

using Weights = std::vector<double>;

double magnification(const Weights& w) {
  double sum = 0;
  for (const double weight : w) sum += std::abs(weight);
  return sum;
}

// Weights that add up to 1 and put the weighted sum of y at zero, as nearly as `ridge` permits, with the least sum of
// w^2 (0.2 + |y|): near anchors count more. y: about the center. Nothing when y does not span space and ridge is 0.
std::optional<Weights> least_weights(std::span<const Vec3> y, double ridge) {
  const auto row = [&](std::size_t i) { return Vector4{1, y[i].x, y[i].y, y[i].z}; };
  const auto cost = [&](std::size_t i) { return 0.2 + length(y[i]); };
  Matrix4 normal{};
  for (std::size_t i = 0; i < y.size(); ++i) {
    const Vector4 a = row(i);
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) normal[r][c] += a[r] * a[c] / cost(i);
  }
  for (int r = 1; r < 4; ++r) normal[r][r] += ridge;
  const auto multiplier = solve_for_first_unit(normal);
  if (!multiplier) return std::nullopt;
  Weights w(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    const Vector4 a = row(i);
    for (int r = 0; r < 4; ++r) w[i] += a[r] * (*multiplier)[r];
    w[i] /= cost(i);
  }
  const double sum = std::accumulate(w.begin(), w.end(), 0.0);
  for (double& weight : w) weight /= sum;
  return w;
}

// Weights like those of least_weights, without negative ones: the most negative anchor is dropped (weight 0) and the
// rest solved again. Nothing when fewer than `fewest` would be left.
std::optional<Weights> convex_weights(std::span<const Vec3> y, double ridge, std::size_t fewest) {
  std::vector<std::size_t> kept(y.size());
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  while (kept.size() >= fewest) {
    std::vector<Vec3> kept_y;
    for (const std::size_t i : kept) kept_y.push_back(y[i]);
    const auto w = least_weights(kept_y, ridge);
    if (!w) return std::nullopt;
    const auto lowest = std::min_element(w->begin(), w->end());
    if (*lowest >= 0) {
      Weights all(y.size());
      for (std::size_t i = 0; i < kept.size(); ++i) all[kept[i]] = (*w)[i];
      return all;
    }
    kept.erase(kept.begin() + (lowest - w->begin()));
  }
  return std::nullopt;
}

// Weights that reproduce the center without magnifying noise much; nothing if the anchors have none.
std::optional<Weights> reproducing_weights(std::span<const Vec3> y) {
  constexpr double mild = 2;
  if (auto w = convex_weights(y, 0.0, 4)) return w;
  if (auto w = least_weights(y, 0.0); w && magnification(*w) <= mild) return w;
  return std::nullopt;
}

// For a center outside the hull of its anchors: weights that nearly reproduce it, but are never so large that they
// magnify noise.
Weights bounded_weights(std::span<const Vec3> y) {
  constexpr double largest = 12;
  const auto n = static_cast<double>(y.size());
  Weights w = least_weights(y, 1e-3 * n).value_or(Weights(y.size(), 1 / n));
  if (const double m = magnification(w); m > largest)
    for (double& weight : w) weight = 1 / n + (weight - 1 / n) * (largest - 1) / (m + 1);
  return w;
}

// The candidate that the hull of the anchors needs most to come to the center: the one farthest beyond the point where
// it comes nearest. Nothing when none lies beyond, and then the center is outside the hull of all candidates.
std::optional<std::uint32_t> support(const Vec3& center, std::span<const LocalPoint> points,
                                     std::span<const std::uint32_t> candidates, std::span<const Vec3> y) {
  const auto w = convex_weights(y, 1e-6, 1);
  if (!w) return std::nullopt;
  Vec3 nearest{};
  for (std::size_t i = 0; i < y.size(); ++i) nearest += y[i] * (*w)[i];
  std::optional<std::uint32_t> found;
  double farthest = 0;
  for (const std::uint32_t i : candidates)
    if (const double beyond = -dot(as_double(points[i]) - center, nearest); beyond > farthest)
      farthest = beyond, found = i;
  return found;
}

// candidates: points that may become anchors, ascending, each once; none gives no anchors.
// radius: that of the sphere about the center, which sets the scale.
//
// About sixteen near points on all sides of the center. Weights as small as can be, so that noise of single vertices
// averages out, and none or only mildly negative. A center far outside the hull of all candidates has no such weights.
AnchorChoice choose_anchors(const Vec3& center, double radius, std::span<const LocalPoint> points,
                            std::span<const std::uint32_t> candidates) {
  AnchorChoice choice;
  if (candidates.empty()) return choice;
  Indices chosen = best_by_direction(center, radius, points, candidates);
  // If the sixteen span less than the candidates do, four more are added. A center far to one side of all candidates
  // would otherwise be tied to a single point, and its rotation would be undefined.
  Span span = span_of(points, chosen);
  if (span.dimensions < 3) {
    const Span possible = span_of(points, candidates);
    chosen.insert(chosen.end(), possible.points.begin(), possible.points.end());
    sort_unique(chosen);
    span = possible;
  }
  choice.degenerate = span.dimensions < 3;
  std::copy_n(span.points.begin(), 3, choice.axes.begin());

  double reach = 0;  // unit of lengths, so that ridges and costs mean the same at every scale
  for (const std::uint32_t i : chosen) reach = std::max(reach, distance(as_double(points[i]), center));
  const auto about_center = [&] {
    std::vector<Vec3> y;
    for (const std::uint32_t i : chosen) y.push_back((as_double(points[i]) - center) / (reach > 0 ? reach : 1.0));
    return y;
  };
  std::vector<Vec3> y = about_center();
  std::optional<Weights> weights;
  if (choice.degenerate) {
    weights = Weights(chosen.size(), 1 / static_cast<double>(chosen.size()));
  } else {
    constexpr int most_rounds = 8;
    weights = reproducing_weights(y);
    for (int round = 0; !weights && round < most_rounds; ++round) {
      const auto missing = support(center, points, candidates, y);
      if (!missing || std::binary_search(chosen.begin(), chosen.end(), *missing)) break;
      chosen.insert(std::upper_bound(chosen.begin(), chosen.end(), *missing), *missing);
      y = about_center();
      weights = reproducing_weights(y);
    }
    choice.reproduces = weights.has_value();
    if (!weights) weights = bounded_weights(y);
  }
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if ((*weights)[i] != 0) choice.points.push_back(chosen[i]), choice.weights.push_back((*weights)[i]);
  return choice;
}

Vec3f position(const LocalPoint& p) {
  return {p.x, p.y, p.z};
}

TurnedAxes axes_of(const CenterTie& tie, std::span<const LocalPoint> points) {
  return {position(points[tie.axes[0]]), position(points[tie.axes[1]]), position(points[tie.axes[2]])};
}
Vec3f carried(const CenterTie& tie, std::span<const LocalPoint> points) {
  return axes_of(tie, points).place(tie.in_axes);
}

}  // namespace

void Anchors::tie(const Vec3f& center, float radius, std::span<const LocalPoint> rest_points,
                  std::span<const std::uint32_t> candidates) {
  CenterTie tie;
  const AnchorChoice choice = choose_anchors(Vec3(center), static_cast<double>(radius), rest_points, candidates);
  tie.begin = static_cast<std::uint32_t>(points_.size());
  points_.insert(points_.end(), choice.points.begin(), choice.points.end());
  for (const double w : choice.weights) weights_.push_back(static_cast<float>(w));
  tie.end = static_cast<std::uint32_t>(points_.size());
  tie.degenerate = choice.degenerate;
  tie.axes = choice.axes;
  at_rest_.push_back({center, weighted_sum(tie, rest_points)});

  if (!choice.reproduces && !choice.points.empty()) {
    const Vec3 remainder = Vec3(center) - Vec3(at_rest_.back().sum);
    tie.carries = length(remainder) > 1e-7 * static_cast<double>(radius);
    tie.in_axes = axes_of(tie, rest_points).coordinates(remainder);
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
  at_rest_.insert(at_rest_.end(), others.at_rest_.begin(), others.at_rest_.end());
  points_.insert(points_.end(), others.points_.begin(), others.points_.end());
  weights_.insert(weights_.end(), others.weights_.begin(), others.weights_.end());
}

// Padding has weights 0 for any anchor of the node, or any point, which changes no sum: none is ever -0, since each
// begins with +0, and +0 or another number plus a zero of either sign stays the same.
void Anchors::pack() {
  std::vector<std::uint32_t> points;
  std::vector<float> weights;
  group_begin_.assign(1, 0);
  for (std::size_t first = 0; first < ties_.size(); first += nodes_per_group) {
    const std::size_t last = std::min(first + nodes_per_group, ties_.size());
    std::uint32_t most = 0;
    for (std::size_t k = first; k < last; ++k) most = std::max(most, (ties_[k].end - ties_[k].begin) / ties_[k].step);
    most += most % 2;
    const auto begin = static_cast<std::uint32_t>(points.size());
    points.resize(begin + nodes_per_group * most, 0);
    weights.resize(points.size(), 0.0f);
    for (std::size_t k = first; k < last; ++k) {
      CenterTie& tie = ties_[k];
      const auto lane = static_cast<std::uint32_t>(k - first);
      std::uint32_t to = begin + lane;
      for (std::uint32_t i = tie.begin; i < tie.end; i += tie.step, to += nodes_per_group)
        points[to] = points_[i], weights[to] = weights_[i];
      tie.begin = begin + lane, tie.end = to, tie.step = nodes_per_group;
    }
    group_begin_.push_back(static_cast<std::uint32_t>(points.size()));
  }
  points_ = std::move(points);
  weights_ = std::move(weights);

  for (std::uint32_t k = 0; k < ties_.size(); ++k) {
    const CenterTie& tie = ties_[k];
    if (!tie.carries) continue;
    carrying_.push_back(k);
    for (int i = 0; i < 3; ++i) {
      axes_[i].push_back(tie.axes[i]);
      in_axes_[i].push_back(tie.in_axes[i]);
      rest_carried_[i].push_back(tie.rest_carried[i]);
    }
  }
  for (int i = 0; i < 3; ++i) {
    axes_[i].resize(carrying_.size() + nodes_at_once, 0);
    in_axes_[i].resize(carrying_.size() + nodes_at_once, 0.0f);
    rest_carried_[i].resize(carrying_.size() + nodes_at_once, 0.0f);
  }
}

Vec3f Anchors::weighted_sum(const CenterTie& tie, std::span<const LocalPoint> points) const noexcept {
  // Two sums, so that an addition need not wait for the last one.
  Float4 even(0.0f), odd(0.0f);
  std::uint32_t i = tie.begin;
  for (; i + tie.step < tie.end; i += 2 * tie.step) {
    even = even + Float4(weights_[i]) * Float4::load(points[points_[i]]);
    odd = odd + Float4(weights_[i + tie.step]) * Float4::load(points[points_[i + tie.step]]);
  }
  if (i < tie.end) even = even + Float4(weights_[i]) * Float4::load(points[points_[i]]);
  const Float4 sum = even + odd;
  LocalPoint result;
  sum.store(result);
  return position(result);
}

Vec3f Anchors::center(std::size_t k, std::span<const LocalPoint> points) const noexcept {
  const CenterTie& tie = ties_[k];
  Vec3f center = at_rest_[k].center + (weighted_sum(tie, points) - at_rest_[k].sum);
  if (tie.carries) center = center + (carried(tie, points) - tie.rest_carried);
  return center;
}

void Anchors::centers(std::size_t begin, std::size_t end, std::span<const LocalPoint> points,
                      LocalPoint* centers) const noexcept {
  const std::size_t groups = (end - begin + nodes_per_group - 1) / nodes_per_group;
  kernels().weighted_sums(points.data(), points_.data(), weights_.data(),
                          std::span(group_begin_).subspan(begin / nodes_per_group, groups + 1), centers);
  for (std::size_t k = begin; k < end; ++k) {
    LocalPoint& center = centers[k - begin];
    const AtRest& rest = at_rest_[k];
    (Float4(rest.center) + (Float4::load(center) - Float4(rest.sum))).store(center);
  }
  const auto place = [&](std::size_t k) {
    return static_cast<std::size_t>(std::lower_bound(carrying_.begin(), carrying_.end(), k) - carrying_.begin());
  };
  const Remainders remainders{{axes_[0].data(), axes_[1].data(), axes_[2].data()},
                              {in_axes_[0].data(), in_axes_[1].data(), in_axes_[2].data()},
                              {rest_carried_[0].data(), rest_carried_[1].data(), rest_carried_[2].data()}};
  std::array<LocalPoint, nodes_at_once> moves;
  for (std::size_t i = place(begin), last = place(end); i < last; i += nodes_at_once) {
    const std::size_t to = std::min(i + nodes_at_once, last);
    kernels().carry(points.data(), remainders, i, to, moves.data());
    for (std::size_t j = i; j < to; ++j) {
      LocalPoint& center = centers[carrying_[j] - begin];
      (Float4::load(center) + Float4::load(moves[j - i])).store(center);
    }
  }
}

void Anchors::centers(std::span<const std::uint32_t> some, std::span<const LocalPoint> points,
                      LocalPoint* centers) const noexcept {
  std::array<LocalPoint, nodes_per_group> sums;
  std::size_t summed = group_begin_.size();  // the current group
  for (std::size_t j = 0; j < some.size(); ++j) {
    const std::uint32_t k = some[j];
    if (const std::size_t group = k / nodes_per_group; group != summed) {
      summed = group;
      kernels().weighted_sums(points.data(), points_.data(), weights_.data(), std::span(group_begin_).subspan(group, 2),
                              sums.data());
    }
    const AtRest& rest = at_rest_[k];
    Float4 center = Float4(rest.center) + (Float4::load(sums[k % nodes_per_group]) - Float4(rest.sum));
    if (const CenterTie& tie = ties_[k]; tie.carries) center = center + Float4(carried(tie, points) - tie.rest_carried);
    center.store(centers[j]);
  }
}

}  // namespace morula::detail
