// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "plan/clearance_search.hpp"

#include <algorithm>
#include <cmath>

namespace morula::robot {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Bounds of the rounding of a distance, relative to the largest coordinate that enters it. A distance of spheres, or of
// a sphere from a box, takes fewer than 32 operations with errors of 2^-53 of that coordinate each. The nearest point
// of a capsule, a mesh or a terrain takes more; thin facets lose some digits.
constexpr double simple_rounding = 0x1p-47, other_rounding = 0x1p-40;

double rounding_of(const Obstacle& obstacle) {
  const double relative = obstacle.kind == ObstacleKind::other ? other_rounding : simple_rounding;
  // The inverse of a matrix that is not quite a rotation differs from the transposed one by at most 3 times its
  // deviation, and lengths change by half of that.
  return relative + 6 * obstacle.deviation;
}

double outside_of(const Box& box, const Vec3& p) {
  return length(max(max(box.lower - p, p - box.upper), Vec3{}));
}

double distance_from(const BoxObstacle& box, const Vec3& p) {
  const Vec3 local = box.shape.pose.inverse_rotate(p - box.shape.pose.translation);
  const Vec3 beyond{std::abs(local.x) - box.shape.half.x, std::abs(local.y) - box.shape.half.y,
                    std::abs(local.z) - box.shape.half.z};
  const double inside = std::max(beyond.x, std::max(beyond.y, beyond.z));
  return inside > 0 ? length(max(beyond, Vec3{})) : inside;
}

// The signed distance of p; infinite if it exceeds `within`.
double distance_from(const Obstacle& obstacle, const Vec3& p, double within) {
  switch (obstacle.kind) {
    case ObstacleKind::sphere: {
      const Sphere& s = static_cast<const SphereObstacle&>(obstacle).shape;
      return distance(p, s.center) - s.radius;
    }
    case ObstacleKind::box:
      return distance_from(static_cast<const BoxObstacle&>(obstacle), p);
    case ObstacleKind::other:
      break;
  }
  return obstacle.nearest(p, within).distance;
}

}  // namespace

ClearancePlan::ClearancePlan(const ConfigurationQuery::Model& model_of, const World::Data& world_of,
                             const ClearanceOptions& given)
    : model(model_of), world(world_of), options(given), rounding(model_of) {
  for (const MovingSpheres& group : model.groups) {
    std::vector<GroupSphere>& spheres = groups.emplace_back();
    for (const Sphere& s : group.spheres) spheres.push_back({s, distance(s.center, group.bound.center) + s.radius});
    std::stable_sort(spheres.begin(), spheres.end(),
                     [](const GroupSphere& a, const GroupSphere& b) { return a.reach > b.reach; });
  }
  for (const JointStep& step : model.steps) axes.push_back(normalized(step.axis, Vec3{}));
}

ClearanceSearch::ClearanceSearch(const ClearancePlan& plan)
    : plan_(plan),
      poses_(plan.model.link_names.size()),
      errors_(poses_.size()),
      bounds_(plan.groups.size()),
      spheres_(plan.groups.size()),
      is_placed_(plan.groups.size()),
      obstacle_errors_(plan.world.obstacles.size()) {
  for (std::size_t k = 0; k < spheres_.size(); ++k) spheres_[k].resize(plan.groups[k].size());
  candidates_.reserve((plan.options.world ? plan.groups.size() * plan.world.obstacles.size() : 0) +
                      (plan.options.self ? plan.model.pairs.size() : 0));
}

void ClearanceSearch::place(std::span<const double> values) {
  plan_.model.place(values, poses_);
  moved_ = plan_.rounding.largest(values, poses_, errors_);
  reach_ = 0;
  for (std::size_t k = 0; k < bounds_.size(); ++k) {
    const MovingSpheres& group = plan_.model.groups[k];
    bounds_[k] = sphere_at(poses_[group.link], group.bound);
    // Also in the link's axes: numbers that cancel count as well.
    reach_ = std::max(reach_, max_norm(bounds_[k].center) + max_norm(group.bound.center) + bounds_[k].radius);
    is_placed_[k] = 0;
  }
}

const std::vector<Sphere>& ClearanceSearch::placed(std::size_t group) {
  std::vector<Sphere>& spheres = spheres_[group];
  if (is_placed_[group] != 0) return spheres;
  is_placed_[group] = 1;
  const RigidTransform& at = poses_[plan_.model.groups[group].link];
  for (std::size_t i = 0; i < spheres.size(); ++i) spheres[i] = sphere_at(at, plan_.groups[group][i].sphere);
  return spheres;
}

