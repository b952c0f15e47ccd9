// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/child_fit.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "generators/fit/fit_kernels.hpp"
#include "generators/fit/lattice.hpp"
#include "geometry/each_bit.hpp"

namespace morula::detail {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float unit_ball_volume = static_cast<float>(4.0 / 3.0 * std::numbers::pi);

std::uint64_t mixed(std::uint64_t i) {
  return Random(i).next();
}
float distance_between(const Vec3f& a, const Vec3f& b) {
  const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return std::sqrt(x * x + y * y + z * z);
}
float cube(float x) {
  return x * x * x;
}
Spheref sphere_of(const GroupBall& b) {
  return {b.center, b.radius};
}

}  // namespace

Group::Group(OutsideGrid& grid, const GroupPoints& points, const ObjectShape& shape, std::size_t most,
             const Sphere& start, const Settings& settings, std::uint64_t seed)
    : grid_(grid),
      points_(points),
      shape_(shape),
      most_(most),
      start_{grid.to_grid(start.center), static_cast<float>(start.radius / grid.cell()), 0},
      settings_(settings),
      random_(seed),
      balls_(most),
      owner_(points.size(), 0),
      count_(most, 0),
      demand_(most, 0),
      points_hash_(most, 0),
      fits_(most),
      refused_(most, 0),
      powered_(most),
      powers_(points.size(), infinity),
      power_owner_(points.size(), 0) {
  for (std::size_t i = 0; i < points.size(); ++i) mixed_.push_back(mixed(i));
}

// Points of a ball in ascending order.
template <class Visit>
void Group::each_owned(std::size_t ball, const Visit& visit) const {
  constexpr std::size_t some = 4096;
  std::array<std::uint64_t, some / 64> bits;
  for (std::size_t begin = 0; begin < owner_.size(); begin += some) {
    const std::size_t count = std::min(some, owner_.size() - begin);
    fit_kernels().equal(owner_.data() + begin, count, static_cast<std::uint8_t>(ball), bits.data());
    each_bit(std::span(bits).first((count + 63) / 64), [&](std::size_t i) { visit(begin + i); });
  }
}

void Group::recount() {
  std::fill(count_.begin(), count_.end(), 0u);
  std::fill(demand_.begin(), demand_.end(), 0.0F);
  std::fill(points_hash_.begin(), points_hash_.end(), 0u);
  for (std::size_t i = 0; i < owner_.size(); ++i) {
    ++count_[owner_[i]];
    points_hash_[owner_[i]] += mixed_[i];
    if (!points_.demand.empty()) demand_[owner_[i]] += points_.demand[i];
  }
}

void Group::clear_grid() {
  for (const GroupBall& b : balls_)
    if (b.radius > 0) grid_.remove(sphere_of(b));
}

void Group::restore(const State& state) {
  for (std::size_t b = 0; b < most_; ++b) {
    const GroupBall &now = balls_[b], &then = state.balls[b];
    if (now.center == then.center && now.radius == then.radius) continue;
    if (now.radius > 0) grid_.remove(sphere_of(now));
    if (then.radius > 0) grid_.add(sphere_of(then));
  }
  balls_ = state.balls;
  owner_ = state.owner;
  fits_ = state.fits;
  recount();
}

void Group::gather(std::size_t ball) {
  own_index_.clear();
  each_owned(ball, [&](std::size_t i) { own_index_.push_back(static_cast<std::uint32_t>(i)); });
  for (const auto& [own, all] : {std::pair(&own_.x, &points_.x), {&own_.y, &points_.y}, {&own_.z, &points_.z}}) {
    own->resize(own_index_.size());
    for (std::size_t k = 0; k < own_index_.size(); ++k) (*own)[k] = (*all)[own_index_[k]];
  }
}

bool Group::fits_already(std::size_t ball, float taken) const {
  const Fit& last = fits_[ball];
  if (last.points != points_hash_[ball] || last.taken != taken || last.fitted == 0) return false;
  for (std::size_t j = 0; j < most_; ++j) {
    if (j == ball || fits_[j].changed <= last.fitted) continue;
    const float near = 1.3F * balls_[ball].radius;
    if (distance_between(balls_[j].center, balls_[ball].center) < near + balls_[j].radius) return false;
    if (distance_between(fits_[j].before.center, balls_[ball].center) < near + fits_[j].before.radius) return false;
  }
  return true;
}

