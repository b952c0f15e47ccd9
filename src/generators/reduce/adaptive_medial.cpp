// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// Departures: the diagram is the node's own, of its samples; the published one is the object's and is shared by all
// nodes. Points are added a few at a time, because the diagram then computes distances only for the balls that remain.
// A ball whose surface point cannot be added is never tried again, since a second try cannot help.

#include "generators/reduce/adaptive_medial.hpp"

#include <algorithm>
#include <cmath>

#include "generators/reduce/sample_columns.hpp"
#include "geometry/infinity.hpp"
#include "medial/shrunken_balls.hpp"
#include "medial/voronoi_balls.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

// Limits for `branching` spheres: enough balls to choose from, few enough to be fast.
struct Budget {
  std::size_t first_points, least_balls, most_balls, insertions, inscribed;
  explicit Budget(std::size_t branching)
      : first_points(std::clamp<std::size_t>(12 * branching, 48, 192)),
        least_balls(std::clamp<std::size_t>(25 * branching, 64, 300)),
        most_balls(4 * least_balls),
        insertions(least_balls * 2 / 5),
        inscribed(first_points / 4) {}
};

class AdaptiveMedial {
 public:
  explicit AdaptiveMedial(const ReducerInput& node)
      : node_(node),
        columns_(node.samples),
        budget_(node.branching),
        box_(around(node.sphere)),
        diagram_(box_, node.shape.distance()) {
    nearest_point_.assign(node.samples.size(), 0);
    nearest_squared_.assign(node.samples.size(), infinity);
  }

  BallSet run() {
    std::vector<Vec3> first;
    const std::size_t step = std::max<std::size_t>(1, node_.samples.size() / budget_.first_points);
    for (std::size_t k = 0; k < node_.samples.size(); k += step) first.push_back(node_.samples[k]);
    add(first);
    refine();
    return result();
  }

 private:
  // Places where points may be added: the closest surface points of balls that reach into the node's sphere.
  static Box around(const Sphere& s) {
    const double reach = 2 * s.radius;
    Box box;
    box.add(s.center - Vec3{reach, reach, reach});
    box.add(s.center + Vec3{reach, reach, reach});
    return box;
  }

  struct Slot {
    SampleSet contains;
    bool usable = false;   // alive, finite, reaching into the node's sphere
    bool inner = false;    // center inside the object
    bool cover = false;    // taken from outside for samples in no inner ball
    bool blocked = false;  // its surface point cannot be added
    double protrusion = 0;
  };

  void add(std::span<const Vec3> points) {
    const std::size_t known = diagram_.samples().size();
    if (diagram_.insert(points) == 0) return;
    std::vector<double> squares(columns_.size());
    for (std::size_t p = known; p < diagram_.samples().size(); ++p) {
      columns_.squared_distances(diagram_.samples()[p], squares.data());
      for (std::size_t k = 0; k < squares.size(); ++k)
        if (squares[k] < nearest_squared_[k])
          nearest_squared_[k] = squares[k], nearest_point_[k] = static_cast<std::uint32_t>(p);
    }
    slots_.resize(diagram_.balls().size());
    for (const std::uint32_t s : diagram_.removed()) slots_[s] = {};
    InterruptPoller poll_interrupt(64);
    for (const std::uint32_t s : diagram_.created()) {
      poll_interrupt();
      slots_[s] = described(s);
    }
    choose_covers();
  }

  Slot described(std::uint32_t s) const {
    Slot slot;
    const VoronoiBall& b = diagram_.balls()[s];
    if (!b.alive || diagram_.is_far(s) || !std::isfinite(b.ball.radius)) return slot;
    const double reach = b.ball.radius + node_.sphere.radius;
    if (squared_distance(b.ball.center, node_.sphere.center) >= reach * reach) return slot;
    // Forming samples are on the ball up to the lattice's rounding.
    slot.contains = columns_.inside({b.ball.center, b.ball.radius * (1 + 1e-5)});
    slot.usable = !slot.contains.empty();
    slot.inner = diagram_.side(s) <= 0;
    if (slot.inner) slot.protrusion = protrusion(s);
    return slot;
  }

  double protrusion(std::uint32_t s) const {
    return std::max(0.0, diagram_.balls()[s].ball.radius + diagram_.distance(s));
  }