void ClearanceSearch::list_world() {
  const std::vector<ObstaclePointer>& obstacles = plan_.world.obstacles;
  std::vector<double>& errors = obstacle_errors_;
  for (std::size_t o = 0; o < obstacles.size(); ++o)
    // mutant robot-clearance-obstacle: `rounding_of(*obstacles[o])` -> `0`
    errors[o] = moved_ + rounding_of(*obstacles[o]) * 2 * (obstacles[o]->magnitude + reach_);
  // Ascending by link, then by obstacle: a link and the object that it holds take turns.
  const std::vector<MovingSpheres>& groups = plan_.model.groups;
  for (std::size_t first = 0, end = 0; first < groups.size(); first = end) {
    while (end < groups.size() && groups[end].link == groups[first].link) ++end;
    for (std::size_t o = 0; o < obstacles.size(); ++o) {
      for (std::size_t k = first; k < end; ++k) list_obstacle(k, o);
    }
  }
}

void ClearanceSearch::list_obstacle(std::size_t group, std::size_t number) {
  if (plan_.model.groups[group].may_touch(number)) return;
  const Obstacle& obstacle = *plan_.world.obstacles[number];
  const Sphere& bound = bounds_[group];
  Candidate candidate{.error = obstacle_errors_[number],
                      .first = static_cast<std::uint32_t>(group),
                      .second = static_cast<std::uint32_t>(number),
                      .is_world = true};
  if (obstacle.kind == ObstacleKind::other) {
    const double outside = outside_of(obstacle.bounds, bound.center);
    candidate.bound = outside > 0 ? outside - bound.radius : -infinite;
    candidate.center = -infinite;
  } else {
    candidate.center = distance_from(obstacle, bound.center, infinite);
    candidate.bound = candidate.center - bound.radius;
  }
  if (!is_excluded(candidate)) candidates_.push_back(candidate);
}

void ClearanceSearch::list_self() {
  const double error = 2 * moved_ + simple_rounding * 2 * reach_;
  const std::vector<GroupPair>& pairs = plan_.model.pairs;
  for (const GroupPair& pair : pairs) {
    const Sphere &a = bounds_[pair.a], &b = bounds_[pair.b];
    Candidate candidate{.bound = distance(a.center, b.center) - (a.radius + b.radius),
                        .error = error,
                        .first = static_cast<std::uint32_t>(pair.a),
                        .second = static_cast<std::uint32_t>(pair.b)};
    if (!is_excluded(candidate)) candidates_.push_back(candidate);
  }
}

// All distances of the pair exceed the best one, exactly and as they are computed.
bool ClearanceSearch::is_excluded(const Candidate& candidate) const {
  // mutant robot-clearance-excluded: `2 * candidate.error` -> `-0.01`
  return candidate.bound - 2 * candidate.error > best_.distance;
}

void ClearanceSearch::visit(std::size_t index) {
  if (is_excluded(candidates_[index])) return;
  if (candidates_[index].is_world)
    visit_obstacle(index);
  else
    visit_group(index);
}

void ClearanceSearch::visit_obstacle(std::size_t index) {
  const Candidate& candidate = candidates_[index];
  const Obstacle& obstacle = *plan_.world.obstacles[candidate.second];
  const double slack = 2 * candidate.error;
  double center = candidate.center;
  if (obstacle.kind == ObstacleKind::other) {
    const Sphere& bound = bounds_[candidate.first];
    center = distance_from(obstacle, bound.center, best_.distance + bound.radius + slack);
  }
  const std::vector<Sphere>& spheres = placed(candidate.first);
  const std::vector<ClearancePlan::GroupSphere>& local = plan_.groups[candidate.first];
  double least = infinite;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    // Distances change by at most as much as points move.
    if (center - local[i].reach - slack > best_.distance) break;
    const Sphere& s = spheres[i];
    const double found = distance_from(obstacle, s.center, best_.distance + s.radius + slack) - s.radius;
    least = std::min(least, found);
    if (found < best_.distance || (found == best_.distance && index < best_.candidate))
      best_ = {.distance = found, .candidate = index, .sphere = i};
  }
  lower_ = std::min(lower_, least - candidate.error);
}