void Group::place(std::size_t ball, const GroupBall& fitted, float taken) {
  const bool same = fitted.center == balls_[ball].center && fitted.radius == balls_[ball].radius;
  if (!same) fits_[ball].before = balls_[ball];
  balls_[ball] = fitted;
  if (fitted.radius > 0) grid_.add(sphere_of(fitted));
  if (!same) fits_[ball].changed = ++clock_;
  fits_[ball].fitted = ++clock_;
  fits_[ball].points = points_hash_[ball];
  fits_[ball].taken = taken;
}

void Group::refit(std::size_t ball, float taken, float first_step) {
  if (count_[ball] > 0 && fits_already(ball, taken)) return;
  if (balls_[ball].radius > 0) grid_.remove(sphere_of(balls_[ball]));
  if (count_[ball] == 0) return place(ball, {}, taken);
  gather(ball);
  place(ball, fit_ball(grid_, own_, {&balls_[ball].center, 1}, taken, first_step), taken);
}

std::uint64_t Group::hash_of(std::size_t ball, float taken) const {
  const GroupBall& b = balls_[ball];
  std::uint64_t hash = points_hash_[ball];
  // mutant refused-split-whatever-it-costs: `b.cost, taken` -> `taken`
  for (const float number : {b.center.x, b.center.y, b.center.z, b.radius, b.cost, taken})
    hash = mixed(hash ^ std::bit_cast<std::uint32_t>(number));
  return hash;
}

float Group::key(std::size_t ball) const {
  // Demand that is uneven makes uneven children: what balance adds is shared out by square.
  if (points_.demand.empty()) return balls_[ball].cost;
  const float scale = static_cast<float>(std::max(0.0, scale_));
  return balls_[ball].cost + settings_.balance * scale * demand_[ball] * demand_[ball] * static_cast<float>(most_);
}

double Group::imbalance() const {
  if (points_.demand.empty() || settings_.balance == 0) return 0;
  double sum = 0;
  for (const float d : demand_) sum += static_cast<double>(d) * d;
  return sum * static_cast<double>(most_);
}

double Group::objective() {
  std::vector<Spheref> spheres;
  for (const GroupBall& b : balls_)
    if (b.radius > 0) spheres.push_back(sphere_of(b));
  const double sum = grid_.outside_together(spheres);
  if (scale_ < 0) scale_ = sum;
  return sum + settings_.balance * scale_ * imbalance();
}

void Group::split_from_one() {
  clear_grid();
  std::fill(balls_.begin(), balls_.end(), GroupBall{});
  std::fill(fits_.begin(), fits_.end(), Fit{});
  std::fill(owner_.begin(), owner_.end(), std::uint8_t{0});
  recount();
  balls_[0].center = start_.center;
  refit(0, settings_.taken_while_splitting, 0.25F);
  scale_ = balls_[0].cost / 4;
  fill(settings_.taken_while_splitting);
  scale_ = -1;
}

void Group::take_in_grid(std::span<const GroupBall> balls) {
  clear_grid();
  std::fill(balls_.begin(), balls_.end(), GroupBall{});
  std::fill(fits_.begin(), fits_.end(), Fit{});
  std::vector<float> squares(most_, -1);
  for (std::size_t i = 0; i < std::min(most_, balls.size()); ++i) {
    balls_[i] = balls[i];
    grid_.add(sphere_of(balls_[i]));
    squares[i] = balls_[i].radius * balls_[i].radius;
  }
  assign_by_power(squares);
}

std::vector<GroupBall> Group::in_grid(std::span<const Sphere> balls) const {
  std::vector<GroupBall> result;
  for (const Sphere& s : balls)
    result.push_back({grid_.to_grid(s.center), std::max(1e-4F, static_cast<float>(s.radius / grid_.cell())), 0});
  return result;
}

void Group::take(std::span<const Sphere> balls, bool fill_places) {
  fill_places_ = fill_places;
  take_in_grid(in_grid(balls));
}

