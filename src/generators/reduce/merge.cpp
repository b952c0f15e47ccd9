// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Merge [bradshaw2004]: two balls become one, repeatedly.
//
// Departures: balls are neighbors where they are side by side on the samples, which needs no diagram; a pair is
// evaluated once, when it comes up, and waits in a heap whose entries die with either ball.

#include <algorithm>
#include <limits>
#include <morula/geometry/enclosing_sphere.hpp>
#include <queue>

#include "generators/reduce/ball_set.hpp"

namespace morula::detail {
namespace {

// A ball with its samples; joined ones are never used again.
struct Cluster {
  SampleSet samples;
  Sphere ball;
  double distance;    // signed, of the center
  double protrusion;  // (r + φ(c))⁺
  bool alive = true;
  std::vector<std::uint32_t> pairs;  // dead ones included
};

struct Joint {
  std::uint32_t a, b;
  Sphere ball;
  double distance;
  double protrusion;
};

class Merging {
 public:
  Merging(const BallSet& set, std::size_t branching, const SignedDistance& shape)
      : samples_(set.samples()), branching_(branching), shape_(shape) {
    std::vector<SampleSet> inside = samples_owned(set);
    std::vector<std::uint32_t> cluster_of(set.size(), none);
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (inside[i].empty()) continue;
      const double radius = set.reach(i, inside[i]);
      cluster_of[i] = add(
          {std::move(inside[i]), {set.ball(i).center, radius}, set.distance(i), set.protrusion(i, radius), true, {}});
    }
    if (alive_ <= branching_) return;
    for (const BallPair& pair : neighbor_pairs(set))
      if (cluster_of[pair.i] != none && cluster_of[pair.j] != none) consider(cluster_of[pair.i], cluster_of[pair.j]);
  }

  Reduced run() {
    bool all_pairs = false;
    while (alive_ > branching_) {
      // Near the end few neighbors are left, and every pair is evaluated.
      if (!all_pairs && alive_ <= 3 * branching_) consider_all(), all_pairs = true;
      std::uint32_t pair = beneficial();
      if (pair == none) pair = cheapest();
      if (pair == none) {
        // The neighborhood fell apart into components.
        consider_all();
        continue;
      }
      join(pair);
    }
    Reduced result;
    for (const Cluster& c : clusters_)
      if (c.alive) result.balls.push_back(c.ball), result.distances.push_back(c.distance);
    return result;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;

  std::uint32_t add(Cluster cluster) {
    clusters_.push_back(std::move(cluster));
    ++alive_;
    return static_cast<std::uint32_t>(clusters_.size() - 1);
  }

  void consider(std::uint32_t a, std::uint32_t b) {
    const Cluster& one = clusters_[a];
    const Cluster& other = clusters_[b];
    SampleSet both = one.samples;
    both |= other.samples;
    points_.clear();
    both.for_each([&](std::size_t k) { points_.push_back(samples_[k]); });
    Joint joint{a, b, one.ball, one.distance, 0};
    joint.ball.radius = farthest_distance(one.ball.center, points_);
    joint.protrusion = std::max(0.0, joint.ball.radius + joint.distance);
    const auto take_if_less = [&](const Vec3& center, double radius, double distance) {
      if (const double p = std::max(0.0, radius + distance); p < joint.protrusion)
        joint = {a, b, {center, radius}, distance, p};
    };
    take_if_less(other.ball.center, farthest_distance(other.ball.center, points_), other.distance);
    const Sphere smallest = enclosing_sphere(points_);
    // Distance changes no faster than place: that often proves that the smallest ball is no better.
    const double least_distance = std::max(one.distance - morula::distance(one.ball.center, smallest.center),
                                           other.distance - morula::distance(other.ball.center, smallest.center));
    if (smallest.radius + least_distance < joint.protrusion)
      take_if_less(smallest.center, smallest.radius, signed_distance(shape_, smallest.center, points_));
    const auto index = static_cast<std::uint32_t>(joints_.size());
    joints_.push_back(joint);
    clusters_[a].pairs.push_back(index);
    clusters_[b].pairs.push_back(index);
    heap_.push({joint.protrusion, index});
  }

  bool is_alive(std::uint32_t pair) const {
    return clusters_[joints_[pair].a].alive && clusters_[joints_[pair].b].alive;
  }
  std::uint32_t partner(std::uint32_t pair, std::uint32_t cluster) const {
    return joints_[pair].a == cluster ? joints_[pair].b : joints_[pair].a;
  }

  void consider_all() {
    for (std::uint32_t a = 0; a < clusters_.size(); ++a) {
      if (!clusters_[a].alive) continue;
      std::vector<bool> met(clusters_.size(), false);
      for (const std::uint32_t pair : clusters_[a].pairs) met[partner(pair, a)] = true;
      for (std::uint32_t b = a + 1; b < clusters_.size(); ++b)
        if (clusters_[b].alive && !met[b]) consider(a, b);
    }
  }

  std::uint32_t beneficial() const {
    std::uint32_t worst = none;
    for (std::uint32_t i = 0; i < clusters_.size(); ++i)
      if (clusters_[i].alive && (worst == none || clusters_[i].protrusion > clusters_[worst].protrusion)) worst = i;
    std::uint32_t best = none;
    double least = clusters_[worst].protrusion;
    for (const std::uint32_t pair : clusters_[worst].pairs)
      if (is_alive(pair) && joints_[pair].protrusion < least) least = joints_[pair].protrusion, best = pair;
    return best;
  }

  std::uint32_t cheapest() {
    while (!heap_.empty()) {
      const std::uint32_t pair = heap_.top().second;
      if (is_alive(pair)) return pair;
      heap_.pop();
    }
    return none;
  }

  void join(std::uint32_t pair) {
    const Joint joint = joints_[pair];
    Cluster& a = clusters_[joint.a];
    Cluster& b = clusters_[joint.b];
    a.alive = b.alive = false;
    alive_ -= 2;
    std::vector<std::uint32_t> neighbors;
    for (const std::uint32_t old : a.pairs) neighbors.push_back(partner(old, joint.a));
    for (const std::uint32_t old : b.pairs) neighbors.push_back(partner(old, joint.b));
    std::sort(neighbors.begin(), neighbors.end());
    neighbors.erase(std::unique(neighbors.begin(), neighbors.end()), neighbors.end());
    SampleSet both = std::move(a.samples);
    both |= b.samples;
    const std::uint32_t made = add({std::move(both), joint.ball, joint.distance, joint.protrusion, true, {}});
    if (alive_ <= branching_) return;
    for (const std::uint32_t n : neighbors)
      if (clusters_[n].alive) consider(n, made);
  }

  std::span<const Vec3> samples_;
  std::size_t branching_;
  const SignedDistance& shape_;
  std::vector<Cluster> clusters_;
  std::size_t alive_ = 0;
  std::vector<Joint> joints_;
  using Entry = std::pair<double, std::uint32_t>;  // protrusion, pair
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> heap_;
  std::vector<Vec3> points_;
};

}  // namespace

Reduced merge(const BallSet& set, std::size_t branching, const SignedDistance& shape) {
  if (set.size() == 0 || set.samples().empty()) return {};
  return Merging(set, branching, shape).run();
}

}  // namespace morula::detail
