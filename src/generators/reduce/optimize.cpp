// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// Departures: a compass search replaces the simplex; protrusions in the metric are relative to the worst one at the
// start, while the published metric depends on the unit of length.

#include "generators/reduce/optimize.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <morula/geometry/enclosing_sphere.hpp>
#include <numeric>

#include "generators/fit/sphere_fit.hpp"
#include "generators/reduce/ball_set.hpp"

namespace morula::detail {
namespace {

// Balls that share out the samples: every sample has one owner, every ball is as small as its samples let it be.
struct Share {
  Sphere ball;
  double distance = 0;  // signed, of the center
  double protrusion = 0;
  std::vector<std::uint32_t> samples;
};
using Shares = std::vector<Share>;

double worst_protrusion(const Shares& shares) {
  double worst = 0;
  for (const Share& s : shares) worst = std::max(worst, s.protrusion);
  return worst;
}

class Optimization {
 public:
  explicit Optimization(const ReducerInput& node) : node_(node) {}

  // Assigns samples to the balls that they are deepest in by power; samples in none to the nearest surface.
  Shares shared_out(std::span<const Sphere> balls) const {
    Shares shares;
    for (const Sphere& ball : balls) shares.push_back({ball, node_.shape.distance()(ball.center), 0, {}});
    for (std::uint32_t k = 0; k < node_.samples.size(); ++k) {
      std::size_t owner = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < shares.size(); ++i)
        if (const double p = power(shares[i].ball, node_.samples[k]); p < least && p <= 0) least = p, owner = i;
      if (!(least <= 0)) owner = nearest_surface(shares, k);
      shares[owner].samples.push_back(k);
    }
    std::erase_if(shares, [](const Share& s) { return s.samples.empty(); });
    for (Share& s : shares) tighten(s);
    return shares;
  }

  // C.7 recenter: every ball moves to where it sticks out least with its samples, then the samples are shared again.
  Shares recentered(Shares best, int rounds) const {
    for (int round = 0; round < rounds; ++round) {
      Shares moved = best;
      for (Share& s : moved) {
        const Sphere ball = recenter(points_of(s), s.ball.center, node_.shape.distance());
        const double distance = node_.shape.distance()(ball.center);
        if (const double p = std::max(0.0, ball.radius + distance); p < s.protrusion)
          s = {ball, distance, p, std::move(s.samples)};
      }
      const double moved_worst = worst_protrusion(moved);
      Shares next = shared_out(spheres_of(moved));
      // Sharing again can make the balls worse; the balls moved first are still good.
      if (!(worst_protrusion(next) <= moved_worst)) next = std::move(moved);
      if (!(worst_protrusion(next) < worst_protrusion(best))) return next.size() <= best.size() ? next : best;
      best = std::move(next);
    }
    return best;
  }

  // C.7 simplex: the ball that sticks out most is searched over center and radius, and takes or leaves samples.
  Shares searched(Shares shares) const {
    const double unit = worst_protrusion(shares);
    if (!(unit > 0)) return shares;
    constexpr int most_sweeps = 10;
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      std::vector<std::size_t> order(shares.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::stable_sort(order.begin(), order.end(),
                       [&](std::size_t a, std::size_t b) { return shares[a].protrusion > shares[b].protrusion; });
      bool improved = false;
      for (const std::size_t i : order) improved = search(shares, i, unit) || improved;
      if (!improved) break;
    }
    std::erase_if(shares, [](const Share& s) { return s.samples.empty(); });
    return recentered(std::move(shares), 1);
  }

  static std::vector<Sphere> spheres_of(const Shares& shares) {
    std::vector<Sphere> spheres;
    for (const Share& s : shares) spheres.push_back(s.ball);
    return spheres;
  }

 private:
  std::size_t nearest_surface(const Shares& shares, std::uint32_t sample) const {
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < shares.size(); ++i)
      if (const double d = distance(shares[i].ball.center, node_.samples[sample]) - shares[i].ball.radius; d < least)
        least = d, nearest = i;
    return nearest;
  }

  std::vector<Vec3> points_of(const Share& share) const {
    std::vector<Vec3> points;
    for (const std::uint32_t k : share.samples) points.push_back(node_.samples[k]);
    return points;
  }

  // The radius that its samples need, about the same center.
  void tighten(Share& share) const {
    double farthest = 0;
    for (const std::uint32_t k : share.samples)
      farthest = std::max(farthest, squared_distance(share.ball.center, node_.samples[k]));
    share.ball.radius = std::sqrt(farthest);
    share.protrusion = share.samples.empty() ? 0 : std::max(0.0, share.ball.radius + share.distance);
  }

