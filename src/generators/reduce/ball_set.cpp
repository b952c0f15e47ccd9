// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/reduce/ball_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace morula::detail {

BallSet::BallSet(std::vector<Sphere> balls, std::vector<double> distances, std::span<const Vec3> samples)
    : balls_(std::move(balls)), distances_(std::move(distances)), samples_(samples.begin(), samples.end()) {
  to_samples_.reserve(balls_.size() * samples_.size());
  for (const Sphere& b : balls_)
    for (const Vec3& p : samples_) to_samples_.push_back(morula::distance(b.center, p));
}

namespace {

// The ball whose surface is nearest to sample k, from inside or outside; set must not be empty.
std::size_t nearest_surface(const BallSet& set, std::size_t k) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < set.size(); ++i)
    if (const double d = set.to_samples(i)[k] - set.ball(i).radius; d < least) least = d, nearest = i;
  return nearest;
}

// A sample that formed a ball is on its surface but for rounding.
bool is_inside(const BallSet& set, std::size_t i, std::size_t k) {
  return set.to_samples(i)[k] <= set.ball(i).radius * (1 + 1e-5);
}

double power_of(const BallSet& set, std::size_t i, std::size_t k) {
  const double d = set.to_samples(i)[k], r = set.ball(i).radius;
  return d * d - r * r;
}

}  // namespace

std::vector<SampleSet> samples_inside(const BallSet& set) {
  std::vector<SampleSet> inside(set.size(), SampleSet(set.samples().size()));
  if (set.size() == 0) return inside;
  for (std::size_t k = 0; k < set.samples().size(); ++k) {
    bool stray = true;
    for (std::size_t i = 0; i < set.size(); ++i)
      if (is_inside(set, i, k)) inside[i].add(k), stray = false;
    if (stray) inside[nearest_surface(set, k)].add(k);
  }
  return inside;
}

std::vector<SampleSet> samples_owned(const BallSet& set) {
  std::vector<SampleSet> owned(set.size(), SampleSet(set.samples().size()));
  if (set.size() == 0) return owned;
  for (std::size_t k = 0; k < set.samples().size(); ++k) {
    std::size_t owner = set.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < set.size(); ++i)
      if (is_inside(set, i, k))
        if (const double p = power_of(set, i, k); p < least) least = p, owner = i;
    owned[owner < set.size() ? owner : nearest_surface(set, k)].add(k);
  }
  return owned;
}

std::vector<BallPair> neighbor_pairs(const BallSet& set) {
  constexpr std::size_t looked_at = 3;
  std::vector<BallPair> pairs;
  for (std::size_t k = 0; k < set.samples().size(); ++k) {
    std::array<std::pair<double, std::uint32_t>, looked_at> nearest;
    nearest.fill({std::numeric_limits<double>::infinity(), 0});
    for (std::size_t i = 0; i < set.size(); ++i) {
      std::pair<double, std::uint32_t> next{power_of(set, i, k), static_cast<std::uint32_t>(i)};
      for (auto& place : nearest)
        if (next < place) std::swap(next, place);
    }
    for (std::size_t other = 1; other < std::min(looked_at, set.size()); ++other)
      pairs.push_back(
          {std::min(nearest[0].second, nearest[other].second), std::max(nearest[0].second, nearest[other].second)});
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

double growth_to_contain(GrowBy grow_by, double distance, double away) {
  return grow_by == GrowBy::protrusion ? away + distance : away * away + distance * std::abs(distance);
}

double grown_radius(GrowBy grow_by, double distance, double s) {
  return grow_by == GrowBy::protrusion ? std::max(0.0, s - distance)
                                       : std::sqrt(std::max(0.0, s - distance * std::abs(distance)));
}

double signed_distance(const SignedDistance& shape, const Vec3& p, std::span<const Vec3> samples) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& sample : samples) least = std::min(least, squared_distance(p, sample));
  return shape.at(p, std::sqrt(least)).distance;
}

std::vector<Sphere> equally_grown(GrowBy grow_by, std::span<const Sphere> spheres, std::span<const double> distances,
                                  std::span<const Vec3> samples) {
  if (spheres.empty()) return {};
  double needed = -std::numeric_limits<double>::infinity();
  std::vector<bool> used(spheres.size(), false);
  for (const Vec3& p : samples) {
    std::size_t first = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      const double s = growth_to_contain(grow_by, distances[i], distance(p, spheres[i].center));
      if (s < least) least = s, first = i;
    }
    used[first] = true;
    needed = std::max(needed, least);
  }
  std::vector<Sphere> result;
  for (std::size_t i = 0; i < spheres.size(); ++i)
    if (used[i]) result.push_back({spheres[i].center, grown_radius(grow_by, distances[i], needed)});
  return result;
}

}  // namespace morula::detail
