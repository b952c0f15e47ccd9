// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/exact_predicates.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

bool is_ball(const Sphere& s) {
  return is_finite(s.center) && std::isfinite(s.radius) && s.radius >= 0;
}

// Its radius exceeds the largest |c - c'| + r' of the children by more than the rounding of its computation: a length
// and a sum are right to 2^-50, or to the least double. In addition it has the pad of rounded_up_radius, of coordinates
// that bound all below it: certify() finds corners that a child contains inside.
Sphere around(const Vec3& center, std::span<const Sphere> children) {
  const double reach = farthest_reach(center, children);
  constexpr double least_doubles = 4 * std::numeric_limits<double>::denorm_min();
  // mutant nest-as-measured: `rounded_up_radius(reach, max_norm(center) + reach)` -> `reach`
  // mutant nest-least-doubles: `+ least_doubles` -> ``
  return {center, rounded_up_radius(reach, max_norm(center) + reach) + least_doubles};
}

Sphere nested_sphere(const Sphere& sphere, std::span<const Sphere> children) {
  if (children.size() == 1) return children[0];
  const Sphere smallest = around(enclosing_sphere_of_spheres(children).center, children);
  const bool holds =
      std::all_of(children.begin(), children.end(), [&](const Sphere& child) { return encloses(sphere, child); });
  // mutant nest-keeps-what-does-not-hold: `holds ? sphere : around(sphere.center, children)` -> `sphere`
  const Sphere about_its_center = holds ? sphere : around(sphere.center, children);
  return smallest.radius < about_its_center.radius ? smallest : about_its_center;
}

}  // namespace

Nesting certify_nesting(const SphereTree& tree, std::span<const Sphere> spheres,
                        std::span<const std::uint8_t> parents) {
  const StandardFloats standard;
  if (spheres.size() != tree.node_count() || (!parents.empty() && parents.size() != tree.node_count()))
    throw std::invalid_argument("certify_nesting: " + std::to_string(spheres.size()) + " spheres or " +
                                std::to_string(parents.size()) + " flags for a tree of " +
                                std::to_string(tree.node_count()) + " nodes");
  Nesting result;
  result.worst_excess = -std::numeric_limits<double>::infinity();
  for (std::uint32_t node = 1; node < tree.node_count(); ++node) {
    if (!parents.empty() && parents[tree.parent[node]] == 0) continue;
    const Sphere &outer = spheres[tree.parent[node]], &inner = spheres[node];
    // mutant certify-nesting-not-finite: `is_ball(outer) && is_ball(inner)` -> `true`
    const bool comparable = is_ball(outer) && is_ball(inner);
    const bool inside = comparable && encloses(outer, inner);
    double excess = comparable ? scaled_length(inner.center - outer.center) + (inner.radius - outer.radius)
                               : std::numeric_limits<double>::infinity();
    // The rounded excess must not contradict the exact test.
    if (inside) excess = std::min(excess, 0.0);
    if (!inside) {
      excess = std::max(excess, std::numeric_limits<double>::denorm_min());
      ++result.outside;
    }
    if (excess > result.worst_excess) result.worst_excess = excess, result.worst_node = node;
  }
  result.nested = result.outside == 0;
  return result;
}

void make_nested(SphereTree& tree) {
  const StandardFloats standard;
  SphereTree unpromised = tree;
  unpromised.nested = false;
  if (const auto faults = validate(unpromised); !faults.empty())
    throw std::invalid_argument("the sphere tree cannot be nested: " + faults.front());
  std::vector<Sphere> spheres = std::move(unpromised.spheres);
  for (std::size_t node = tree.node_count(); node-- > 0;) {
    if (tree.child_count[node] == 0) continue;
    spheres[node] =
        nested_sphere(spheres[node], std::span(spheres).subspan(tree.first_child[node], tree.child_count[node]));
    if (!is_ball(spheres[node]))
      throw std::invalid_argument("no sphere around the children of node " + std::to_string(node) +
                                  " is finite: scale the tree down");
  }
  tree.spheres = std::move(spheres);
  tree.nested = true;
}

}  // namespace morula
