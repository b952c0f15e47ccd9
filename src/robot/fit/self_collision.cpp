// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/random.hpp>
#include <morula/robot/self_collision.hpp>

#include "robot/read/xml.hpp"

namespace morula::robot {

namespace {

bool meet(const Sphere& a, const Sphere& b) {
  const double reach = a.radius + b.radius;
  return squared_distance(a.center, b.center) <= reach * reach;
}

struct Side {
  std::span<const Sphere> spheres;
  Sphere all;  // around them
};

/// a in the axes of b.
bool overlap(const Side& a, const Side& b, const RigidTransform& a_in_b) {
  if (!meet({a_in_b(a.all.center), a.all.radius}, b.all)) return false;
  for (const Sphere& s : a.spheres) {
    const Sphere moved{a_in_b(s.center), s.radius};
    if (!meet(moved, b.all)) continue;
    for (const Sphere& t : b.spheres) {
      if (meet(moved, t)) return true;
    }
  }
  return false;
}

Side side_of(std::span<const Sphere> spheres) {
  return {spheres, spheres.empty() ? Sphere{} : enclosing_sphere_of_spheres(spheres)};
}

}  // namespace

std::string_view name(IgnoreReason reason) {
  switch (reason) {
    case IgnoreReason::given:
      return "User";
    case IgnoreReason::adjacent:
      return "Adjacent";
    case IgnoreReason::rest:
      return "Default";
    case IgnoreReason::never:
      return "Never";
  }
  return "";
}

bool overlap(std::span<const Sphere> a, const RigidTransform& at_a, std::span<const Sphere> b,
             const RigidTransform& at_b) {
  if (a.empty() || b.empty()) return false;
  return overlap(side_of(a), side_of(b), relative_to(at_b, at_a));
}

SelfCollision find_ignored(const Robot& robot, const RobotSpheres& spheres, const SelfCollisionOptions& options,
                           Workers& workers) {
  SelfCollision result;
  result.samples = options.samples;
  const std::size_t count = spheres.links.size();
  std::vector<std::size_t> place(robot.links.size(), none);  // of a link among those with spheres
  std::vector<Side> sides;
  for (std::size_t i = 0; i < count; ++i) {
    place[spheres.links[i].link] = i;
    sides.push_back(side_of(spheres.links[i].spheres));
  }
  struct Pair {
    std::size_t a, b;  // places
    std::optional<IgnoreReason> reason;
  };
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) pairs.push_back({a, b, {}});
  }
  result.pairs = pairs.size();
  const auto mark = [&](std::size_t link_a, std::size_t link_b, IgnoreReason reason) {
    if (link_a == none || link_b == none || place[link_a] == none || place[link_b] == none) return;
    const std::size_t low = std::min(place[link_a], place[link_b]), high = std::max(place[link_a], place[link_b]);
    if (low == high) return;
    Pair& pair = pairs[low * (2 * count - low - 1) / 2 + (high - low - 1)];
    if (!pair.reason) pair.reason = reason;
  };
  for (const auto& [a, b] : options.given) mark(robot.find_link(a), robot.find_link(b), IgnoreReason::given);
  // Joints chain links without spheres between two that have some; links that hang from one such link are neighbours,
  // too.
  std::vector<std::size_t> nearest(robot.links.size(), none);  // the link with spheres that carries a link
  for (const std::size_t i : robot.order) {
    const Joint& joint = robot.joints[i];
    nearest[joint.child] = place[joint.parent] != none ? joint.parent : nearest[joint.parent];
    mark(joint.child, nearest[joint.child], IgnoreReason::adjacent);
  }
  const auto mark_touching = [&](const std::vector<RigidTransform>& poses) {
    for (Pair& pair : pairs) {
      if (pair.reason) continue;
      const RigidTransform &a = poses[spheres.links[pair.a].link], &b = poses[spheres.links[pair.b].link];
      if (overlap(sides[pair.a], sides[pair.b], relative_to(b, a))) pair.reason = IgnoreReason::rest;
    }
  };
  mark_touching(link_poses(robot, rest_values(robot)));
  if (options.samples > 0) {
    Random random(options.seed);
    std::vector<std::vector<RigidTransform>> poses;
    std::vector<double> values(robot.own.size());
    for (std::size_t k = 0; k < options.samples; ++k) {
      for (std::size_t i = 0; i < values.size(); ++i) {
        const Joint& joint = robot.joints[robot.own[i]];
        values[i] = random.uniform(joint.lower, joint.upper);
      }
      poses.push_back(link_poses(robot, values));
    }
    std::vector<char> touches(pairs.size());
    parallel_for(workers, pairs.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) {
        const Pair& pair = pairs[p];
        if (pair.reason) continue;
        const std::size_t a = spheres.links[pair.a].link, b = spheres.links[pair.b].link;
        touches[p] = std::any_of(poses.begin(), poses.end(), [&](const std::vector<RigidTransform>& at) {
          return overlap(sides[pair.a], sides[pair.b], relative_to(at[b], at[a]));
        });
      }
    });
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      if (!pairs[p].reason && touches[p] == 0) pairs[p].reason = IgnoreReason::never;
    }
  }
  for (const Pair& pair : pairs) {
    if (pair.reason) result.ignored.push_back({spheres.links[pair.a].link, spheres.links[pair.b].link, *pair.reason});
  }
  return result;
}

std::vector<std::array<std::string, 2>> read_ignored_pairs(const std::filesystem::path& srdf) {
  const Xml xml(srdf, "robot");
  std::vector<std::array<std::string, 2>> pairs;
  constexpr const char* element = "disable_collisions";
  for (auto at = xml.root().FirstChildElement(element); at != nullptr; at = at->NextSiblingElement(element)) {
    pairs.push_back({xml.text(*at, "link1"), xml.text(*at, "link2")});
  }
  return pairs;
}

}  // namespace morula::robot
