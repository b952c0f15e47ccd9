// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Many spheres as one obstacle: a binary tree over their centers.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "plan/obstacle.hpp"

namespace morula::robot {
namespace {

constexpr std::uint32_t leaf_size = 8;
constexpr std::size_t deepest = 64;  // halves of 2^32 spheres

struct SphereSet final : Obstacle {
  struct Node {
    Box centers{};
    double largest = 0;                            // radius
    std::uint32_t begin = 0, end = 0, second = 0;  // spheres below; second child, the first follows; 0: a leaf
  };

  explicit SphereSet(std::span<const Sphere> given) : spheres(given.begin(), given.end()) {
    add_node(0, static_cast<std::uint32_t>(spheres.size()));
    Box box;
    for (const Sphere& s : spheres) {
      const Vec3 r{s.radius, s.radius, s.radius};
      box.add(s.center - r), box.add(s.center + r);
    }
    set_bounds(box);
  }

  std::uint32_t add_node(std::uint32_t begin, std::uint32_t end) {
    const auto number = static_cast<std::uint32_t>(nodes.size());
    Node node{.begin = begin, .end = end};
    for (std::uint32_t i = begin; i < end; ++i) {
      node.centers.add(spheres[i].center);
      node.largest = std::max(node.largest, spheres[i].radius);
    }
    nodes.push_back(node);
    if (end - begin <= leaf_size) return number;
    const Vec3 e = node.centers.extent();
    const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(spheres.begin() + begin, spheres.begin() + middle, spheres.begin() + end,
                     [axis](const Sphere& a, const Sphere& b) { return a.center[axis] < b.center[axis]; });
    add_node(begin, middle);
    const std::uint32_t second = add_node(middle, end);
    nodes[number].second = second;
    return number;
  }

  // Subtraction, squares, sums and roots are monotone also when they round. So no bound of a node exceeds the number
  // that it bounds as that is computed, and nothing needs an allowance.
  template <class Skip, class Visit>
  void walk(const Skip& skip, const Visit& visit) const {
    std::array<std::uint32_t, deepest> waiting;
    std::size_t count = 0;
    waiting[count++] = 0;
    while (count > 0) {
      const std::uint32_t number = waiting[--count];
      const Node& node = nodes[number];
      if (skip(node)) continue;
      if (node.second != 0) {
        waiting[count++] = node.second;
        waiting[count++] = number + 1;
      } else {
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
          if (visit(spheres[i])) return;
        }
      }
    }
  }

  bool touches(const Sphere& ball) const override {
    bool found = false;
    walk(
        [&](const Node& node) {
          const double reach = ball.radius + node.largest;
          return squared_distance(node.centers, ball.center) > reach * reach;
        },
        [&](const Sphere& s) {
          const double reach = ball.radius + s.radius;
          return found = squared_distance(ball.center, s.center) <= reach * reach;
        });
    return found;
  }

  NearestObstacle nearest(const Vec3& p, double within) const override {
    double least = within;
    const Sphere* best = nullptr;
    walk([&](const Node& node) { return std::sqrt(squared_distance(node.centers, p)) - node.largest > least; },
         [&](const Sphere& s) {
           const double d = distance(p, s.center) - s.radius;
           if (d < least || (best == nullptr && d == least)) least = d, best = &s;
           return false;
         });
    if (best == nullptr) return {};
    return place_at(least, normalized(p - best->center, Vec3{0, 0, 1}), within);
  }

  std::vector<Sphere> spheres;
  std::vector<Node> nodes;
};

}  // namespace

ObstaclePointer spheres_obstacle(std::span<const Sphere> spheres) {
  return std::make_shared<SphereSet>(spheres);
}

}  // namespace morula::robot