void ClearanceSearch::visit_group(std::size_t index) {
  const Candidate& candidate = candidates_[index];
  const std::vector<Sphere>&first = placed(candidate.first), &second = placed(candidate.second);
  const Sphere& bound = bounds_[candidate.second];
  const double slack = 2 * candidate.error;
  double least = infinite;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Sphere& s = first[i];
    const double allowed = best_.distance + s.radius + slack;
    if (allowed + bound.radius < 0 ||
        squared_distance(s.center, bound.center) > (allowed + bound.radius) * (allowed + bound.radius))
      continue;
    for (std::size_t k = 0; k < second.size(); ++k) {
      const Sphere& t = second[k];
      const double most = best_.distance + s.radius + t.radius + slack;
      const double squared = squared_distance(s.center, t.center);
      if (most < 0 || squared > most * most) continue;
      const double found = std::sqrt(squared) - (s.radius + t.radius);
      least = std::min(least, found);
      if (found < best_.distance || (found == best_.distance && index < best_.candidate))
        best_ = {.distance = found, .candidate = index, .sphere = i, .other_sphere = k};
    }
  }
  lower_ = std::min(lower_, least - candidate.error);
}

// Each computed distance of two parts is within `error` of the exact one. So the exact least distance is at most the
// computed one plus the error of the pair that has it, and at least the least difference of a visited distance and its
// error. What was not visited is farther away than the best, exactly.
Clearance ClearanceSearch::operator()(std::span<const double> values) {
  place(values);
  candidates_.clear();
  const double limit = plan_.options.limit;
  best_ = {.distance = limit};
  lower_ = limit;
  if (plan_.options.world) list_world();
  if (plan_.options.self) list_self();
  // The most promising pair of simple shapes first: it excludes most others. Other shapes last: they cost more.
  const auto is_other = [&](const Candidate& c) {
    return c.is_world && plan_.world.obstacles[c.second]->kind == ObstacleKind::other;
  };
  std::size_t promising = none;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (!is_other(candidates_[i]) && (promising == none || candidates_[i].bound < candidates_[promising].bound))
      promising = i;
  }
  if (promising != none) visit(promising);
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (i != promising && !is_other(candidates_[i])) visit(i);
  }
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (is_other(candidates_[i])) visit(i);
  }
  Clearance result{.distance = best_.distance, .lower = std::min(lower_, limit), .upper = limit};
  if (best_.candidate == none || !(best_.distance < limit)) {
    best_.candidate = none;
    return result;
  }
  const Candidate& candidate = candidates_[best_.candidate];
  result.upper = std::min(limit, best_.distance + candidate.error);
  result.link = static_cast<std::uint32_t>(plan_.model.groups[candidate.first].link);
  if (candidate.is_world)
    result.obstacle = candidate.second;
  else
    result.other_link = static_cast<std::uint32_t>(plan_.model.groups[candidate.second].link);
  return result;
}

// A coordinate moves p about or along the axes of the joints that it sets, from the link up to the link `end`.
void ClearanceSearch::add_motion(std::span<double> gradient, std::size_t link, std::size_t end, const Vec3& p,
                                 const Vec3& direction) const {
  const ConfigurationQuery::Model& model = plan_.model;
  while (link != end && model.step_of_link[link] != none) {
    const std::size_t number = model.step_of_link[link];
    const JointStep& step = model.steps[number];
    link = step.parent;
    if (step.coordinate == none) continue;
    const RigidTransform& at = poses_[step.child];
    const Vec3 moved = step.kind == Joint::Kind::prismatic ? at.rotate(step.axis)
                                                           : cross(at.rotate(plan_.axes[number]), p - at.translation);
    gradient[step.coordinate] += step.factor * dot(direction, moved);
  }
}

void ClearanceSearch::gradient(std::span<double> gradient) const {
  std::fill(gradient.begin(), gradient.end(), 0.0);
  if (best_.candidate == none) return;
  const ConfigurationQuery::Model& model = plan_.model;
  const Candidate& candidate = candidates_[best_.candidate];
  const std::size_t link = model.groups[candidate.first].link;
  const Vec3 p = spheres_[candidate.first][best_.sphere].center;
  if (candidate.is_world) {
    const Vec3 direction = plan_.world.obstacles[candidate.second]->nearest(p, infinite).direction;
    add_motion(gradient, link, none, p, direction);
    return;
  }
  const std::size_t other = model.groups[candidate.second].link;
  const Vec3 q = spheres_[candidate.second][best_.other_sphere].center;
  const Vec3 direction = normalized(p - q, Vec3{0, 0, 1});
  // Joints above the lowest common ancestor move both. A later step never places a link above an earlier one.
  std::size_t a = link, b = other;
  while (a != b) {
    const std::size_t step_a = model.step_of_link[a], step_b = model.step_of_link[b];
    if (step_b == none || (step_a != none && step_a > step_b))
      a = model.steps[step_a].parent;
    else
      b = model.steps[step_b].parent;
  }
  add_motion(gradient, link, a, p, direction);
  add_motion(gradient, other, a, q, -direction);
}

}  // namespace morula::robot
