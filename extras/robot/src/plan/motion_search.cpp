// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "plan/motion_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace morula::robot {
namespace {

constexpr double least_half = 0x1p-48;  // of a part that is halved

bool is_convex(const Obstacle& obstacle) {
  return obstacle.kind != ObstacleKind::other;
}

}  // namespace

MotionSearch::MotionSearch(const ConfigurationQuery::Model& model, const World::Data* world,
                           const MotionOptions& options)
    : model_(model),
      bodies_(*model.motions),
      world_(world),
      options_(options),
      bounds_(bodies_, model.base),
      values_(model.coordinates),
      poses_(model.link_names.size()) {}

MotionVerdict MotionSearch::certified(std::span<const double> from, std::span<const double> to) {
  from_ = from, to_ = to;
  contact_ = undecided_ = never;
  end_undecided_ = false;
  bounds_.set_edge(from, to);
  start_items();
  search(0, 1, 0, items_.size());
  if (contact_ == never && end_undecided_ && is_contact(1)) contact_ = 1;
  if (contact_ != never) return {.result = MotionResult::touches, .time = contact_, .contact = contact_at(contact_)};
  if (undecided_ != never) return {.result = MotionResult::undecided, .time = undecided_};
  return {};
}

void MotionSearch::start_items() {
  items_.clear();
  if (world_ != nullptr) {
    for (std::size_t k = 0; k < bodies_.bodies.size(); ++k) {
      for (std::uint32_t i = 0; i < world_->obstacles.size(); ++i) {
        if (!model_.groups[k].may_touch(i)) items_.push_back({bodies_.bodies[k].root, i, of_world});
      }
    }
  }
  if (!options_.self) return;
  for (std::uint32_t i = 0; i < bodies_.pairs.size(); ++i) {
    const MotionPair& pair = bodies_.pairs[i];
    items_.push_back({bodies_.bodies[pair.a].root, bodies_.bodies[pair.b].root, i});
  }
}

/// Searches a part for the items from `first` to `last`, of which nothing is known there. Earlier parts come first, so
/// that nothing before contact_ is left out.
void MotionSearch::search(double start, double end, std::size_t first, std::size_t last) {
  // mutant robot-motion-earliest: `start >= contact_` -> `contact_ != never`
  if (start >= contact_) return;
  const double half = 0.5 * (end - start), middle = start + half;
  bounds_.set_part(middle, half);
  const std::size_t mark = items_.size();
  for (std::size_t i = first; i < last; ++i) {
    stack_.assign(1, items_[i]);
    if (!visit(start, middle, end)) continue;
    // After a contact only the first half matters, for all items that were not proven there. An edge that starts in a
    // contact needs no search for where it begins.
    contact_ = start == 0 && is_contact(0) ? 0 : middle;
    items_.insert(items_.end(), stack_.begin(), stack_.end());
    for (std::size_t k = i + 1; k < last; ++k) items_.push_back(Item(items_[k]));
    break;
  }
  const std::size_t open = items_.size();
  if (open > mark) {
    search(start, middle, mark, open);
    search(middle, end, mark, open);
  }
  items_.resize(mark);
}

/// Tests the items of stack_ and all below them; returns true, with the rest in stack_, when a contact is found.
/// Appends the items to halve for to items_.
bool MotionSearch::visit(double start, double middle, double end) {
  while (!stack_.empty()) {
    const Item item = stack_.back();
    stack_.pop_back();
    const Gap gap = item.pair == of_world ? gap_to_obstacle(item) : gap_of_pair(item);
    if (gap.is_free()) continue;
    const bool is_inner = bodies_.nodes[item.node].child_count > 0 ||
                          (item.pair != of_world && bodies_.nodes[item.other].child_count > 0);
    if (is_inner && is_worth_descent(item, gap)) {
      descend(item);
      continue;
    }
    // In a part in which the gap shrinks by no more than the tolerance, it is no larger than that if it cannot be
    // proven free. A contact deeper than the tolerance allows begins earlier, perhaps in this part: the bound holds for
    // shrinking alone. Less than the rounding proves no more.
    // mutant robot-motion-depth: `-gap.gap - gap.allowance` -> `0.0`
    const double depth = std::max(0.0, -gap.gap - gap.allowance);
    const bool is_short = !is_inner && (gap.motion + depth <= least_motion(gap) || middle - start < least_half);
    if (!is_short) items_.push_back(item);
    const bool touches = !is_inner && gap.gap <= gap.allowance && (gap.gap < -gap.allowance || is_contact(middle));
    if (is_short) give_up(start, middle, end);
    if (touches && middle < contact_) return true;
  }
  return false;
}

