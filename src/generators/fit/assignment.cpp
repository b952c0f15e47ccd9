// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/assignment.hpp"

#include <morula/geometry/reproducible.hpp>

namespace morula::detail {

std::uint64_t hash_mix(std::uint64_t number) {
  return Random(number).next();
}

PowerCells::PowerCells(const GroupPoints& points, std::size_t most)
    : points_(points),
      last_power_(most),
      power_(points.size(), std::numeric_limits<float>::infinity()),
      owner_(points.size(), 0) {}

bool PowerCells::update(std::span<const GroupBall> balls, std::span<const float> squared_radii) {
  const Changes changes = note_changes(balls, squared_radii);
  if (changes.members.empty()) {
    std::fill(last_power_.begin(), last_power_.end(), Power{});
    return false;
  }
  // Most changes move a few balls only.
  if (2 * changes.changed.size() > last_power_.size())
    update_all(changes);
  else
    update_changed(changes);
  return true;
}

PowerCells::Changes PowerCells::note_changes(std::span<const GroupBall> balls, std::span<const float> squared_radii) {
  Changes result{{}, {}, std::vector<std::uint8_t>(last_power_.size(), 0)};
  for (std::size_t b = 0; b < last_power_.size(); ++b) {
    if (!(squared_radii[b] < 0)) result.members.push_back(b);
    Power& last = last_power_[b];
    if (last.square < 0 && squared_radii[b] < 0) continue;
    if (last.center == balls[b].center && last.square == squared_radii[b]) continue;
    last = {balls[b].center, squared_radii[b]};
    result.changed.push_back(b);
    result.is_changed[b] = 1;
  }
  return result;
}

void PowerCells::offer(std::size_t ball, const PointColumns& points, const PowerOwners& owners) const {
  const Power& power = last_power_[ball];
  fit_kernels().offer(points, power.center, power.square, static_cast<std::uint32_t>(ball), owners);
}

void PowerCells::update_all(const Changes& changes) {
  constexpr std::size_t block = 1024;
  std::fill(power_.begin(), power_.end(), std::numeric_limits<float>::infinity());
  std::fill(owner_.begin(), owner_.end(), std::uint32_t{0});
  for (std::size_t begin = 0; begin < points_.size(); begin += block) {
    const std::size_t count = std::min(block, points_.size() - begin);
    const PointColumns some{&points_.x[begin], &points_.y[begin], &points_.z[begin], count};
    for (const std::size_t b : changes.members) offer(b, some, {&power_[begin], &owner_[begin]});
  }
}

// Points of changed balls are decided among all balls; the other points are only compared with the changed ones.
void PowerCells::update_changed(const Changes& changes) {
  constexpr std::size_t block = 1024;
  std::array<float, block> x, y, z, least;
  std::array<std::uint32_t, block> owner, index;
  std::size_t open = 0;
  const auto decide = [&] {
    if (open == 0) return;
    std::fill_n(least.begin(), open, std::numeric_limits<float>::infinity());
    std::fill_n(owner.begin(), open, 0u);
    for (const std::size_t b : changes.members)
      offer(b, {x.data(), y.data(), z.data(), open}, {least.data(), owner.data()});
    for (std::size_t i = 0; i < open; ++i) {
      power_[index[i]] = least[i];
      owner_[index[i]] = owner[i];
    }
    open = 0;
  };
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (changes.is_changed[owner_[i]] == 0) continue;
    x[open] = points_.x[i], y[open] = points_.y[i], z[open] = points_.z[i];
    index[open] = static_cast<std::uint32_t>(i);
    if (++open == block) decide();
  }
  decide();
  for (const std::size_t b : changes.changed)
    if (!(last_power_[b].square < 0)) offer(b, points_.columns(), {power_.data(), owner_.data()});
}

Assignment::Assignment(const GroupPoints& points, std::size_t most)
    : points_(points),
      cells_(points, most),
      owner_(points.size(), 0),
      count_(most, 0),
      hash_(most, 0),
      demand_(most, 0) {
  count_[0] = static_cast<std::uint32_t>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    point_hash_.push_back(hash_mix(i));
    hash_[0] += point_hash_[i];
  }
}

std::span<const float> Assignment::demand() {
  if (demand_is_stale_ && !points_.demand.empty()) {
    std::fill(demand_.begin(), demand_.end(), 0.0F);
    for (std::size_t i = 0; i < owner_.size(); ++i) demand_[owner_[i]] += points_.demand[i];
  }
  demand_is_stale_ = false;
  return demand_;
}

void Assignment::set_owner(std::size_t point, std::size_t ball) {
  const std::size_t before = owner_[point];
  if (before == ball) return;
  owner_[point] = static_cast<std::uint8_t>(ball);
  --count_[before];
  ++count_[ball];
  hash_[before] -= point_hash_[point];
  hash_[ball] += point_hash_[point];
  demand_is_stale_ = true;
}

void Assignment::set_owners(std::span<const std::uint8_t> owners) {
  for (std::size_t i = 0; i < owner_.size(); ++i) set_owner(i, owners[i]);
}

void Assignment::set_all(std::size_t ball) {
  for (std::size_t i = 0; i < owner_.size(); ++i) set_owner(i, ball);
}

void Assignment::set_by_power(std::span<const GroupBall> balls, std::span<const float> squared_radii) {
  if (!cells_.update(balls, squared_radii)) return;
  for (std::size_t i = 0; i < owner_.size(); ++i) set_owner(i, cells_.owners()[i]);
}

}  // namespace morula::detail
