// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spawn [bradshaw2002]: spheres that all stick out equally, by s, placed next to each other until they contain all
// samples; the least s for which few enough do.
//
// Departures: a sphere has r = s − φ(c), so the search is over its center alone; its gain is the number of new samples
// with a soft edge, which has a slope; a plain count has none. Every sphere must contain the remotest sample left, so
// no stray remains at the end. It starts from the best of the medial balls there instead of the previous sphere. s is
// bisected by its logarithm, and the spheres of the last success are tried again for the next. The resulting radii are
// of equal power: with those the spheres share the surface more evenly, from which the levels below gain.

#include <algorithm>
#include <array>
#include <cmath>

#include "generators/reduce/ball_set.hpp"
#include "generators/reduce/reducers.hpp"
#include "generators/reduce/sample_columns.hpp"
#include "medial/shrunken_balls.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

struct Seed {
  Vec3 center;
  double distance;  // signed
};

// Inscribed balls at an even choice of samples.
std::vector<Seed> medial_seeds(const ReducerInput& node) {
  constexpr std::size_t most = 96;
  const std::size_t step = std::max<std::size_t>(1, node.samples.size() / most);
  std::vector<Vec3> points, normals;
  for (std::size_t k = 0; k < node.samples.size(); k += step) {
    points.push_back(node.samples[k]);
    normals.push_back(node.normals[k]);
  }
  std::vector<Seed> seeds;
  for (const Sphere& ball : shrunken_balls(node.shape.distance(), points, normals, BallSharing::on_round_parts))
    seeds.push_back({ball.center, -ball.radius});
  return seeds;
}

class Spawn {
 public:
  explicit Spawn(const ReducerInput& node) : node_(node), seeds_(medial_seeds(node)) {
    Vec3 mean{};
    for (const Vec3& p : node.samples) mean += p;
    mean = mean / static_cast<double>(node.samples.size());
    for (const Vec3& p : node.samples) remoteness_.push_back(squared_distance(p, mean));
  }

  std::vector<Sphere> run() {
    // The node's own sphere is a success.
    double high = node_.shape.distance().protrusion_bound(node_.sphere);
    if (!(high > 0)) return {};
    double low = high / 1024;
    std::vector<Sphere> best;
    constexpr double close_enough = 1.03;
    while (high > close_enough * low) {
      const double s = low * std::sqrt(high / low);
      std::vector<Sphere> spheres = lay(s, best);
      if (spheres.empty()) {
        low = s;
      } else {
        high = s;
        best = std::move(spheres);
      }
    }
    return best;
  }

 private:
  // At most `branching` spheres of this protrusion that contain all samples; none if it takes more.
  std::vector<Sphere> lay(double s, std::span<const Sphere> previous) const {
    std::vector<Sphere> spheres;
    SampleSet left(node_.samples.size());
    for (std::size_t k = 0; k < node_.samples.size(); ++k) left.add(k);
    while (!left.empty()) {
      if (spheres.size() == node_.branching) return {};
      check_interrupt();
      const std::size_t remotest = find_remotest(left);
      const Sphere sphere = best_sphere(s, node_.samples[remotest], left, previous);
      SampleSet next = left;
      left.for_each([&](std::size_t k) {
        if (squared_distance(node_.samples[k], sphere.center) <= sphere.radius * sphere.radius) next.remove(k);
      });
      next.remove(remotest);  // also if rounding leaves it outside
      left = std::move(next);
      spheres.push_back(sphere);
    }
    return spheres;
  }

  std::size_t find_remotest(const SampleSet& left) const {
    std::size_t remotest = 0;
    double most = -1;
    left.for_each([&](std::size_t k) {
      if (remoteness_[k] > most) most = remoteness_[k], remotest = k;
    });
    return remotest;
  }

  // The number of samples that a sphere would take; samples just outside count for a part. squares: their squared
  // distances from the center. No less for a larger radius.
  static double gain(double radius, const std::vector<double>& squares) {
    constexpr double edge = 1.2, edge_worth = 0.3;  // shares of the radius and of a sample
    const double inner = radius * radius, outer = edge * edge * inner;
    double sum = 0;
    for (const double d : squares) {
      if (d <= inner)
        sum += 1;
      else if (d < outer)
        sum += edge_worth * (outer - d) / (outer - inner);
    }
    return sum;
  }