// squared_radii: negative for balls that get nothing. Of balls with equal power the first owns the point.
void Group::assign_by_power(std::span<const float> squared_radii) {
  std::vector<std::size_t> changed, members;
  std::vector<std::uint8_t> is_changed(most_, 0);
  for (std::size_t b = 0; b < most_; ++b) {
    if (!(squared_radii[b] < 0)) members.push_back(b);
    Powered& last = powered_[b];
    if (last.square < 0 && squared_radii[b] < 0) continue;
    if (last.center == balls_[b].center && last.square == squared_radii[b]) continue;
    last = {balls_[b].center, squared_radii[b]};
    changed.push_back(b);
    is_changed[b] = 1;
  }
  if (members.empty()) {
    std::fill(powered_.begin(), powered_.end(), Powered{});
    return recount();
  }
  const auto offer = [&](std::size_t b, const PointColumns& points, const PowerOwners& owners) {
    fit_kernels().offer(points, balls_[b].center, squared_radii[b], static_cast<std::uint32_t>(b), owners);
  };
  constexpr std::size_t block = 1024;
  // Most changes move a few balls only: points of the others just have to be told of those.
  const bool all = 2 * changed.size() > most_;
  if (all) {
    std::fill(powers_.begin(), powers_.end(), infinity);
    std::fill(power_owner_.begin(), power_owner_.end(), std::uint32_t{0});
    for (std::size_t begin = 0; begin < points_.size(); begin += block) {
      const std::size_t count = std::min(block, points_.size() - begin);
      const PointColumns some{&points_.x[begin], &points_.y[begin], &points_.z[begin], count};
      for (const std::size_t b : members) offer(b, some, {&powers_[begin], &power_owner_[begin]});
    }
  } else {
    std::array<float, block> x, y, z, least;
    std::array<std::uint32_t, block> owner, index;
    std::size_t open = 0;
    const auto decide = [&] {
      std::fill_n(least.begin(), open, infinity);
      std::fill_n(owner.begin(), open, 0u);
      if (open > 0)
        for (const std::size_t b : members)
          offer(b, {x.data(), y.data(), z.data(), open}, {least.data(), owner.data()});
      for (std::size_t i = 0; i < open; ++i) {
        powers_[index[i]] = least[i];
        power_owner_[index[i]] = owner[i];
      }
      open = 0;
    };
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (is_changed[power_owner_[i]] == 0) continue;
      x[open] = points_.x[i], y[open] = points_.y[i], z[open] = points_.z[i];
      index[open] = static_cast<std::uint32_t>(i);
      if (++open == block) decide();
    }
    decide();
    for (const std::size_t b : changed)
      if (!(squared_radii[b] < 0)) offer(b, points_.columns(), {powers_.data(), power_owner_.data()});
  }
  for (std::size_t i = 0; i < owner_.size(); ++i) owner_[i] = static_cast<std::uint8_t>(power_owner_[i]);
  recount();
}

// What siblings contain anyway is theirs: the ball keeps what only it contains.
void Group::give_what_others_contain(std::size_t ball) {
  gather(ball);
  const float reach = farthest_from(own_, balls_[ball].center) * (1 + 1e-5F);
  std::vector<std::size_t> near;
  for (std::size_t j = 0; j < most_; ++j) {
    if (j == ball || !(balls_[j].radius > 0)) continue;
    if (distance_between(balls_[j].center, balls_[ball].center) * (1 - 1e-5F) <= reach + balls_[j].radius)
      near.push_back(j);
  }
  if (near.empty()) return;
  // Siblings are numbered from 1 on: a point where none has a power below 0 stays with number 0, the ball itself, and
  // so does one where a power is just 0.
  std::vector<float> least(own_.size(), 0.0F);
  std::vector<std::uint32_t> owners(own_.size(), 0);
  for (std::size_t n = 0; n < near.size(); ++n) {
    const GroupBall& other = balls_[near[n]];
    fit_kernels().offer(own_.columns(), other.center, other.radius * other.radius * (1 - 1e-5F),
                        static_cast<std::uint32_t>(n + 1), {least.data(), owners.data()});
  }
  for (std::size_t k = 0; k < own_.size(); ++k) {
    if (owners[k] == 0) continue;
    const std::size_t to = near[owners[k] - 1];
    const std::uint32_t i = own_index_[k];
    owner_[i] = static_cast<std::uint8_t>(to);
    --count_[ball];
    ++count_[to];
    points_hash_[ball] -= mixed_[i];
    points_hash_[to] += mixed_[i];
  }
}

