// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/reduce/ball_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "generators/reduce/sample_columns.hpp"
#include "geometry/infinity.hpp"

namespace morula::detail {

BallSet::BallSet(std::vector<Sphere> balls, std::vector<double> distances, std::span<const Vec3> samples)
    : balls_(std::move(balls)), distances_(std::move(distances)), samples_(samples.begin(), samples.end()) {
  const SampleColumns columns(samples_);
  to_samples_.resize(balls_.size() * columns.size());
  for (std::size_t i = 0; i < balls_.size(); ++i)
    columns.squared_distances(balls_[i].center, &to_samples_[i * columns.size()]);
  for (double& d : to_samples_) d = std::sqrt(d);
}

namespace {

// The ball whose surface is nearest to sample k, from inside or outside; set must not be empty.
std::size_t nearest_surface(const BallSet& set, std::size_t k) {
  std::size_t nearest = 0;
  double least = infinity;
  for (std::size_t i = 0; i < set.size(); ++i)
    if (const double d = set.to_samples(i)[k] - set.ball(i).radius; d < least) least = d, nearest = i;
  return nearest;
}

// A sample that formed a ball is on its surface up to rounding.
bool is_inside(double distance, double radius) {
  return distance <= radius * (1 + 1e-5);
}

double power(double distance, double radius) {
  return distance * distance - radius * radius;
}

}  // namespace

// Both functions read the table row by row, as it is stored.

std::vector<SampleSet> samples_owned(const BallSet& set) {
  std::vector<SampleSet> owned(set.size(), SampleSet(set.samples().size()));
  if (set.size() == 0) return owned;
  std::vector<std::size_t> owner(set.samples().size(), set.size());
  std::vector<double> least(owner.size(), infinity);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const double radius = set.ball(i).radius;
    const std::span<const double> away = set.to_samples(i);
    for (std::size_t k = 0; k < away.size(); ++k) {
      if (!is_inside(away[k], radius)) continue;
      if (const double p = power(away[k], radius); p < least[k]) least[k] = p, owner[k] = i;
    }
  }
  for (std::size_t k = 0; k < owner.size(); ++k)
    owned[owner[k] < set.size() ? owner[k] : nearest_surface(set, k)].add(k);
  return owned;
}

std::vector<BallPair> neighbor_pairs(const BallSet& set) {
  constexpr std::size_t looked_at = 3;
  using Nearest = std::array<std::pair<double, std::uint32_t>, looked_at>;  // power, ball
  Nearest none;
  none.fill({infinity, 0});
  std::vector<Nearest> nearest(set.samples().size(), none);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const double radius = set.ball(i).radius;
    const std::span<const double> away = set.to_samples(i);
    for (std::size_t k = 0; k < away.size(); ++k) {
      std::pair<double, std::uint32_t> next{power(away[k], radius), static_cast<std::uint32_t>(i)};
      if (!(next.first < nearest[k].back().first)) continue;  // the first of equals
      for (auto& place : nearest[k])
        if (next < place) std::swap(next, place);
    }
  }
  std::vector<BallPair> pairs;
  for (const Nearest& balls : nearest)
    for (std::size_t other = 1; other < std::min(looked_at, set.size()); ++other)
      pairs.push_back({std::min(balls[0].second, balls[other].second), std::max(balls[0].second, balls[other].second)});
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

double signed_distance(const SignedDistance& shape, const Vec3& p, std::span<const Vec3> samples) {
  double least = infinity;
  for (const Vec3& sample : samples) least = std::min(least, squared_distance(p, sample));
  return shape.at(p, std::sqrt(least)).distance;
}

std::vector<Sphere> equally_grown(std::span<const Sphere> spheres, std::span<const double> distances,
                                  std::span<const Vec3> samples) {
  if (spheres.empty()) return {};
  double needed = -infinity;
  std::vector<bool> used(spheres.size(), false);
  for (const Vec3& p : samples) {
    std::size_t first = 0;
    double least = infinity;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      const double s = growth_to_contain(distances[i], distance(p, spheres[i].center));
      if (s < least) least = s, first = i;
    }
    used[first] = true;
    needed = std::max(needed, least);
  }
  std::vector<Sphere> result;
  for (std::size_t i = 0; i < spheres.size(); ++i)
    if (used[i])
      result.push_back({spheres[i].center, std::sqrt(std::max(0.0, needed - distances[i] * std::abs(distances[i])))});
  return result;
}

}  // namespace morula::detail
