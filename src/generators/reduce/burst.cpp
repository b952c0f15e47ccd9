// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Burst [bradshaw2004]: a ball is removed and its neighbors take its samples, repeatedly.
//
// Departure: costs wait in a heap and are computed again only when they come up. Bursts around a ball hardly ever lower
// its cost, so the first entry that is up to date counts as the best.

#include <algorithm>
#include <limits>
#include <morula/geometry/enclosing_sphere.hpp>
#include <queue>
#include <tuple>

#include "generators/reduce/ball_set.hpp"

namespace morula::detail {
namespace {

struct Member {
  SampleSet samples;
  Sphere ball;
  double distance;
  double protrusion;
  bool alive = true;
  bool current = true;  // the last cost in the heap is right
  std::uint32_t entry = 0;
  std::vector<std::uint32_t> neighbors;
};

struct Change {
  std::uint32_t member;
  SampleSet samples;
  Sphere ball;
  double distance;
  double protrusion;
};

class Bursting {
 public:
  Bursting(const BallSet& set, std::size_t branching, const SignedDistance& shape)
      : samples_(set.samples()), branching_(branching), shape_(shape) {
    std::vector<SampleSet> owned = samples_owned(set);
    std::vector<std::uint32_t> member_of(set.size(), none);
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (owned[i].empty()) continue;
      const double radius = set.reach(i, owned[i]);
      member_of[i] = static_cast<std::uint32_t>(members_.size());
      members_.push_back({std::move(owned[i]),
                          {set.ball(i).center, radius},
                          set.distance(i),
                          set.protrusion(i, radius),
                          true,
                          true,
                          0,
                          {}});
      scale_ = std::max(scale_, radius);
    }
    alive_ = members_.size();
    for (const BallPair& pair : neighbor_pairs(set)) {
      const std::uint32_t a = member_of[pair.i], b = member_of[pair.j];
      if (a == none || b == none) continue;
      members_[a].neighbors.push_back(b);
      members_[b].neighbors.push_back(a);
    }
  }

  Reduced run() {
    if (alive_ > branching_)
      for (std::uint32_t k = 0; k < members_.size(); ++k) evaluate(k);
    while (alive_ > branching_) {
      const Entry top = heap_.top();
      heap_.pop();
      Member& m = members_[top.member];
      if (!m.alive || top.number != m.entry) continue;
      if (m.current)
        remove(top.member);
      else
        evaluate(top.member);
    }
    Reduced result;
    for (const Member& m : members_)
      if (m.alive) result.balls.push_back(m.ball), result.distances.push_back(m.distance);
    return result;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;

  std::vector<std::uint32_t> heirs(std::uint32_t k) const {
    std::vector<std::uint32_t> result;
    for (const std::uint32_t n : members_[k].neighbors)
      if (members_[n].alive) result.push_back(n);
    if (!result.empty()) return result;
    for (std::uint32_t n = 0; n < members_.size(); ++n)
      if (n != k && members_[n].alive) result.push_back(n);
    return result;
  }

  // The samples that each neighbor would get, and its ball with them.
  std::vector<Change> changes_without(std::uint32_t k) {
    const std::vector<std::uint32_t> able = heirs(k);
    std::vector<Change> changes;
    std::vector<std::size_t> change_of(able.size(), able.size());
    members_[k].samples.for_each([&](std::size_t sample) {
      std::size_t heir = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t h = 0; h < able.size(); ++h) {
        const Sphere& ball = members_[able[h]].ball;
        const double outside = distance(ball.center, samples_[sample]) - ball.radius;
        if (outside < least) least = outside, heir = h;
        if (outside <= 0) break;
      }
      if (change_of[heir] == able.size()) {
        change_of[heir] = changes.size();
        changes.push_back({able[heir], members_[able[heir]].samples, {}, 0, 0});
      }
      changes[change_of[heir]].samples.add(sample);
    });
    for (Change& change : changes) recenter(change);
    return changes;
  }

  void recenter(Change& change) {
    const Member& before = members_[change.member];
    points_.clear();
    change.samples.for_each([&](std::size_t k) { points_.push_back(samples_[k]); });
    change.distance = before.distance;
    change.ball = {before.ball.center, farthest_distance(before.ball.center, points_)};
    change.protrusion = std::max(0.0, change.ball.radius + change.distance);
    const Sphere smallest = enclosing_sphere(points_);
    // Distance changes no faster than place: that often proves that the smallest ball is no better.
    const double least_distance = before.distance - morula::distance(before.ball.center, smallest.center);
    if (!(smallest.radius + least_distance < change.protrusion)) return;
    const double distance = signed_distance(shape_, smallest.center, points_);
    if (const double p = std::max(0.0, smallest.radius + distance); p < change.protrusion)
      change.ball = smallest, change.distance = distance, change.protrusion = p;
  }

  void evaluate(std::uint32_t k) {
    Member& m = members_[k];
    bool beneficial = true;
    double sum = 0;
    for (const Change& change : changes_without(k)) {
      beneficial = beneficial && change.protrusion <= m.protrusion;
      const double e = change.protrusion / std::max(scale_, std::numeric_limits<double>::min());
      sum += (e * e) * (e * e) * (e * e);
    }
    m.current = true;
    ++m.entry;
    // Beneficial ones come first, the one that sticks out most before the others.
    heap_.push({beneficial ? -m.protrusion : sum, beneficial ? 0u : 1u, k, m.entry});
  }

  void remove(std::uint32_t k) {
    Member& gone = members_[k];
    const std::vector<std::uint32_t> neighbors = heirs(k);
    for (Change& change : changes_without(k)) {
      Member& heir = members_[change.member];
      heir.samples = std::move(change.samples);
      heir.ball = change.ball;
      heir.distance = change.distance;
      heir.protrusion = change.protrusion;
      outdate(change.member);
      for (const std::uint32_t n : heir.neighbors) outdate(n);
    }
    gone.alive = false;
    --alive_;
    // Neighbors of the removed one become each other's where they overlap.
    for (const std::uint32_t a : neighbors) {
      outdate(a);
      std::erase(members_[a].neighbors, k);
      for (const std::uint32_t b : neighbors) {
        if (a == b || distance(members_[a].ball.center, members_[b].ball.center) >=
                          members_[a].ball.radius + members_[b].ball.radius)
          continue;
        auto& known = members_[a].neighbors;
        if (std::find(known.begin(), known.end(), b) == known.end()) known.push_back(b);
      }
    }
  }
  void outdate(std::uint32_t k) { members_[k].current = false; }

  struct Entry {
    double cost;
    std::uint32_t rank;
    std::uint32_t member;
    std::uint32_t number;  // number of the member's entries; only its last one counts
    bool operator<(const Entry& other) const {
      return std::tie(other.rank, other.cost, other.member, other.number) < std::tie(rank, cost, member, number);
    }
  };

  std::span<const Vec3> samples_;
  std::size_t branching_;
  const SignedDistance& shape_;
  double scale_ = 0;  // unit of the costs: sixth powers overflow and vanish easily
  std::vector<Member> members_;
  std::size_t alive_ = 0;
  std::priority_queue<Entry> heap_;
  std::vector<Vec3> points_;
};

}  // namespace

Reduced burst(const BallSet& set, std::size_t branching, const SignedDistance& shape) {
  if (set.size() == 0 || set.samples().empty()) return {};
  return Bursting(set, branching, shape).run();
}

}  // namespace morula::detail