void Group::sweep(float taken, bool exclusive) {
  std::vector<float> squares(most_, -1);
  for (std::size_t b = 0; b < most_; ++b)
    if (balls_[b].radius > 0) squares[b] = balls_[b].radius * balls_[b].radius;
  assign_by_power(squares);

  std::vector<std::size_t> order(most_);
  for (std::size_t b = 0; b < most_; ++b) order[b] = b;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return balls_[a].cost > balls_[b].cost; });
  for (const std::size_t b : order) {
    if (count_[b] == 0) {
      refit(b, taken, 0);
      continue;
    }
    if (exclusive) give_what_others_contain(b);
    refit(b, taken, 0.12F);
  }
  recount();
  fill(taken);
}

void Group::sweep_inscribed(float taken) {
  std::vector<float> squares(most_, -1);
  for (std::size_t b = 0; b < most_; ++b) {
    if (!(balls_[b].radius > 0)) continue;
    const double inside = -shape_.distance()(grid_.from_grid(balls_[b].center)) / grid_.cell();
    const float inscribed = std::clamp(static_cast<float>(inside), 0.0F, balls_[b].radius);
    squares[b] = inscribed * inscribed;
  }
  assign_by_power(squares);
  for (std::size_t b = 0; b < most_; ++b) refit(b, taken, 0.12F);
  fill(taken);
}

void Group::fill(float taken) {
  if (!fill_places_) return;
  std::fill(refused_.begin(), refused_.end(), std::uint8_t{0});
  for (std::size_t into = 0; into < most_; ++into) {
    if (used(into)) continue;
    for (;;) {
      std::size_t from = most_;
      for (std::size_t b = 0; b < most_; ++b)
        if (count_[b] > 1 && refused_[b] == 0 && (from == most_ || key(b) > key(from))) from = b;
      if (from == most_) return;
      // Around a tube most balls are better whole, and are asked about again after every change.
      constexpr float most_cost_factor = 1.5F;
      const std::uint64_t as_it_is = hash_of(from, taken);
      const bool is_asked = settings_.asks_again || !better_whole_.contains(as_it_is);
      if (is_asked && split(from, into, taken, most_cost_factor)) break;
      better_whole_.insert(as_it_is);
      refused_[from] = 1;
    }
  }
}

// Two balls for one: its points fall apart along one of their principal axes, whichever costs least. (The axis of least
// variance is what divides rings on a tube.)
bool Group::split(std::size_t ball, std::size_t into, float taken, float most_cost_factor) {
  const GroupBall before = balls_[ball];
  gather(ball);
  const std::vector<std::uint32_t> members = own_index_;
  std::vector<Vec3> points;
  for (const std::uint32_t i : members) points.push_back({points_.x[i], points_.y[i], points_.z[i]});
  const Axes axes = principal_axes(points);
  Vec3 mean{};
  for (const Vec3& p : points) mean += p;
  mean = mean / static_cast<double>(points.size());

  grid_.remove(sphere_of(before));
  GroupBall best_one, best_other;
  std::vector<std::uint8_t> best_side;
  float least = infinity;
  std::vector<std::uint8_t> side(members.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double squares = 0;
    for (const Vec3& p : points) squares += dot(p - mean, axes[axis]) * dot(p - mean, axes[axis]);
    const double sigma = std::sqrt(squares / static_cast<double>(points.size()));
    if (!(sigma > 1e-6 * before.radius)) continue;
    std::array<Vec3, 2> means{mean - axes[axis] * sigma, mean + axes[axis] * sigma};
    std::array<std::size_t, 2> counts{};
    const int rounds = axis == 0 ? 4 : 1;
    for (int round = 0; round < rounds; ++round) {
      std::array<Vec3, 2> sums{};
      counts = {};
      for (std::size_t i = 0; i < points.size(); ++i) {
        side[i] = squared_distance(points[i], means[1]) < squared_distance(points[i], means[0]) ? 1 : 0;
        sums[side[i]] += points[i];
        ++counts[side[i]];
      }
      if (counts[0] == 0 || counts[1] == 0) break;
      for (std::size_t s = 0; s < 2; ++s) means[s] = sums[s] / static_cast<double>(counts[s]);
    }
    if (counts[0] == 0 || counts[1] == 0) continue;
    const auto half = [&](std::size_t s) {
      own_.clear();
      for (std::size_t i = 0; i < members.size(); ++i)
        if (side[i] == s) own_.push_back(points_[members[i]]);
      // The old centre is deep where the new points are a shallow patch: without it no split finds deep balls.
      return fit_ball(grid_, own_, {&before.center, 1}, taken, 0.25F, 0.03F);
    };
    const GroupBall one = half(0);
    if (!(one.cost < std::min(least, most_cost_factor * before.cost))) continue;  // no pair with it is better
    grid_.add(sphere_of(one));
    const GroupBall other = half(1);
    grid_.remove(sphere_of(one));
    if (one.cost + other.cost < least) {
      least = one.cost + other.cost;
      best_one = one;
      best_other = other;
      best_side = side;
    }
  }
  if (!(least < most_cost_factor * before.cost)) {
    grid_.add(sphere_of(before));
    return false;
  }
  for (std::size_t i = 0; i < members.size(); ++i)
    if (best_side[i] == 1) owner_[members[i]] = static_cast<std::uint8_t>(into);
  recount();
  place(ball, best_one, taken);
  place(into, best_other, taken);
  return true;
}

