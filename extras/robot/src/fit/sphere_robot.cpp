// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/robot/sphere_robot.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <set>
#include <stdexcept>

namespace morula::robot {

namespace {

Sphere moved_by(const RigidTransform& at, const Sphere& s) {
  return {at(s.center), s.radius};
}

bool spheres_meet(const Sphere& a, const Sphere& b, double more) {
  const double reach = a.radius + b.radius + more;
  return squared_distance(a.center, b.center) <= reach * reach;
}

bool meets_box(const Sphere& s, const ObstacleBox& box, double more) {
  const Vec3 p = box.pose.inverse_rotate(s.center - box.pose.translation);
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double beyond = std::max(0.0, std::abs(p[k]) - box.half[k]);
    squared += beyond * beyond;
  }
  const double reach = s.radius + more;
  return squared <= reach * reach;
}

/// Many times the largest effect of rounding: inner spheres must not exclude anything that leaves would accept.
double rounding(const Sphere& s) {
  return 1e-12 * (max_norm(s.center) + s.radius);
}

}  // namespace

SphereRobot::SphereRobot(const Robot& robot, const RobotSpheres& spheres, const SelfCollision& self_collision)
    : robot_(robot) {
  std::set<std::pair<std::size_t, std::size_t>> ignored;
  for (const IgnoredPair& pair : self_collision.ignored) ignored.insert(std::minmax(pair.a, pair.b));
  for (const LinkSpheres& link : spheres.links) {
    if (link.spheres.empty()) throw std::invalid_argument("SphereRobot: a link of RobotSpheres has no spheres");
    links_.push_back(link.link);
    sphere_count_ += link.spheres.size();
    LinkTree tree;
    tree.tree = tree_from_spheres(link.spheres);
    tree.spheres = link.spheres;
    tree.moved.resize(tree.tree.node_count());
    trees_.push_back(std::move(tree));
  }
  for (std::size_t a = 0; a < links_.size(); ++a) {
    for (std::size_t b = a + 1; b < links_.size(); ++b) {
      if (ignored.count(std::minmax(links_[a], links_[b])) == 0) pairs_.emplace_back(a, b);
    }
  }
  set_joint_values(rest_values(robot_));
}

void SphereRobot::set_joint_values(std::span<const double> values) {
  set_link_poses(link_poses(robot_, values));
}

void SphereRobot::set_link_poses(std::span<const RigidTransform> link_poses) {
  if (link_poses.size() != robot_.links.size()) {
    throw std::invalid_argument("SphereRobot::set_link_poses: one pose per link of the robot");
  }
  for (std::size_t i = 0; i < link_poses.size(); ++i) {
    if (!std::isfinite(deviation_from_rigid(link_poses[i])))
      throw std::invalid_argument("SphereRobot::set_link_poses: the pose of " + robot_.links[i].name +
                                  " is not finite, or a reflection");
  }
  for (std::size_t i = 0; i < links_.size(); ++i) {
    LinkTree& link = trees_[i];
    link.at = link_poses[links_[i]];
    link.root = moved_by(link.at, link.tree.spheres[0]);
    link.is_moved = false;
  }
}

std::vector<Sphere> SphereRobot::spheres() const {
  std::vector<Sphere> result;
  result.reserve(sphere_count_);
  for (const LinkTree& link : trees_) {
    for (const Sphere& s : link.spheres) result.push_back(moved_by(link.at, s));
  }
  return result;
}

const std::vector<Sphere>& SphereRobot::moved(LinkTree& link) {
  if (!link.is_moved) {
    for (std::size_t i = 0; i < link.moved.size(); ++i) link.moved[i] = moved_by(link.at, link.tree.spheres[i]);
    link.is_moved = true;
  }
  return link.moved;
}

std::optional<std::pair<std::size_t, std::size_t>> SphereRobot::self_collision() {
  for (const auto& [a, b] : pairs_) {
    ++sphere_tests_;
    const Sphere &p = trees_[a].root, &q = trees_[b].root;
    if (spheres_meet(p, q, rounding(p) + rounding(q)) && meet(trees_[a], trees_[b])) return std::pair{a, b};
  }
  return std::nullopt;
}

