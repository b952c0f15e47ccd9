// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/child_state.hpp"

#include <array>
#include <bit>
#include <limits>
#include <numbers>
#include <utility>

#include "generators/fit/assignment.hpp"
#include "generators/fit/lattice.hpp"

namespace morula::detail {

bool FitCache::has_fit(std::size_t ball, const FitInputs& inputs, std::span<const GroupBall> balls) const {
  const Entry& own = entries_[ball];
  if (own.fitted == 0 || own.inputs != inputs) return false;
  // The search evaluated balls a little away from the one it found.
  const float near = 1.3F * balls[ball].radius;
  const auto is_near = [&](const GroupBall& other) {
    return distance_between(other.center, balls[ball].center) < near + other.radius;
  };
  for (std::size_t j = 0; j < entries_.size(); ++j) {
    if (j == ball || entries_[j].changed <= own.fitted) continue;
    if (is_near(balls[j]) || is_near(entries_[j].before)) return false;
  }
  return true;
}

void FitCache::note_fit(std::size_t ball, const GroupBall& before, const GroupBall& after, const FitInputs& inputs) {
  const bool same = after.center == before.center && after.radius == before.radius;
  if (!same) note_change(ball, before);
  entries_[ball].fitted = ++clock_;
  entries_[ball].inputs = inputs;
}

void FitCache::note_change(std::size_t ball, const GroupBall& before) {
  entries_[ball].before = before;
  entries_[ball].changed = ++clock_;
}

std::uint64_t WholeBalls::key(const GroupBall& b, const FitInputs& inputs) {
  std::uint64_t hash = inputs.points_hash;
  // mutant refused-split-whatever-it-costs: `b.cost, inputs` -> `inputs`
  for (const float number : {b.center.x, b.center.y, b.center.z, b.radius, b.cost, inputs.overlap_weight})
    hash = hash_mix(hash ^ std::bit_cast<std::uint32_t>(number));
  return hash;
}

namespace {

// Points to be split, and the frame that splits them.
struct SplitPoints {
  std::vector<Vec3> points;
  Axes axes;
  Vec3 mean{};

  SplitPoints(const GroupPoints& all, std::span<const std::uint32_t> members) {
    for (const std::uint32_t i : members) points.push_back({all.x[i], all.y[i], all.z[i]});
    axes = principal_axes(points);
    for (const Vec3& p : points) mean += p;
    mean = mean / static_cast<double>(points.size());
  }