// What siblings would have to reach if a ball were gone and each of its points went to the one that grows least.
template <class Give>
std::vector<float> Group::reach_without(std::size_t ball, const Give& give) const {
  std::vector<float> reach(most_);
  for (std::size_t j = 0; j < most_; ++j) reach[j] = balls_[j].radius;
  // Only balls near by can be the one that grows least: the others would have to grow by more than the best of them
  // even for the point that is nearest to them.
  float around = 0;
  each_owned(ball,
             [&](std::size_t i) { around = std::max(around, distance_between(points_[i], balls_[ball].center)); });
  float enough = infinity;
  std::vector<float> away(most_, infinity);
  for (std::size_t j = 0; j < most_; ++j) {
    if (j == ball || !used(j)) continue;
    away[j] = distance_between(balls_[j].center, balls_[ball].center);
    enough = std::min(enough, away[j] + around - balls_[j].radius);
  }
  std::vector<std::size_t> near;
  for (std::size_t j = 0; j < most_; ++j)
    if (away[j] < infinity && away[j] - around - balls_[j].radius <= enough + 1e-4F * (away[j] + around))
      near.push_back(j);
  each_owned(ball, [&](std::size_t i) {
    float growth = infinity, needed = 0;
    std::size_t to = ball;
    for (const std::size_t j : near) {
      const float d = distance_between(points_[i], balls_[j].center);
      if (d - reach[j] < growth) growth = d - reach[j], to = j, needed = d;
    }
    if (to == ball) return;
    reach[to] = std::max(reach[to], needed);
    give(i, to);
  });
  return reach;
}

float Group::growth_without(std::size_t ball) const {
  const std::vector<float> reach = reach_without(ball, [](std::size_t, std::size_t) {});
  float grown = 0;
  for (std::size_t j = 0; j < most_; ++j)
    if (j != ball && used(j)) grown += unit_ball_volume * (cube(reach[j]) - cube(balls_[j].radius));
  return grown;
}

// Removes the ball that is missed least and splits the one that costs most.
void Group::teleport(std::vector<float>& missed) {
  if (missed.empty()) {
    missed.resize(most_);
    for (std::size_t b = 0; b < most_; ++b)
      if (used(b)) missed[b] = growth_without(b);
  }
  std::size_t gone = most_;
  float least = infinity;
  for (std::size_t b = 0; b < most_; ++b) {
    if (!used(b)) continue;
    const float loss = (0.5F * missed[b] - balls_[b].cost) * (1 + 0.6F * static_cast<float>(random_.uniform()));
    if (loss < least) least = loss, gone = b;
  }
  std::size_t from = most_;
  float largest = -1;
  for (std::size_t b = 0; b < most_; ++b) {
    if (!used(b) || b == gone || count_[b] < 2) continue;
    const float k = key(b) * (0.4F + static_cast<float>(random_.uniform()));
    if (k > largest) largest = k, from = b;
  }
  if (gone == most_ || from == most_) return;
  grid_.remove(sphere_of(balls_[gone]));
  std::vector<std::uint8_t> owner = owner_;
  reach_without(gone, [&](std::size_t i, std::size_t to) { owner[i] = static_cast<std::uint8_t>(to); });
  owner_ = std::move(owner);
  fits_[gone].before = balls_[gone];
  balls_[gone] = {};
  fits_[gone].changed = ++clock_;
  recount();
  split(from, gone, settings_.taken, infinity);
}