/// Whether two links meet whose roots meet.
bool SphereRobot::meet(LinkTree& a, LinkTree& b) {
  const std::vector<Sphere>&p = moved(a), &q = moved(b);
  stack_.assign(1, {0, 0});
  while (!stack_.empty()) {
    const auto [m, n] = stack_.back();
    stack_.pop_back();
    const bool leaf_a = a.tree.is_leaf(m), leaf_b = b.tree.is_leaf(n);
    if (leaf_a && leaf_b) {
      if (spheres_meet(p[m], q[n], 0)) return true;
      continue;
    }
    // The larger one is divided.
    const bool divide_a = !leaf_a && (leaf_b || p[m].radius >= q[n].radius);
    const SphereTree& tree = divide_a ? a.tree : b.tree;
    const std::uint32_t node = divide_a ? m : n, first = tree.first_child[node];
    for (std::uint32_t child = first; child < first + tree.child_count[node]; ++child) {
      const std::uint32_t x = divide_a ? child : m, y = divide_a ? n : child;
      ++sphere_tests_;
      const bool leaves = a.tree.is_leaf(x) && b.tree.is_leaf(y);
      if (spheres_meet(p[x], q[y], leaves ? 0 : rounding(p[x]) + rounding(q[y]))) stack_.emplace_back(x, y);
    }
  }
  return false;
}

/// inner: whether spheres below a sphere may meet it. leaf: whether this sphere does.
template <class Inner, class Leaf>
bool SphereRobot::any_leaf(const Inner& inner, const Leaf& leaf) {
  for (LinkTree& link : trees_) {
    ++sphere_tests_;
    if (!inner(link.root)) continue;
    const std::vector<Sphere>& spheres = moved(link);
    stack_.assign(1, {0, 0});
    while (!stack_.empty()) {
      const std::uint32_t node = stack_.back().first;
      stack_.pop_back();
      if (link.tree.is_leaf(node)) {
        if (leaf(spheres[node])) return true;
        continue;
      }
      const std::uint32_t first = link.tree.first_child[node];
      for (std::uint32_t child = first; child < first + link.tree.child_count[node]; ++child) {
        ++sphere_tests_;
        if (link.tree.is_leaf(child) ? leaf(spheres[child]) : inner(spheres[child])) {
          if (link.tree.is_leaf(child)) return true;
          stack_.emplace_back(child, 0);
        }
      }
    }
  }
  return false;
}

bool SphereRobot::collides(const Sphere& obstacle) {
  if (!std::isfinite(max_norm(obstacle.center) + obstacle.radius) || obstacle.radius < 0)
    throw std::invalid_argument("SphereRobot::collides: a ball needs a finite center and a radius of 0 or more");
  return meets_ball(obstacle);
}

bool SphereRobot::meets_ball(const Sphere& obstacle) {
  const double own = rounding(obstacle);
  return any_leaf([&](const Sphere& s) { return spheres_meet(s, obstacle, own + rounding(s)); },
                  [&](const Sphere& s) { return spheres_meet(s, obstacle, 0); });
}

bool SphereRobot::collides(const ObstacleBox& obstacle) {
  const Vec3& half = obstacle.half;
  if (!std::isfinite(deviation_from_rigid(obstacle.pose)) || !std::isfinite(max_norm(half)) ||
      !(half.x >= 0 && half.y >= 0 && half.z >= 0))
    throw std::invalid_argument("SphereRobot::collides: a box needs a finite pose and half lengths of 0 or more");
  const double own = 1e-12 * (max_norm(obstacle.pose.translation) + max_norm(obstacle.half));
  return any_leaf([&](const Sphere& s) { return meets_box(s, obstacle, own + rounding(s)); },
                  [&](const Sphere& s) { return meets_box(s, obstacle, 0); });
}

bool SphereRobot::collides(const SphereState& other, const RigidTransform& transform) {
  if (!std::isfinite(deviation_from_rigid(transform)))
    throw std::invalid_argument("SphereRobot::collides: the transform of the tree is not finite, or a reflection");
  const SphereTree& tree = *other.tree;
  other_.resize(tree.node_count());
  for (std::uint32_t i = 0; i < tree.node_count(); ++i) other_[i] = moved_by(transform, other.sphere(i));
  std::vector<std::uint32_t> waiting;
  if (!other.nested) {
    for (std::uint32_t i = 0; i < tree.node_count(); ++i) {
      if (tree.is_leaf(i) && meets_ball(other_[i])) return true;
    }
    return false;
  }
  // Descends the other tree where the robot reaches it.
  waiting.push_back(0);
  while (!waiting.empty()) {
    const std::uint32_t node = waiting.back();
    waiting.pop_back();
    Sphere grown = other_[node];
    if (!tree.is_leaf(node)) grown.radius += 2 * rounding(grown);
    if (!meets_ball(grown)) continue;
    if (tree.is_leaf(node)) return true;
    for (std::uint32_t k = 0; k < tree.child_count[node]; ++k) waiting.push_back(tree.first_child[node] + k);
  }
  return false;
}

}  // namespace morula::robot
