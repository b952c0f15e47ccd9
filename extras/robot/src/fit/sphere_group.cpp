// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/sphere_group.hpp"

#include <algorithm>
#include <limits>
#include <morula/tree/sphere_tree.hpp>

namespace morula::robot {

namespace {

Sphere moved(const RigidTransform& at, const Sphere& s) {
  return {at(s.center), s.radius};
}

double slack_of(const Sphere& s) {
  return 0x1p-40 * (max_norm(s.center) + s.radius);
}

bool meet(const Sphere& a, const Sphere& b) {
  const double reach = a.radius + b.radius + slack_of(a) + slack_of(b);
  return squared_distance(a.center, b.center) <= reach * reach;
}

double gap(const Sphere& a, const Sphere& b) {
  return distance(a.center, b.center) - a.radius - b.radius;
}

/// Chooses the node to divide: the larger one that has children. Returns true for a's.
bool divides_first(const SphereGroup::Node& a, const SphereGroup::Node& b) {
  if (a.child_count == 0 || b.child_count == 0) return b.child_count == 0;
  return a.sphere.radius >= b.sphere.radius;
}

struct Meeting {
  const SphereGroup &a, &b;
  const RigidTransform& to_b;  // of a in the axes of b
  std::size_t& tests;

  bool below(std::uint32_t m, std::uint32_t n) const {
    ++tests;
    const SphereGroup::Node &p = a.nodes[m], &q = b.nodes[n];
    if (!meet(moved(to_b, p.sphere), q.sphere)) return false;
    if (p.child_count == 0 && q.child_count == 0) return true;
    const bool first = divides_first(p, q);
    const SphereGroup::Node& divided = first ? p : q;
    for (std::uint32_t c = divided.first_child; c < divided.first_child + divided.child_count; ++c) {
      if (first ? below(c, n) : below(m, c)) return true;
    }
    return false;
  }
};

struct Nearest {
  const SphereGroup &a, &b;
  const RigidTransform& to_b;
  NearestSpheres best{};

  void below(std::uint32_t m, std::uint32_t n) {
    const SphereGroup::Node &p = a.nodes[m], &q = b.nodes[n];
    const Sphere s = moved(to_b, p.sphere);
    const double between = gap(s, q.sphere);
    if (between >= best.distance) return;
    if (p.child_count == 0 && q.child_count == 0) {
      best = {between, s.center, q.sphere.center};
      return;
    }
    const bool first = divides_first(p, q);
    const SphereGroup::Node& divided = first ? p : q;
    for (std::uint32_t c = divided.first_child; c < divided.first_child + divided.child_count; ++c) {
      if (first) {
        below(c, n);
      } else {
        below(m, c);
      }
    }
  }
};

}  // namespace

SphereGroup group_of(std::span<const Sphere> spheres) {
  SphereGroup group;
  if (spheres.empty()) return group;
  const SphereTree tree = tree_from_spheres(spheres);
  for (std::uint32_t i = 0; i < tree.node_count(); ++i) {
    group.nodes.push_back({tree.spheres[i], tree.is_leaf(i) ? 0 : tree.first_child[i], tree.child_count[i]});
  }
  for (const Sphere& s : spheres) group.extent = std::max(group.extent, length(s.center) + s.radius);
  return group;
}

bool groups_meet(const SphereGroup& a, const RigidTransform& at_a, const SphereGroup& b, const RigidTransform& at_b,
                 std::size_t& tests) {
  if (a.nodes.empty() || b.nodes.empty()) return false;
  const RigidTransform to_b = relative_to(at_b, at_a);
  return Meeting{a, b, to_b, tests}.below(0, 0);
}

NearestSpheres nearest_spheres(const SphereGroup& a, const RigidTransform& at_a, const SphereGroup& b,
                               const RigidTransform& at_b) {
  const RigidTransform to_b = relative_to(at_b, at_a);
  Nearest nearest{a, b, to_b, {.distance = std::numeric_limits<double>::infinity()}};
  nearest.below(0, 0);
  nearest.best.a = at_b(nearest.best.a);
  nearest.best.b = at_b(nearest.best.b);
  return nearest.best;
}

}  // namespace morula::robot