// Moves the walls between one ball and its siblings by a share of the ball's part, and fits what that changes.
void Group::nudge() {
  std::vector<float> squares(most_, -1);
  std::vector<std::size_t> members;
  for (std::size_t b = 0; b < most_; ++b) {
    if (!(balls_[b].radius > 0)) continue;
    squares[b] = balls_[b].radius * balls_[b].radius;
    if (used(b)) members.push_back(b);
  }
  if (members.size() < 2) return;
  const std::size_t ball = members[std::min(
      members.size() - 1, static_cast<std::size_t>(random_.uniform() * static_cast<double>(members.size())))];
  float nearest = infinity;
  for (const std::size_t j : members)
    if (j != ball) nearest = std::min(nearest, distance_between(balls_[ball].center, balls_[j].center));
  constexpr float amount = 0.12F;
  const float shift = amount * settings_.part * (2 * static_cast<float>(random_.uniform()) - 1);
  squares[ball] += 2 * nearest * shift;
  assign_by_power(squares);
  for (std::size_t b = 0; b < most_; ++b) refit(b, settings_.taken, 0.06F);
}

void Group::try_changes(int count, int move_every) {
  if (count <= 0) return;
  State best = snapshot();
  double least = objective();
  std::vector<float> missed;  // in that state
  for (int trial = 0; trial < count; ++trial) {
    if (trial % move_every != 0) {
      nudge();
    } else {
      teleport(missed);
      sweep(settings_.taken, true);
      sweep(settings_.taken, true);
    }
    if (const double now = objective(); now < least) {
      least = now;
      best = snapshot();
      missed.clear();
    } else {
      restore(best);
    }
  }
}

void Group::try_inscribed(int inscribed_sweeps, int sweeps) {
  const State before = snapshot();
  const double least = objective();
  for (int i = 0; i < inscribed_sweeps; ++i) sweep_inscribed(settings_.taken);
  for (int i = 0; i < sweeps; ++i) sweep(settings_.taken, true);
  if (!(objective() < least)) restore(before);
}

void Group::try_seeds(std::span<const GroupBall> seeds, int inscribed_sweeps, int sweeps) {
  const State before = snapshot();
  const double least = objective();
  take_in_grid(seeds);
  for (std::size_t b = 0; b < most_; ++b) refit(b, settings_.taken, 0.12F);
  for (int i = 0; i < inscribed_sweeps; ++i) sweep_inscribed(settings_.taken);
  for (int i = 0; i < sweeps; ++i) sweep(settings_.taken, true);
  if (!(objective() < least)) restore(before);
}

void Group::try_spheres(std::span<const Sphere> balls, int sweeps) {
  if (!balls.empty()) try_seeds(in_grid(balls), 0, sweeps);
}

GroupBall Group::refit_to(GroupPoints points, std::span<const Vec3f> starts) {
  std::size_t nearest = 0;
  float least = infinity;
  for (std::size_t b = 0; b < most_; ++b)
    if (const float d = distance_between(balls_[b].center, starts[0]); balls_[b].radius > 0 && d < least)
      least = d, nearest = b;
  own_ = std::move(points);
  if (balls_[nearest].radius > 0) grid_.remove(sphere_of(balls_[nearest]));
  const GroupBall fitted = fit_ball(grid_, own_, starts, settings_.taken, 0.12F);
  if (balls_[nearest].radius > 0) grid_.add(sphere_of(balls_[nearest]));
  return fitted;
}

std::vector<Sphere> Group::spheres() const {
  std::vector<Sphere> result;
  for (std::size_t b = 0; b < most_; ++b)
    if (used(b)) result.push_back({grid_.from_grid(balls_[b].center), balls_[b].radius * grid_.cell()});
  return result;
}

}  // namespace morula::detail
