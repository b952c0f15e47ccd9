// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/child_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace morula::detail {

ChildFit::ChildFit(OutsideGrid& grid, const GroupPoints& points, const ObjectShape& shape, std::size_t max_balls,
                   const Sphere& start, const Settings& settings, std::uint64_t seed)
    : state_(grid, points, max_balls),
      shape_(shape),
      start_(grid.to_grid(start.center)),
      settings_(settings),
      random_(seed) {}

void ChildFit::split_from_one() {
  const GroupBall first{start_, 0, 0};
  state_.set_balls({&first, 1});
  state_.give_all_to_first();
  state_.recenter(0, settings_.overlap_weight_while_splitting, 0.25F);
  balance_scale_ = balls()[0].cost / 4;
  fill(settings_.overlap_weight_while_splitting);
  balance_scale_ = -1;
}

void ChildFit::start_from_grid(std::span<const GroupBall> balls) {
  balls = balls.first(std::min(max_balls(), balls.size()));
  std::vector<float> squares(max_balls(), -1);
  for (std::size_t i = 0; i < balls.size(); ++i) squares[i] = balls[i].radius * balls[i].radius;
  state_.set_balls(balls);
  state_.assign_by_power(squares);
}

std::vector<GroupBall> ChildFit::in_grid(std::span<const Sphere> balls) const {
  const OutsideGrid& grid = state_.grid();
  std::vector<GroupBall> result;
  for (const Sphere& s : balls)
    result.push_back({grid.to_grid(s.center), std::max(1e-4F, static_cast<float>(s.radius / grid.cell())), 0});
  return result;
}

void ChildFit::start_from(std::span<const Sphere> balls, bool fill_places) {
  fill_places_ = fill_places;
  start_from_grid(in_grid(balls));
}

// Squared radii; negative: no ball.
std::vector<float> ChildFit::squared_radii() const {
  std::vector<float> squares(max_balls(), -1);
  for (std::size_t b = 0; b < max_balls(); ++b)
    if (balls()[b].radius > 0) squares[b] = balls()[b].radius * balls()[b].radius;
  return squares;
}

void ChildFit::sweep(float overlap_weight, bool exclusive) {
  state_.assign_by_power(squared_radii());
  std::vector<std::size_t> order(max_balls());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return balls()[a].cost > balls()[b].cost; });
  for (const std::size_t b : order) {
    if (exclusive && is_used(b)) state_.give_what_others_contain(b);
    state_.recenter(b, overlap_weight, 0.12F);
  }
  fill(overlap_weight);
}

void ChildFit::sweep_inscribed(float overlap_weight) {
  const OutsideGrid& grid = state_.grid();
  std::vector<float> squares(max_balls(), -1);
  for (std::size_t b = 0; b < max_balls(); ++b) {
    if (!(balls()[b].radius > 0)) continue;
    const double inside = -shape_.distance()(grid.from_grid(balls()[b].center)) / grid.cell();
    const float inscribed = std::clamp(static_cast<float>(inside), 0.0F, balls()[b].radius);
    squares[b] = inscribed * inscribed;
  }
  state_.assign_by_power(squares);
  for (std::size_t b = 0; b < max_balls(); ++b) state_.recenter(b, overlap_weight, 0.12F);
  fill(overlap_weight);
}

// Every unused place gets one half of a ball.
void ChildFit::fill(float overlap_weight) {
  if (!fill_places_) return;
  std::vector<std::uint8_t> rejected(max_balls(), 0);  // splitting the ball does not pay
  for (std::size_t into = 0; into < max_balls(); ++into)
    if (!is_used(into) && !split_costliest(into, overlap_weight, rejected)) return;
}

// Returns false if no split pays.
bool ChildFit::split_costliest(std::size_t into, float overlap_weight, std::vector<std::uint8_t>& rejected) {
  constexpr float most_cost_factor = 1.5F;
  const std::span<const float> demand = state_.demand();
  for (;;) {
    std::size_t from = max_balls();
    for (std::size_t b = 0; b < max_balls(); ++b) {
      if (state_.assignment().count(b) < 2 || rejected[b] != 0) continue;
      if (from == max_balls() || split_priority(b, demand) > split_priority(from, demand)) from = b;
    }
    if (from == max_balls()) return false;
    // Around a tube most balls are better whole, and would be tried again after every change.
    const std::uint64_t key = WholeBalls::key(balls()[from], state_.fit_inputs(from, overlap_weight));
    const bool is_tried = settings_.retries_splits || !better_whole_.contains(key);
    if (is_tried && state_.split(from, into, overlap_weight, most_cost_factor)) return true;
    better_whole_.insert(key);
    rejected[from] = 1;
  }
}

// The ball's cost, plus its share of the balance term, which grows with the square of its demand.
float ChildFit::split_priority(std::size_t ball, std::span<const float> demand) const {
  if (state_.assignment().points().demand.empty()) return balls()[ball].cost;
  const float scale = static_cast<float>(std::max(0.0, balance_scale_));
  return balls()[ball].cost + settings_.balance * scale * demand[ball] * demand[ball] * static_cast<float>(max_balls());
}

double ChildFit::imbalance() {
  if (state_.assignment().points().demand.empty() || settings_.balance == 0) return 0;
  double sum = 0;
  for (const float d : state_.demand()) sum += static_cast<double>(d) * d;
  return sum * static_cast<double>(max_balls());
}

