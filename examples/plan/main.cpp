// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A planner over the spheres of a robot: RRT-Connect finds a path of an arm around a wall. Its configurations and edges
// are checked by ConfigurationQuery. At the end, exact tests of the links' surfaces, which know nothing of spheres,
// look for contacts along the path.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>

#include "meshes.hpp"

namespace {

using morula::Vec3;
using namespace morula::robot;

using Configuration = std::vector<double>;
using Path = std::vector<Configuration>;

/// Two trees of configurations grow toward each other from the start and the goal. (J. J. Kuffner, S. M. LaValle:
/// RRT-Connect, ICRA 2000.)
class Planner {
 public:
  Planner(const Robot& robot, const ConfigurationQuery& query, const World& world) : query_(query), world_(world) {
    for (const std::size_t joint : robot.independent_joints)
      ranges_.emplace_back(robot.joints[joint].lower, robot.joints[joint].upper);
  }

  std::optional<Path> connect(const Configuration& start, const Configuration& goal, int rounds) {
    Tree a{{start, 0}}, b{{goal, 0}};
    for (int i = 0; i < rounds; ++i) {
      Configuration target;
      for (auto& range : ranges_) target.push_back(range(random_));
      if (extend(a, target) && reach(b, a.back().at)) {
        Path path = branch(a), rest = branch(b);
        path.insert(path.begin(), rest.rbegin(), rest.rend() - 1);
        if (path.front() != start) std::reverse(path.begin(), path.end());
        return path;
      }
      std::swap(a, b);
    }
    return std::nullopt;
  }

 private:
  struct Node {
    Configuration at;
    std::size_t parent;  // index in the tree; the root's is 0
  };
  using Tree = std::vector<Node>;
  static constexpr double step = 0.5;  // distance of configurations, radians

  static double distance(const Configuration& a, const Configuration& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(sum);
  }

  /// Adds a node one step from the nearest node toward the target, if the edge is free.
  bool extend(Tree& tree, const Configuration& target) {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < tree.size(); ++i)
      if (distance(tree[i].at, target) < distance(tree[nearest].at, target)) nearest = i;
    const Configuration& from = tree[nearest].at;
    Configuration next = target;
    const double share = step / distance(from, target);
    for (std::size_t k = 0; share < 1 && k < next.size(); ++k) next[k] = std::lerp(from[k], target[k], share);
    MotionVerdict edge;  // proven for the whole edge
    query_.check_motions(from, next, world_, {&edge, 1}, {}, morula::serial_workers());
    if (edge.result != MotionResult::free) return false;
    tree.push_back({std::move(next), nearest});
    return true;
  }

  bool reach(Tree& tree, const Configuration& target) {
    while (extend(tree, target))
      if (tree.back().at == target) return true;
    return false;
  }

  /// From the last node to the root.
  static Path branch(const Tree& tree) {
    Path path;
    for (std::size_t i = tree.size() - 1; i != 0; i = tree[i].parent) path.push_back(tree[i].at);
    path.push_back(tree[0].at);
    return path;
  }

  const ConfigurationQuery& query_;
  const World& world_;
  std::vector<std::uniform_real_distribution<double>> ranges_;
  std::mt19937_64 random_{1};
};

constexpr double fine = 0.002;  // radians between the poses of the last test

/// Looks for contacts of triangles along the path: of links with obstacles, and of pairs of links that the query tests.
/// Returns the number of poses with a contact.
std::size_t count_contacts(const Robot& robot, const SelfCollision& ignored, const Path& path,
                           const std::vector<Triangles>& obstacles, std::size_t& poses) {
  std::vector<morula::Mesh> links;
  for (const Link& link : robot.links) links.push_back(surface_of(robot.file, link.collision).mesh);
  const auto is_ignored = [&](std::size_t a, std::size_t b) {
    return std::any_of(ignored.ignored.begin(), ignored.ignored.end(),
                       [&](const IgnoredPair& pair) { return pair.a == a && pair.b == b; });
  };
  const auto has_contact = [&](const Configuration& q) {
    const auto at = link_poses(robot, q);
    std::vector<Triangles> moved;
    for (std::size_t i = 0; i < links.size(); ++i) moved.push_back(posed(links[i], at[i]));
    for (std::size_t i = 0; i < links.size(); ++i) {
      for (const Triangles& obstacle : obstacles)
        if (cross_each_other(moved[i], obstacle)) return true;
      for (std::size_t k = i + 1; k < links.size(); ++k)
        if (!is_ignored(i, k) && cross_each_other(moved[i], moved[k])) return true;
    }
    return false;
  };
  std::size_t contacts = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    double length = 0;
    for (std::size_t k = 0; k < path[i].size(); ++k) length = std::max(length, std::abs(path[i][k] - path[i - 1][k]));
    const int parts = static_cast<int>(length / fine) + 1;
    for (int part = 0; part <= parts; ++part, ++poses) {
      Configuration q;
      for (std::size_t k = 0; k < path[i].size(); ++k)
        q.push_back(std::lerp(path[i - 1][k], path[i][k], static_cast<double>(part) / parts));
      contacts += has_contact(q);
    }
  }
  return contacts;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return std::puts("usage: plan arm.urdf"), 2;
  // [query]
  const Robot robot = read_robot(arguments[1]);
  const RobotSpheres spheres = fit_spheres(robot, {.spheres = 16});
  const SelfCollision ignored = find_ignored(robot, spheres);
  const ConfigurationQuery query(robot, spheres, ignored);
  // [end]

  // A wall, a bar above it, and a block as a mesh.
  const std::vector<std::array<Vec3, 2>> boxes = {{{{0.45, 0, 0.25}, {0.25, 0.02, 0.25}}},
                                                  {{{0.45, 0, 0.95}, {0.25, 0.02, 0.1}}}};
  World world;
  std::vector<Triangles> obstacles;
  for (const auto& [center, half] : boxes) {
    world.add(ObstacleBox{{.translation = center}, half});
    obstacles.push_back(posed(box_mesh(center, half), {}));
  }
  const morula::Mesh block = box_mesh({}, {0.1, 0.1, 0.1});
  const auto block_pose = morula::RigidTransform::from_axis({1, 1, 0}, 0.8, {0.3, 0.45, 0.3});
  world.add(block, block_pose);
  obstacles.push_back(posed(block, block_pose));

  const Configuration start{-0.7, 1.0, 0, 0.9, 0, 0.5, 0}, goal{0.7, 1.0, 0, 0.9, 0, 0.5, 0};
  Planner planner(robot, query, world);
  std::size_t straight_poses = 0, poses = 0;
  const std::size_t straight = count_contacts(robot, ignored, {start, goal}, obstacles, straight_poses);
  const std::optional<Path> path = planner.connect(start, goal, 10'000);
  if (!path) return std::puts("no path"), 1;
  const std::size_t contacts = count_contacts(robot, ignored, *path, obstacles, poses);
  std::printf("%zu spheres; a path of %zu configurations; contacts of triangles in %zu of %zu poses\n",
              spheres.sphere_count(), path->size(), contacts, poses);
  std::printf("the straight line: in %zu of %zu poses\n", straight, straight_poses);
  const bool has_ends = path->front() == start && path->back() == goal;
  return has_ends && contacts == 0 && straight > 0 ? 0 : 1;
}