  // Samples in no inner ball promote one of the balls about their nearest point: the ball that sticks out furthest from
  // its center's side, so that it is the first to be replaced.
  void choose_covers() {
    SampleSet covered(node_.samples.size());
    for (Slot& s : slots_) {
      s.cover = false;
      if (s.usable && s.inner) covered |= s.contains;
    }
    for (std::size_t k = 0; k < node_.samples.size(); ++k) {
      if (covered.has(k)) continue;
      auto best = static_cast<std::uint32_t>(slots_.size());
      double most = -infinity;
      for (std::uint32_t s = 0; s < slots_.size(); ++s) {
        if (!slots_[s].usable || !slots_[s].contains.has(k)) continue;
        const VoronoiBall& b = diagram_.balls()[s];
        if (std::find(b.samples.begin(), b.samples.end(), nearest_point_[k]) == b.samples.end()) continue;
        const double depth = b.ball.radius - std::abs(diagram_.distance(s));
        if (depth > most) most = depth, best = s;
      }
      if (best == slots_.size()) continue;
      slots_[best].cover = true;
      slots_[best].protrusion = protrusion(best);
    }
  }

  bool is_medial(const Slot& s) const { return s.usable && (s.inner || s.cover); }

  void refine() {
    const double target = 0.5 * node_.shape.distance().protrusion_bound(node_.sphere);
    constexpr std::size_t points_at_once = 40;
    constexpr int most_rounds = 16;
    std::size_t inserted = 0;
    for (int round = 0; round < most_rounds && inserted < budget_.insertions; ++round) {
      std::size_t count = 0;
      std::vector<std::pair<double, std::uint32_t>> order;  // worst first, lower slots first among equals
      for (std::uint32_t s = 0; s < slots_.size(); ++s) {
        if (!is_medial(slots_[s])) continue;
        ++count;
        if (!slots_[s].blocked) order.emplace_back(-slots_[s].protrusion, s);
      }
      std::sort(order.begin(), order.end());
      std::vector<Vec3> points;
      std::vector<std::size_t> sources;
      for (const auto& [negative, s] : order) {
        if (points.size() == std::min(points_at_once, budget_.insertions - inserted)) break;
        if (-negative <= target && count >= budget_.least_balls) break;
        slots_[s].blocked = true;
        const Vec3 point = diagram_.closest(s).point;
        if (inside_box(point)) points.push_back(point);
      }
      if (points.empty()) return;
      inserted += points.size();
      add(points);
    }
  }
  bool inside_box(const Vec3& p) const {
    for (int axis = 0; axis < 3; ++axis)
      if (!(p[axis] >= box_.lower[axis] && p[axis] <= box_.upper[axis])) return false;
    return true;
  }

  // Adds balls inscribed at a part of the samples: they exist on flat parts also, where the diagram has none.
  void add_inscribed(std::vector<Sphere>& balls, std::vector<double>& distances) const {
    const std::size_t step = std::max<std::size_t>(1, node_.samples.size() / budget_.inscribed);
    std::vector<Vec3> points, normals;
    for (std::size_t k = 0; k < node_.samples.size(); k += step) {
      points.push_back(node_.samples[k]);
      normals.push_back(node_.normals[k]);
    }
    for (const Sphere& ball : shrunken_balls(node_.shape.distance(), points, normals, BallSharing::on_round_parts)) {
      balls.push_back(ball);
      distances.push_back(-ball.radius);
    }
  }

  BallSet result() const {
    std::vector<std::pair<double, std::uint32_t>> order;  // the one that sticks out least first
    for (std::uint32_t s = 0; s < slots_.size(); ++s)
      if (is_medial(slots_[s])) order.emplace_back(slots_[s].protrusion, s);
    std::sort(order.begin(), order.end());
    // Balls in the same place come from cospherical samples.
    std::vector<Sphere> balls;
    std::vector<double> distances;
    for (const auto& [protrusion, s] : order) {
      if (balls.size() == budget_.most_balls) break;
      const VoronoiBall& b = diagram_.balls()[s];
      const double same = 1e-5 * b.ball.radius;
      const bool known = std::any_of(balls.begin(), balls.end(), [&](const Sphere& other) {
        return squared_distance(other.center, b.ball.center) <= same * same;
      });
      if (known) continue;
      balls.push_back(b.ball);
      distances.push_back(diagram_.distance(s));
    }
    add_inscribed(balls, distances);
    return {std::move(balls), std::move(distances), node_.samples};
  }

  const ReducerInput& node_;
  SampleColumns columns_;
  Budget budget_;
  Box box_;
  VoronoiBalls diagram_;
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> nearest_point_;  // nearest point of each sample, among the diagram's
  std::vector<double> nearest_squared_;
};

}  // namespace

BallSet adaptive_medial(const ReducerInput& node) {
  if (node.samples.size() < 4 || !(node.sphere.radius > 0)) return {{}, {}, node.samples};
  return AdaptiveMedial(node).run();
}

}  // namespace morula::detail