/// Records that a part is undecided. The ends of the edge are no middles, so they are tested here.
void MotionSearch::give_up(double start, double middle, double end) {
  undecided_ = std::min(undecided_, middle);
  if (start == 0 && contact_ > 0 && is_contact(0)) contact_ = 0;
  end_undecided_ = end_undecided_ || end == 1;
}

double MotionSearch::least_motion(const Gap& gap) const {
  return std::max(options_.tolerance, gap.allowance);
}

MotionSearch::Gap MotionSearch::gap_to_obstacle(const Item& item) {
  const double radius = bodies_.nodes[item.node].sphere.radius;
  const Obstacle& obstacle = *world_->obstacles[item.other];
  const MotionBounds::Placed& at = bounds_.placed(item.node);
  Gap result{.motion = at.bound()};
  // mutant robot-motion-world-rounding: `1e-12` -> `-1e-2`
  result.allowance = bounds_.allowance() + 1e-12 * (obstacle.magnitude + bounds_.reach());
  const double needed = radius + result.motion + result.allowance;
  const Vec3 outside = max(max(obstacle.bounds.lower - at.center, at.center - obstacle.bounds.upper), Vec3{});
  if (squared_length(outside) > needed * needed * (1 + 1e-12)) {
    result.gap = never;
    return result;
  }
  const DistanceBounds bounds = obstacle.bounds_at(at.center);
  if (bounds.lower > needed) {
    result.gap = never;
    return result;
  }
  // In a long part a contact needs no search, and where the distance would hardly decide, halving does more for less.
  // mutant robot-motion-search-skipped: `result.motion > least_motion(result)` -> `true`
  const bool is_long = result.motion > least_motion(result);
  if (is_long && (bounds.upper <= radius || bounds.upper - bounds.lower <= result.motion)) {
    // mutant robot-motion-vague: `std::min(bounds.upper - radius, result.motion)` -> `bounds.upper - radius`
    result.gap = std::min(bounds.upper - radius, result.motion);
    return result;
  }
  const NearestObstacle nearest = obstacle.nearest(at.center, 2 * needed);
  result.gap = nearest.distance - radius;
  if (is_convex(obstacle) && nearest.distance > 0 && nearest.distance < never) {
    // The plane across the direction separates the center from the obstacle, so motion along the plane does not count.
    // mutant robot-motion-plane: `at.bend` -> `0`
    const double across = std::abs(dot(at.velocity, nearest.direction)) + at.bend +
                          at.speed * (1e-12 + result.allowance / nearest.distance);
    result.motion = std::min(result.motion, across);
  }
  return result;
}

MotionSearch::Gap MotionSearch::gap_of_pair(const Item& item) {
  const MotionBounds::Placed &a = bounds_.placed(item.node), &b = bounds_.placed(item.other);
  const MotionBounds::Relative& relative = bounds_.relative(item.pair);
  const double radii = bodies_.nodes[item.node].sphere.radius + bodies_.nodes[item.other].sphere.radius;
  const Vec3 offset = b.center - a.center;
  Gap result{.motion = relative.first, .allowance = 3 * bounds_.allowance()};
  const double square = squared_length(offset), needed = radii + result.motion + result.allowance;
  if (square > needed * needed * (1 + 1e-12)) {
    result.gap = never;
    return result;
  }
  const double far = std::sqrt(square);
  result.gap = far - radii;
  if (far > 0) {
    const double speeds = a.speed + b.speed;
    // mutant robot-motion-pair: `relative.bend +` -> `0 +`
    const double across = std::abs(dot(b.velocity - a.velocity, offset)) / far + relative.bend +
                          speeds * (1e-12 + result.allowance / far);
    result.motion = std::min(result.motion, across);
  }
  return result;
}

