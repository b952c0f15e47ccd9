// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Expand and select [bradshaw2004]: all balls grow until they stick out by s, and few of them are kept.
//
// Departures: at a stand-off s ball i has radius s − φ(c), so it contains sample k from s = |x − c| + φ(c) on, or the
// corresponding value by power. That table is made once, and a trial of s needs no query; a success at s is one at the
// largest value it used, so the search ends on a value of the table. Greedy choice takes the ball with most new
// samples, and exchanges between the chosen and all others follow, which the published search does not have.

#include <algorithm>

#include "generators/fit/fit_kernels.hpp"
#include "generators/fit/greedy_rows.hpp"
#include "generators/reduce/ball_set.hpp"
#include "geometry/infinity.hpp"

namespace morula::detail {
namespace {

class Expansion {
 public:
  Expansion(const BallSet& set, std::size_t branching)
      : set_(set), branching_(branching), sample_count_(set.samples().size()) {
    table_.reserve(set.size() * sample_count_);
    for (std::size_t i = 0; i < set.size(); ++i)
      for (const double away : set.to_samples(i)) table_.push_back(growth_to_contain(set.distance(i), away));
  }

  std::vector<Sphere> run() {
    if (set_.size() == 0 || set_.samples().empty()) return {};
    search();
    for (int round = 0; round < 16 && exchange(); ++round) {
    }
    return spheres();
  }

 private:
  double stand_off(std::size_t ball, std::size_t sample) const { return table_[ball * sample_count_ + sample]; }

  const double* row(std::size_t ball) const { return &table_[ball * sample_count_]; }

  // The least stand-off at which these balls contain all samples.
  double needed(const std::vector<std::size_t>& balls) {
    // Row by row, as the table is stored.
    least_.assign(sample_count_, infinity);
    for (const std::size_t i : balls)
      for (std::size_t k = 0; k < sample_count_; ++k) least_[k] = std::min(least_[k], row(i)[k]);
    double most = -infinity;
    for (const double least : least_) most = std::max(most, least);
    return most;
  }

  // Greedy cover at stand-off s; empty when it takes more than `branching` balls.
  std::vector<std::size_t> cover(double s) {
    const std::size_t words = (sample_count_ + 63) / 64;
    contains_.resize(set_.size() * words);
    for (std::size_t i = 0; i < set_.size(); ++i)
      fit_kernels().at_most_in_double(row(i), sample_count_, s, &contains_[i * words]);
    GreedyRows rows(contains_, words);
    std::vector<std::size_t> chosen;
    std::size_t left = sample_count_;
    while (left > 0) {
      const GreedyRows::Choice best = rows.choose();
      // No later ball contains more new samples than this one.
      if (best.new_bits * (branching_ - chosen.size()) < left) return {};
      chosen.push_back(best.row);
      left -= best.new_bits;
    }
    return chosen;
  }

  void search() {
    // One ball alone always succeeds; no choice can do better than all balls together.
    high_ = infinity;
    double low = -infinity;
    for (std::size_t i = 0; i < set_.size(); ++i) {
      if (const double alone = needed({i}); alone < high_) high_ = alone, chosen_ = {i};
    }
    std::vector<std::size_t> all(set_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    low = needed(all);
    if (try_stand_off(low)) return;
    constexpr double exactness = 1e-4;  // relative to the stand-off that one ball needs
    const double last_gap = exactness * std::max(0.0, high_);
    for (int step = 0; step < 40 && high_ - low > last_gap; ++step) {
      const double middle = 0.5 * (low + high_);
      if (!try_stand_off(middle)) low = middle;
    }
  }
  bool try_stand_off(double s) {
    std::vector<std::size_t> found = cover(s);
    if (found.empty()) return false;
    high_ = std::min(high_, needed(found));
    chosen_ = std::move(found);
    return true;
  }

  // Every sample goes to the chosen ball that contains it first, and every such group to the ball that contains it
  // first; unused places go to the ball that helps most. True when that lowered the stand-off.
  bool exchange() {
    std::vector<std::vector<std::size_t>> groups(chosen_.size());
    for (std::size_t k = 0; k < sample_count_; ++k) groups[nearest_chosen(k)].push_back(k);
    std::vector<std::size_t> next;
    for (const std::vector<std::size_t>& group : groups) {
      if (group.empty()) continue;
      std::size_t best = 0;
      double least = infinity;
      for (std::size_t i = 0; i < set_.size(); ++i) {
        double most = -infinity;
        for (const std::size_t k : group) {
          most = std::max(most, stand_off(i, k));
          if (most >= least) break;
        }
        if (most < least) least = most, best = i;
      }
      next.push_back(best);
    }
    while (next.size() < branching_ && add_most_helpful(next)) {
    }
    const double s = needed(next);
    if (!(s < high_)) return false;
    high_ = s;
    chosen_ = std::move(next);
    return true;
  }
  // Adds the ball that is the first to contain the sample with the largest stand-off.
  bool add_most_helpful(std::vector<std::size_t>& balls) const {
    std::size_t worst = 0, best = 0;
    double most = -infinity;
    for (std::size_t k = 0; k < sample_count_; ++k) {
      double least = infinity;
      for (const std::size_t i : balls) least = std::min(least, stand_off(i, k));
      if (least > most) most = least, worst = k;
    }
    double least = most;
    for (std::size_t i = 0; i < set_.size(); ++i)
      if (stand_off(i, worst) < least) least = stand_off(i, worst), best = i;
    if (!(least < most)) return false;
    balls.push_back(best);
    return true;
  }
  std::size_t nearest_chosen(std::size_t sample) const {
    std::size_t nearest = 0;
    for (std::size_t c = 1; c < chosen_.size(); ++c)
      if (stand_off(chosen_[c], sample) < stand_off(chosen_[nearest], sample)) nearest = c;
    return nearest;
  }

  std::vector<Sphere> spheres() const {
    std::vector<Sphere> balls;
    std::vector<double> distances;
    for (const std::size_t c : chosen_) {
      balls.push_back(set_.ball(c));
      distances.push_back(set_.distance(c));
    }
    return equally_grown(balls, distances, set_.samples());
  }

  const BallSet& set_;
  std::size_t branching_;
  std::size_t sample_count_;
  std::vector<double> table_;  // one row per ball
  double high_ = infinity;     // the stand-off that `chosen_` needs
  std::vector<std::size_t> chosen_;
  std::vector<double> least_;            // scratch
  std::vector<std::uint64_t> contains_;  // scratch: bits, one row per ball
};

}  // namespace

std::vector<Sphere> expand(const BallSet& set, std::size_t branching) {
  return Expansion(set, branching).run();
}

}  // namespace morula::detail
