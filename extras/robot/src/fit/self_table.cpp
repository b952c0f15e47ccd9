// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/self_table.hpp"

#include <algorithm>
#include <cmath>

namespace morula::robot {

namespace {

/// At least 0 where the spheres touch or overlap. A float that is rounded stays on the side of 0.
float depth_of(const Sphere& s, const Sphere& t) {
  const double reach = s.radius + t.radius, squared = squared_distance(s.center, t.center);
  const bool overlap = squared <= reach * reach;
  const double depth = reach - std::sqrt(squared);
  return overlap ? std::max(0.0F, static_cast<float>(depth)) : std::min(-1e-30F, static_cast<float>(depth));
}

/// The depth of a sphere in the union of others.
float depth_in(const Sphere& s, const Pieces& others) {
  float deepest = -std::numeric_limits<float>::infinity();
  for (const auto& other : others) deepest = std::max(deepest, depth_of(s, other->sphere));
  return deepest;
}

}  // namespace

void OverlapTable::add(std::size_t a, std::size_t b, std::size_t sample, const RigidTransform& to_b) {
  if (rows_.empty() || rows_.back().a != a || rows_.back().b != b)
    rows_.push_back({a, b, 0.2 * std::min(bounds_[a].radius, bounds_[b].radius)});
  rows_.back().near.push_back({.sample = sample, .to_b = to_b, .a = {}, .b = {}});
}

void OverlapTable::fill(Row& row, Near& near) const {
  const Pieces &of_a = pieces_[row.a], &of_b = pieces_[row.b];
  near.a.assign(of_a.size(), -std::numeric_limits<float>::infinity());
  near.b.assign(of_b.size(), -std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    const Sphere moved{near.to_b(of_a[i]->sphere.center), of_a[i]->sphere.radius};
    for (std::size_t j = 0; j < of_b.size(); ++j) {
      const float depth = depth_of(moved, of_b[j]->sphere);
      near.a[i] = std::max(near.a[i], depth);
      near.b[j] = std::max(near.b[j], depth);
    }
  }
  near.deepest = *std::max_element(near.a.begin(), near.a.end());
}

void OverlapTable::complete(std::size_t samples, Workers& workers) {
  workers.run(rows_.size(), [&](std::size_t r) {
    for (Near& near : rows_[r].near) fill(rows_[r], near);
  });
  overlaps_.assign(samples, 0);
  for (const Row& row : rows_)
    for (const Near& near : row.near) overlaps_[near.sample] += near.deepest >= 0 ? 1 : 0;
}

std::size_t OverlapTable::false_samples() const {
  return static_cast<std::size_t>(overlaps_.size()) -
         static_cast<std::size_t>(std::count(overlaps_.begin(), overlaps_.end(), 0U));
}

std::vector<std::size_t> OverlapTable::neighbors(std::size_t link) const {
  std::vector<std::size_t> found;
  for (const Row& row : rows_) {
    if (row.a == link) found.push_back(row.b);
    if (row.b == link) found.push_back(row.a);
  }
  return found;
}

double OverlapTable::cost(const Row& row, float depth) const {
  if (depth < 0) return 0;
  return 0.3 + 0.7 * std::min(1.0, static_cast<double>(depth) / row.scale);
}

std::vector<OverlapTable::Blame> OverlapTable::blame(std::size_t link) const {
  std::vector<Blame> result(pieces_[link].size());
  for (const Row& row : rows_) {
    if (row.a != link && row.b != link) continue;
    const bool is_a = row.a == link;
    const Pieces& others = pieces_[is_a ? row.b : row.a];
    for (const Near& near : row.near) {
      if (near.deepest < 0) continue;
      const std::vector<float>&own = is_a ? near.a : near.b, &of_others = is_a ? near.b : near.a;
      const auto deepest = std::max_element(of_others.begin(), of_others.end()) - of_others.begin();
      const Vec3 center = others[static_cast<std::size_t>(deepest)]->sphere.center;
      const Vec3 there = is_a ? inverse(near.to_b)(center) : near.to_b(center);
      for (std::size_t i = 0; i < own.size(); ++i) {
        // Parts that overlap less deep have to be divided later.
        if (own[i] != near.deepest) continue;
        const double share = cost(row, own[i]) / overlaps_[near.sample];
        const Vec3 way = there - pieces_[link][i]->sphere.center;
        result[i].cost += share;
        if (const double away = length(way); away > 0) result[i].toward = result[i].toward + (share / away) * way;
      }
    }
  }
  return result;
}

OverlapTable::Effect OverlapTable::effect(const Change& change) const {
  Effect effect;
  std::vector<std::int32_t> differences(overlaps_.size(), 0);
  std::vector<float> excess(change.added.size(), 0.0F);
  for (std::size_t i = 0; change.removed != none && i < excess.size(); ++i) {
    const Sphere &s = change.added[i]->sphere, &parent = pieces_[change.link][change.removed]->sphere;
    excess[i] = static_cast<float>(1.001 * std::abs(distance(s.center, parent.center) + s.radius - parent.radius));
  }
  const float most_excess = excess.empty() ? 0.0F : *std::max_element(excess.begin(), excess.end());
  for (const Row& row : rows_) {
    const bool is_a = row.a == change.link;
    if (!is_a && row.b != change.link) continue;
    const Pieces& others = pieces_[is_a ? row.b : row.a];
    const Sphere& around = bounds_[is_a ? row.b : row.a];
    for (const Near& near : row.near) {
      float deepest = -std::numeric_limits<float>::infinity(), removed = std::numeric_limits<float>::infinity();
      if (change.removed != none) {
        const std::vector<float>& own = is_a ? near.a : near.b;
        removed = own[change.removed];
        if (near.deepest < 0 && removed + most_excess < 0) continue;
        // The change has no effect if other parts are as deep.
        for (std::size_t i = 0; i < own.size(); ++i)
          if (i != change.removed) deepest = std::max(deepest, own[i]);
      }
      const RigidTransform to_other = is_a ? near.to_b : inverse(near.to_b);
      for (std::size_t i = 0; i < change.added.size(); ++i) {
        const auto& piece = change.added[i];
        // No deeper than the removed sphere, apart from the part that sticks out of it.
        if (removed + excess[i] < 0) continue;
        const Sphere moved{to_other(piece->sphere.center), piece->sphere.radius};
        if (depth_of(moved, around) < 0) continue;
        deepest = std::max(deepest, depth_in(moved, others));
      }
      const double weight = 1.0 / std::max(1U, overlaps_[near.sample]);
      effect.gain += weight * (cost(row, near.deepest) - cost(row, deepest));
      differences[near.sample] += (deepest >= 0 ? 1 : 0) - (near.deepest >= 0 ? 1 : 0);
    }
  }
  for (std::size_t k = 0; k < overlaps_.size(); ++k) {
    const std::int64_t then = std::int64_t{overlaps_[k]} + differences[k];
    effect.more_false += (then > 0 ? 1 : 0) - (overlaps_[k] > 0 ? 1 : 0);
  }
  return effect;
}

void OverlapTable::apply(const Change& change, Workers& workers) {
  Pieces& own = pieces_[change.link];
  if (change.removed == none) {
    own = change.added;
  } else {
    own.erase(own.begin() + static_cast<std::ptrdiff_t>(change.removed));
    own.insert(own.end(), change.added.begin(), change.added.end());
  }
  workers.run(rows_.size(), [&](std::size_t r) {
    if (rows_[r].a != change.link && rows_[r].b != change.link) return;
    for (Near& near : rows_[r].near) fill(rows_[r], near);
  });
  std::fill(overlaps_.begin(), overlaps_.end(), 0U);
  for (const Row& row : rows_)
    for (const Near& near : row.near) overlaps_[near.sample] += near.deepest >= 0 ? 1 : 0;
}

}  // namespace morula::robot
