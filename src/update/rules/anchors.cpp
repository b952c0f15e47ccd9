// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/anchors.hpp"

#include <algorithm>
#include <cmath>

#include "update/points/kernels.hpp"
#include "update/points/turned_axes.hpp"
#include "update/rules/anchor_choice.hpp"

namespace morula::detail {
namespace {

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

// Padded by weights 0 for the anchor that a node has anyway, or any point, which changes no sum: none is ever -0, since
// each begins with +0, and +0 or another number plus a zero of either sign is what it was.
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
  // Two sums, so that an addition need not wait for the one before.
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
  std::size_t summed = group_begin_.size();  // the group
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