  // 100 n max(e + 1)² + Σ (e + 1)², e relative to `unit`.
  static double metric(const Shares& shares, double unit) {
    double worst = 0, sum = 0;
    for (const Share& s : shares) {
      const double e = s.protrusion / unit + 1;
      worst = std::max(worst, e * e);
      sum += e * e;
    }
    return 100 * static_cast<double>(shares.size()) * worst + sum;
  }

  // Ball i becomes `trial`: samples inside it become its own, and its former samples outside it go to the nearest of
  // the others.
  Shares with(const Shares& shares, std::size_t i, const Sphere& trial) const {
    Shares next = shares;
    const double squared_radius = trial.radius * trial.radius;
    std::vector<bool> touched(shares.size(), false);
    std::vector<std::uint32_t> own, lost;
    for (std::size_t j = 0; j < next.size(); ++j) {
      const std::size_t before = next[j].samples.size();
      std::erase_if(next[j].samples, [&](std::uint32_t k) {
        if (squared_distance(trial.center, node_.samples[k]) > squared_radius) {
          if (j == i) lost.push_back(k);
          return j == i;
        }
        own.push_back(k);
        return true;
      });
      touched[j] = next[j].samples.size() != before;
    }
    next[i].ball = trial;
    next[i].distance = node_.shape.distance()(trial.center);
    next[i].samples = std::move(own);
    touched[i] = true;
    for (const std::uint32_t k : lost) {
      const std::size_t heir = nearest_surface(next, k);
      next[heir].samples.push_back(k);
      touched[heir] = true;
    }
    for (std::size_t j = 0; j < next.size(); ++j) {
      if (!touched[j]) continue;
      std::sort(next[j].samples.begin(), next[j].samples.end());
      tighten(next[j]);
    }
    return next;
  }

  bool search(Shares& shares, std::size_t i, double unit) const {
    double least = metric(shares, unit);
    bool improved_ever = false;
    constexpr double first_step = 0.2, last_step = 0.03;  // shares of the radius
    for (double step = first_step; step > last_step;) {
      bool improved = false;
      for (int k = 0; k < 8 && !improved; ++k) {
        Sphere trial = shares[i].ball;
        const double stride = (k % 2 == 0 ? step : -step) * trial.radius;
        if (k / 2 < 3)
          trial.center[k / 2] += stride;
        else
          trial.radius += stride;
        if (shares[i].samples.empty() || !(trial.radius > 0)) continue;
        Shares next = with(shares, i, trial);
        if (const double m = metric(next, unit); m < least * (1 - 1e-6)) {
          least = m;
          shares = std::move(next);
          improved = improved_ever = true;
        }
      }
      if (!improved) step *= 0.5;
    }
    return improved_ever;
  }

  const ReducerInput& node_;
};

Shares one_fewer(const Shares& shares, const ReducerInput& node, const Optimization& optimization) {
  std::vector<Sphere> balls;
  std::vector<double> distances;
  for (const Share& s : shares) balls.push_back(s.ball), distances.push_back(s.distance);
  return optimization.shared_out(
      burst({std::move(balls), std::move(distances), node.samples}, shares.size() - 1, node.shape.distance()).balls);
}

}  // namespace

void optimize(Proposal& proposal, const ReducerInput& node, Optimizer optimizer, double excess) {
  if (optimizer == Optimizer::none || proposal.spheres.empty() || node.samples.empty()) return;
  const Optimization optimization(node);
  Shares shares = optimization.shared_out(proposal.spheres);
  if (optimizer == Optimizer::recenter) {
    shares = optimization.recentered(std::move(shares), 3);
  } else {
    shares = optimization.searched(std::move(shares));
  }
  if (optimizer == Optimizer::balance) {
    constexpr std::size_t least_spheres = 3;
    const double bound = (1 + excess) * worst_protrusion(shares);
    while (shares.size() > least_spheres) {
      Shares fewer = one_fewer(shares, node, optimization);
      if (worst_protrusion(fewer) > bound) fewer = optimization.searched(std::move(fewer));
      if (worst_protrusion(fewer) > bound) break;
      shares = std::move(fewer);
      proposal.fill_places = false;
    }
  }
  // Radii that just hold a sphere's own samples are bad ones to divide the surface by: surface in the middle of a large
  // sphere goes to it whatever small spheres are there, and a few spheres end up with nothing.
  std::vector<double> distances;
  for (const Share& s : shares) distances.push_back(s.distance);
  proposal.spheres = equally_grown(Optimization::spheres_of(shares), distances, node.samples);
}

}  // namespace morula::detail