  // Two means that begin on both sides along an axis. side: per point, 0 or 1. Returns false if all are on one side.
  bool two_means(std::size_t axis, double least_deviation, std::vector<std::uint8_t>& side) const {
    double squares = 0;
    for (const Vec3& p : points) squares += dot(p - mean, axes[axis]) * dot(p - mean, axes[axis]);
    const double deviation = std::sqrt(squares / static_cast<double>(points.size()));
    if (!(deviation > least_deviation)) return false;
    std::array<Vec3, 2> means{mean - axes[axis] * deviation, mean + axes[axis] * deviation};
    const int rounds = axis == 0 ? 4 : 1;
    for (int round = 0; round < rounds; ++round) {
      std::array<Vec3, 2> sums{};
      std::array<std::size_t, 2> counts{};
      for (std::size_t i = 0; i < points.size(); ++i) {
        side[i] = squared_distance(points[i], means[1]) < squared_distance(points[i], means[0]) ? 1 : 0;
        sums[side[i]] += points[i];
        ++counts[side[i]];
      }
      if (counts[0] == 0 || counts[1] == 0) return false;
      for (std::size_t s = 0; s < 2; ++s) means[s] = sums[s] / static_cast<double>(counts[s]);
    }
    return true;
  }
};

}  // namespace

void PlacedBalls::lift(std::size_t i) {
  if (is_placed_[i] != 0) grid_.remove(balls_[i].sphere());
  is_placed_[i] = 0;
}

void PlacedBalls::place(std::size_t i, const GroupBall& ball) {
  const bool same = ball.center == balls_[i].center && ball.radius == balls_[i].radius;
  if (!(same && is_placed_[i] != 0)) lift(i);
  balls_[i] = ball;
  if (is_placed_[i] != 0 || !(ball.radius > 0)) return;
  grid_.add(ball.sphere());
  is_placed_[i] = 1;
}

ChildState::Snapshot ChildState::snapshot() const {
  const std::span<const GroupBall> balls = balls_;
  return {{balls.begin(), balls.end()}, assignment_.owners(), fits_};
}

void ChildState::restore(const Snapshot& snapshot) {
  for (std::size_t b = 0; b < max_balls(); ++b) balls_.place(b, snapshot.balls[b]);
  assignment_.set_owners(snapshot.owners);
  fits_ = snapshot.fits;
}

void ChildState::set_balls(std::span<const GroupBall> balls) {
  for (std::size_t b = 0; b < max_balls(); ++b) balls_.lift(b);
  for (std::size_t b = 0; b < max_balls(); ++b) balls_.place(b, b < balls.size() ? balls[b] : GroupBall{});
  fits_ = FitCache(max_balls());
}

void ChildState::gather(std::size_t ball) {
  const GroupPoints& points = assignment_.points();
  own_index_.clear();
  assignment_.each_owned(ball, [&](std::size_t i) { own_index_.push_back(static_cast<std::uint32_t>(i)); });
  for (const auto& [own, all] : {std::pair(&own_.x, &points.x), {&own_.y, &points.y}, {&own_.z, &points.z}}) {
    own->resize(own_index_.size());
    for (std::size_t k = 0; k < own_index_.size(); ++k) (*own)[k] = (*all)[own_index_[k]];
  }
}

void ChildState::place_fit(std::size_t ball, const GroupBall& fitted, float overlap_weight) {
  fits_.note_fit(ball, balls_[ball], fitted, fit_inputs(ball, overlap_weight));
  balls_.place(ball, fitted);
}

void ChildState::recenter(std::size_t ball, float overlap_weight, float first_step) {
  const bool is_used = assignment_.is_used(ball);
  if (is_used && fits_.has_fit(ball, fit_inputs(ball, overlap_weight), balls_)) return;
  if (!is_used) return place_fit(ball, {}, overlap_weight);
  balls_.lift(ball);
  gather(ball);
  place_fit(ball, fit_ball(grid(), own_, {&balls_[ball].center, 1}, overlap_weight, first_step), overlap_weight);
}

GroupBall ChildState::fit_to(const GroupPoints& points, std::span<const Vec3f> starts, float overlap_weight) {
  std::size_t nearest = 0;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t b = 0; b < max_balls(); ++b)
    if (const float d = distance_between(balls_[b].center, starts[0]); balls_[b].radius > 0 && d < least)
      least = d, nearest = b;
  balls_.lift(nearest);
  const GroupBall fitted = fit_ball(grid(), points, starts, overlap_weight, 0.12F);
  balls_.place(nearest, balls_[nearest]);
  return fitted;
}

void ChildState::give_what_others_contain(std::size_t ball) {
  gather(ball);
  const float reach = farthest_from(own_, balls_[ball].center) * (1 + 1e-5F);
  std::vector<std::size_t> near;
  for (std::size_t j = 0; j < max_balls(); ++j) {
    if (j == ball || !(balls_[j].radius > 0)) continue;
    if (distance_between(balls_[j].center, balls_[ball].center) * (1 - 1e-5F) <= reach + balls_[j].radius)
      near.push_back(j);
  }
  if (near.empty()) return;
  // Siblings are numbered from 1 on: a point at which none has a power below 0 stays with number 0, the ball itself,
  // and so does one where a power is just 0.
  std::vector<float> least(own_.size(), 0.0F);
  std::vector<std::uint32_t> owners(own_.size(), 0);
  for (std::size_t n = 0; n < near.size(); ++n) {
    const GroupBall& other = balls_[near[n]];
    fit_kernels().offer(own_.columns(), other.center, other.radius * other.radius * (1 - 1e-5F),
                        static_cast<std::uint32_t>(n + 1), {least.data(), owners.data()});
  }
  for (std::size_t k = 0; k < own_.size(); ++k)
    if (owners[k] != 0) assignment_.set_owner(own_index_[k], near[owners[k] - 1]);
}

bool ChildState::split(std::size_t ball, std::size_t into, float overlap_weight, float max_cost_factor) {
  const GroupBall before = balls_[ball];
  gather(ball);
  const std::vector<std::uint32_t> members = own_index_;
  balls_.lift(ball);
  const float max_cost = max_cost_factor * before.cost;
  const Halves halves = cheapest_halves(members, before, overlap_weight, max_cost);
  if (!(halves.cost < max_cost)) {
    balls_.place(ball, before);
    return false;
  }
  for (std::size_t i = 0; i < members.size(); ++i)
    if (halves.side[i] == 1) assignment_.set_owner(members[i], into);
  place_fit(ball, halves.one, overlap_weight);
  place_fit(into, halves.other, overlap_weight);
  return true;
}