  // The sphere of protrusion s that contains `must` and most of `left`, sought about good centers.
  class Best {
   public:
    Best(const ReducerInput& node, double s, const Vec3& must, const SampleSet& left)
        : node_(node), s_(s), must_(must) {
      left.for_each([&](std::size_t k) { points_.add(node.samples[k]); });
      squares_.resize(points_.size());
      sphere_.center = must;
      stand_at(must);
      consider_radius(std::max(0.0, s - node.shape.distance()(must)));
    }
    const Sphere& sphere() const { return sphere_; }

    /// Returns whether it is better than all earlier ones.
    bool consider(const Vec3& center, double signed_distance) {
      stand_at(center);
      return consider_radius(s_ - signed_distance);
    }
    /// The same, but computes the distance only if the sphere can be better: samples lie on the surface, so the center
    /// is no deeper than the distance of the nearest sample, and a larger radius gains no less. The allowance is for
    /// rounding.
    bool consider(const Vec3& center) {
      stand_at(center);
      const double nearest = *std::min_element(squares_.begin(), squares_.end());
      const double largest = (s_ + std::sqrt(nearest)) * (1 + 1e-9);
      return gain_of(largest) > most_ &&
             consider_radius(s_ - node_.shape.distance().at(center, std::sqrt(nearest)).distance);
    }

   private:
    void stand_at(const Vec3& center) {
      center_ = center;
      points_.squared_distances(center, squares_.data());
    }
    // Negative if it misses `must`.
    double gain_of(double radius) const {
      if (!(radius > 0) || squared_distance(must_, center_) > radius * radius) return -1;
      return gain(radius, squares_);
    }
    bool consider_radius(double radius) {
      const double g = gain_of(radius);
      if (!(g > most_)) return false;
      most_ = g;
      sphere_ = {center_, radius};
      return true;
    }

    const ReducerInput& node_;
    double s_;
    Vec3 must_, center_;
    SampleColumns points_;
    std::vector<double> squares_;
    Sphere sphere_;
    double most_ = -2;
  };

  Sphere best_sphere(double s, const Vec3& must, const SampleSet& left, std::span<const Sphere> previous) const {
    Best best(node_, s, must, left);
    for (const Seed& seed : nearest_seeds(s, must)) best.consider(seed.center, seed.distance);
    for (const Sphere& old : previous)
      if (squared_distance(old.center, must) <= old.radius * old.radius) best.consider(old.center);

    constexpr std::array<Vec3, 6> directions{Vec3{1, 0, 0},  Vec3{-1, 0, 0}, Vec3{0, 1, 0},
                                             Vec3{0, -1, 0}, Vec3{0, 0, 1},  Vec3{0, 0, -1}};
    constexpr double first_step = 0.3, last_step = 0.04;  // shares of the radius
    double step = first_step;
    std::size_t first = 0;
    for (int evaluations = 0; step > last_step && evaluations < 60;) {
      bool improved = false;
      for (std::size_t k = 0; k < directions.size() && !improved; ++k, ++evaluations) {
        const std::size_t d = (first + k) % directions.size();
        improved = best.consider(best.sphere().center + directions[d] * (step * best.sphere().radius));
        if (improved) first = d;
      }
      if (!improved) step *= 0.5;
    }
    return best.sphere();
  }

  // The seeds whose spheres contain `must` earliest.
  std::vector<Seed> nearest_seeds(double s, const Vec3& must) const {
    constexpr std::size_t wanted = 16;
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < seeds_.size(); ++i) {
      const double needed = distance(seeds_[i].center, must) + seeds_[i].distance;
      if (needed <= s) order.emplace_back(needed, i);
    }
    const std::size_t count = std::min(wanted, order.size());
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end());
    std::vector<Seed> seeds;
    for (std::size_t i = 0; i < count; ++i) seeds.push_back(seeds_[order[i].second]);
    return seeds;
  }

  const ReducerInput& node_;
  std::vector<Seed> seeds_;
  std::vector<double> remoteness_;  // squared distance of each sample from the mean
};

}  // namespace

Proposals propose_spawn(const ReducerInput& node) {
  if (node.samples.empty()) return {};
  const std::vector<Sphere> laid = Spawn(node).run();
  if (laid.empty()) return {};
  std::vector<double> distances;
  for (const Sphere& s : laid) distances.push_back(node.shape.distance()(s.center));
  return {{"spawn", equally_grown(laid, distances, node.samples)}};
}

}  // namespace morula::detail