bool MotionSearch::is_worth_descent(const Item& item, const Gap& gap) const {
  // Children of a node that is small against the motion fail as it does. A factor of 3 took the least time of 1 to 5.
  constexpr double enough = 3;
  double size = bodies_.nodes[item.node].sphere.radius;
  if (item.pair != of_world) size += bodies_.nodes[item.other].sphere.radius;
  return gap.motion <= least_motion(gap) || gap.gap + size > enough * gap.motion;
}

void MotionSearch::descend(const Item& item) {
  const MotionNode& node = bodies_.nodes[item.node];
  const bool splits_other = item.pair != of_world &&
                            (node.child_count == 0 || (bodies_.nodes[item.other].child_count > 0 &&
                                                       bodies_.nodes[item.other].sphere.radius > node.sphere.radius));
  const MotionNode& split = splits_other ? bodies_.nodes[item.other] : node;
  for (std::uint32_t k = split.child_count; k-- > 0;) {
    Item child = item;
    (splits_other ? child.other : child.node) = split.first_child + k;
    stack_.push_back(child);
  }
}

bool MotionSearch::is_contact(double time) {
  return !contact_at(time).is_free();
}

ConfigurationVerdict MotionSearch::contact_at(double time) {
  interpolate(from_, to_, time, values_);
  model_.place(values_, poses_);
  return model_.first_contact(poses_, world_, options_.self);
}

MotionVerdict MotionSearch::discrete(std::span<const double> from, std::span<const double> to) {
  from_ = from, to_ = to;
  double longest = 0;
  for (std::size_t i = 0; i < from.size(); ++i) longest = std::max(longest, std::abs(to[i] - from[i]));
  const auto steps = static_cast<std::uint64_t>(std::max(1.0, std::ceil(longest / options_.resolution)));
  if (!batch_) batch_.emplace(model_, world_, options_.self);
  times_.clear();
  MotionVerdict verdict;
  // Returns true when a configuration touches.
  const auto add = [&](std::uint64_t step) {
    times_.push_back(static_cast<double>(step) / static_cast<double>(steps));
    return times_.size() == filter_block && touches_in_block(verdict);
  };
  add(0);
  if (longest > 0) add(steps);
  std::uint64_t stride = 1;
  while (longest > 0 && stride < steps) stride *= 2;
  for (; stride >= 2; stride /= 2) {
    for (std::uint64_t step = stride / 2; step < steps; step += stride) {
      if (add(step)) return verdict;
    }
  }
  touches_in_block(verdict);
  return verdict;
}

/// Tests the configurations at times_, and clears this list; true: the first of them that touches becomes the verdict.
bool MotionSearch::touches_in_block(MotionVerdict& verdict) {
  const std::size_t n = model_.coordinates;
  block_.resize(filter_block * n);
  std::array<ConfigurationVerdict, filter_block> contacts;
  const std::span<double> all(block_);
  for (std::size_t i = 0; i < times_.size(); ++i) interpolate(from_, to_, times_[i], all.subspan(i * n, n));
  batch_->run(all.first(times_.size() * n), std::span(contacts).first(times_.size()));
  for (std::size_t i = 0; i < times_.size(); ++i) {
    if (contacts[i].is_free()) continue;
    verdict = {.result = MotionResult::touches, .time = times_[i], .contact = contacts[i]};
    return true;
  }
  times_.clear();
  return false;
}

}  // namespace morula::robot