double ChildFit::objective() {
  std::vector<Spheref> spheres;
  for (std::size_t b = 0; b < max_balls(); ++b)
    if (balls()[b].radius > 0) spheres.push_back(balls()[b].sphere());
  const double sum = state_.grid().outside_together(spheres);
  if (balance_scale_ < 0) balance_scale_ = sum;
  return sum + settings_.balance * balance_scale_ * imbalance();
}

// growth_if_removed: growth of the siblings if each ball were removed; filled if it is empty. Returns max_balls() if no
// ball is used.
std::size_t ChildFit::cheapest_to_remove(std::vector<float>& growth_if_removed) {
  if (growth_if_removed.empty()) {
    growth_if_removed.resize(max_balls());
    for (std::size_t b = 0; b < max_balls(); ++b)
      if (is_used(b)) growth_if_removed[b] = state_.growth_without(b);
  }
  std::size_t result = max_balls();
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t b = 0; b < max_balls(); ++b) {
    if (!is_used(b)) continue;
    const float loss =
        (0.5F * growth_if_removed[b] - balls()[b].cost) * (1 + 0.6F * static_cast<float>(random_.uniform()));
    if (loss < least) least = loss, result = b;
  }
  return result;
}

// Removes the ball whose removal makes siblings grow least and splits the costliest one. Random factors vary both
// choices.
void ChildFit::relocate_sphere(std::vector<float>& growth_if_removed) {
  const std::size_t gone = cheapest_to_remove(growth_if_removed);
  const std::span<const float> demand = state_.demand();
  std::size_t from = max_balls();
  float largest = -1;
  for (std::size_t b = 0; b < max_balls(); ++b) {
    if (b == gone || state_.assignment().count(b) < 2) continue;
    const float priority = split_priority(b, demand) * (0.4F + static_cast<float>(random_.uniform()));
    if (priority > largest) largest = priority, from = b;
  }
  if (gone == max_balls() || from == max_balls()) return;
  state_.remove(gone);
  state_.split(from, gone, settings_.overlap_weight, std::numeric_limits<float>::infinity());
}

// Moves the walls between one ball and its siblings by a share of a child's width, and fits what that changes.
void ChildFit::nudge() {
  std::vector<float> squares = squared_radii();
  std::vector<std::size_t> members;
  for (std::size_t b = 0; b < max_balls(); ++b)
    if (balls()[b].radius > 0 && is_used(b)) members.push_back(b);
  if (members.size() < 2) return;
  const std::size_t ball = members[std::min(
      members.size() - 1, static_cast<std::size_t>(random_.uniform() * static_cast<double>(members.size())))];
  float nearest = std::numeric_limits<float>::infinity();
  for (const std::size_t j : members)
    if (j != ball) nearest = std::min(nearest, distance_between(balls()[ball].center, balls()[j].center));
  constexpr float amount = 0.12F;
  const float shift = amount * settings_.child_width * (2 * static_cast<float>(random_.uniform()) - 1);
  squares[ball] += 2 * nearest * shift;  // moves the wall to the nearest sibling by `shift`
  state_.assign_by_power(squares);
  for (std::size_t b = 0; b < max_balls(); ++b) state_.recenter(b, settings_.overlap_weight, 0.06F);
}

void ChildFit::try_changes(int count, int move_every) {
  if (count <= 0) return;
  ChildState::Snapshot best = state_.snapshot();
  double least = objective();
  std::vector<float> growth_if_removed;  // growth in that state
  for (int trial = 0; trial < count; ++trial) {
    if (trial % move_every != 0) {
      nudge();
    } else {
      relocate_sphere(growth_if_removed);
      run_sweeps(0, 2);
    }
    if (const double now = objective(); now < least) {
      least = now;
      best = state_.snapshot();
      growth_if_removed.clear();
    } else {
      state_.restore(best);
    }
  }
}

void ChildFit::run_sweeps(int inscribed_sweeps, int sweeps) {
  for (int i = 0; i < inscribed_sweeps; ++i) sweep_inscribed(settings_.overlap_weight);
  for (int i = 0; i < sweeps; ++i) sweep(settings_.overlap_weight, true);
}

template <class Change>
void ChildFit::keep_if_better(const Change& change) {
  const ChildState::Snapshot before = state_.snapshot();
  const double least = objective();
  change();
  if (!(objective() < least)) state_.restore(before);
}

void ChildFit::try_inscribed(int inscribed_sweeps, int sweeps) {
  keep_if_better([&] { run_sweeps(inscribed_sweeps, sweeps); });
}

void ChildFit::try_seeds(std::span<const GroupBall> seeds, int inscribed_sweeps, int sweeps) {
  keep_if_better([&] {
    start_from_grid(seeds);
    for (std::size_t b = 0; b < max_balls(); ++b) state_.recenter(b, settings_.overlap_weight, 0.12F);
    run_sweeps(inscribed_sweeps, sweeps);
  });
}

void ChildFit::try_spheres(std::span<const Sphere> balls, int sweeps) {
  if (!balls.empty()) try_seeds(in_grid(balls), 0, sweeps);
}

GroupBall ChildFit::fit_to(const GroupPoints& points, std::span<const Vec3f> starts) {
  return state_.fit_to(points, starts, settings_.overlap_weight);
}

std::vector<Sphere> ChildFit::spheres() const {
  const OutsideGrid& grid = state_.grid();
  std::vector<Sphere> result;
  for (std::size_t b = 0; b < max_balls(); ++b)
    if (is_used(b)) result.push_back({grid.from_grid(balls()[b].center), balls()[b].radius * grid.cell()});
  return result;
}

}  // namespace morula::detail