// Tries all three axes and returns the halves that cost least: on a tube, only the axis of least variance separates
// rings.
ChildState::Halves ChildState::cheapest_halves(std::span<const std::uint32_t> members, const GroupBall& before,
                                               float overlap_weight, float max_cost) {
  const SplitPoints split_points(assignment_.points(), members);
  Halves best{{}, {}, {}, std::numeric_limits<float>::infinity()};
  std::vector<std::uint8_t> side(members.size());
  const auto half = [&](std::size_t s) {
    own_.clear();
    for (std::size_t i = 0; i < members.size(); ++i)
      if (side[i] == s) own_.push_back(assignment_.points()[members[i]]);
    // The search starts from the old center as well: if the points are a shallow patch, it finds balls that reach deep
    // inside only from there.
    return fit_ball(grid(), own_, {&before.center, 1}, overlap_weight, 0.25F, 0.03F);
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!split_points.two_means(axis, 1e-6 * before.radius, side)) continue;
    const GroupBall one = half(0);
    if (!(one.cost < std::min(best.cost, max_cost))) continue;  // no pair with it is better
    grid().add(one.sphere());
    const GroupBall other = half(1);
    grid().remove(one.sphere());
    if (one.cost + other.cost < best.cost) best = {one, other, side, one.cost + other.cost};
  }
  return best;
}

void ChildState::remove(std::size_t ball) {
  const GroupBall before = balls_[ball];
  std::vector<std::pair<std::size_t, std::size_t>> given;  // the owners are being read, so changes wait here
  radii_without(ball, [&](std::size_t i, std::size_t to) { given.emplace_back(i, to); });
  for (const auto& [point, to] : given) assignment_.set_owner(point, to);
  balls_.place(ball, {});
  fits_.note_change(ball, before);
}

// A ball that is far away has to grow by more for the nearest of the points than the best near ball does for the
// farthest one, so it never grows least. The result is the other balls.
std::vector<std::size_t> ChildState::neighbors_within_growth(std::size_t ball) const {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const GroupPoints& points = assignment_.points();
  float around = 0;
  assignment_.each_owned(
      ball, [&](std::size_t i) { around = std::max(around, distance_between(points[i], balls_[ball].center)); });
  float enough = infinity;
  std::vector<float> away(max_balls(), infinity);
  for (std::size_t j = 0; j < max_balls(); ++j) {
    if (j == ball || !assignment_.is_used(j)) continue;
    away[j] = distance_between(balls_[j].center, balls_[ball].center);
    enough = std::min(enough, away[j] + around - balls_[j].radius);
  }
  std::vector<std::size_t> near;
  for (std::size_t j = 0; j < max_balls(); ++j)
    if (away[j] < infinity && away[j] - around - balls_[j].radius <= enough + 1e-4F * (away[j] + around))
      near.push_back(j);
  return near;
}

// The radii that siblings would need if the ball were gone and each of its points went to the one that grows least.
// Calls give(point, sibling) for each point that finds one.
template <class Give>
std::vector<float> ChildState::radii_without(std::size_t ball, const Give& give) const {
  const GroupPoints& points = assignment_.points();
  std::vector<float> reach(max_balls());
  for (std::size_t j = 0; j < max_balls(); ++j) reach[j] = balls_[j].radius;
  const std::vector<std::size_t> near = neighbors_within_growth(ball);
  assignment_.each_owned(ball, [&](std::size_t i) {
    float growth = std::numeric_limits<float>::infinity(), needed = 0;
    std::size_t to = ball;
    for (const std::size_t j : near) {
      const float d = distance_between(points[i], balls_[j].center);
      if (d - reach[j] < growth) growth = d - reach[j], to = j, needed = d;
    }
    if (to == ball) return;
    reach[to] = std::max(reach[to], needed);
    give(i, to);
  });
  return reach;
}

float ChildState::growth_without(std::size_t ball) const {
  constexpr float unit_volume = static_cast<float>(4.0 / 3.0 * std::numbers::pi);
  const auto cube_of = [](float x) { return x * x * x; };
  const std::vector<float> reach = radii_without(ball, [](std::size_t, std::size_t) {});
  float grown = 0;
  for (std::size_t j = 0; j < max_balls(); ++j)
    if (j != ball && assignment_.is_used(j)) grown += unit_volume * (cube_of(reach[j]) - cube_of(balls_[j].radius));
  return grown;
}

}  // namespace morula::detail
