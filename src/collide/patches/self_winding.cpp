// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/self_winding.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "collide/pairs/placed_spheres.hpp"

namespace morula::detail {
namespace {

/// A facet in the order v, c, d, if v is one of its corners.
struct Cone {
  IndexedPoint v, c, d;
};

/// 1 if the segment from p to q passes through the facet from its outer side to its inner side, -1 for the other
/// direction, 0 if it does not. No two of the five points have the same index.
int passage(const IndexedPoint& p, const IndexedPoint& q, const std::array<IndexedPoint, 3>& t) {
  const int side = perturbed_orient3d(t[0], t[1], t[2], p);
  if (side == perturbed_orient3d(t[0], t[1], t[2], q)) return 0;
  const int turn = perturbed_orient3d(p, q, t[0], t[1]);
  if (turn != perturbed_orient3d(p, q, t[1], t[2]) || turn != perturbed_orient3d(p, q, t[2], t[0])) return 0;
  return side;
}

/// The same for the way from the direction of u to that of x, seen from the cone's v. With S(y) = det(c, d, y) and
/// T(y) = det(u, x, y), directions about v, u S(x) - x S(u) + c T(d) - d T(c) = 0. If each arc has its ends on both
/// sides of the other's plane, u and x have coefficients of the sign of S(x), and c and d of that of T(d). So a
/// direction between u and x is one between c and d if these signs differ, and opposite to one if they are equal.
int passage_of_cone(const IndexedPoint& u, const IndexedPoint& x, const Cone& g) {
  const int from = perturbed_orient3d(g.v, g.c, g.d, u), to = perturbed_orient3d(g.v, g.c, g.d, x);
  if (from == to) return 0;
  const int c = perturbed_orient3d(g.v, u, x, g.c), d = perturbed_orient3d(g.v, u, x, g.d);
  // mutant self-opposite-arcs: `c == d || d == to` -> `c == d`
  if (c == d || d == to) return 0;
  return from;
}

}  // namespace

// Facets that the half line from `from` along the axis may meet.
void SelfWinding::collect(const Collider& body, const Vec3& from, int axis, int sign) {
  const PlacedSpheres spheres(body);
  const SphereTree& tree = body.tree();
  const auto may_meet = [&](const Sphere& s) {
    const double reach = s.radius * (1 + 0x1p-50), ahead = sign * (s.center[axis] - from[axis]);
    const int side = (axis + 1) % 3, other = (axis + 2) % 3;
    const double u = s.center[side] - from[side], v = s.center[other] - from[other];
    return ahead + reach >= 0 && (u * u + v * v) * (1 - 0x1p-49) <= reach * reach;
  };
  std::array<std::uint32_t, max_depth * max_branching + 1> stack;
  std::size_t top = 0;
  facets_.clear();
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t node = stack[--top];
    if (!may_meet(spheres(node))) continue;
    if (tree.is_leaf(node)) {
      const auto owned = body.facets(node);
      facets_.insert(facets_.end(), owned.begin(), owned.end());
      continue;
    }
    for (std::uint32_t k = 0; k < tree.child_count[node]; ++k) stack[top++] = tree.first_child[node] + k;
  }
  std::sort(facets_.begin(), facets_.end());
  facets_.erase(std::unique(facets_.begin(), facets_.end()), facets_.end());
}

int SelfWinding::outside(const Collider& body, const ClosedSurface& surface, std::span<const Vec3> world,
                         std::uint32_t edge) {
  const Connectivity& connectivity = surface.connectivity;
  const auto& [first, second] = connectivity.edges[edge];
  const IndexedPoint v{world[first], first}, u{world[second], second};
  // The nearest way out of the body's sphere.
  const Sphere root = PlacedSpheres(body)(0);
  int axis = 0, sign = 1;
  for (int k = 0; k < 3; ++k) {
    const double here = v.at[k] - root.center[k];
    if (std::abs(here) > std::abs(v.at[axis] - root.center[axis])) axis = k;
  }
  if (v.at[axis] < root.center[axis]) sign = -1;
  // X is translated least of all.
  IndexedPoint x{v.at, 0xffffffffu};
  x.at[axis] = root.center[axis] + sign * (2 * root.radius + 0x1p-30 * std::abs(root.center[axis]));
  collect(body, v.at, axis, sign);

  int winding = 0;
  const auto facets = body.mesh_facets();
  for (const std::uint32_t facet : facets_) {
    const Facet& f = facets[facet];
    if (connectivity.facet_edges[facet][0] == no_edge) continue;
    if (f[0] == first || f[1] == first || f[2] == first) continue;
    winding -= passage(v, x, {IndexedPoint{world[f[0]], f[0]}, {world[f[1]], f[1]}, {world[f[2]], f[2]}});
  }
  std::array<Cone, 2> at_edge{};
  std::array<std::uint32_t, 2> apex{};
  std::size_t found = 0;
  for (const std::uint32_t facet : connectivity.vertex_facets(first)) {
    const Facet& f = facets[facet];
    const std::size_t k = f[0] == first ? 0 : f[1] == first ? 1 : 2;
    const std::uint32_t c = f[(k + 1) % 3], d = f[(k + 2) % 3];
    const Cone cone{v, {world[c], c}, {world[d], d}};
    if (c != second && d != second) {
      winding -= passage_of_cone(u, x, cone);
    } else if (found < 2) {
      apex[found] = c == second ? d : c;
      at_edge[found++] = cone;
    }
  }
  // Two facets with the same corners have nothing between them.
  if (apex[0] == apex[1]) return winding;
  const auto is_behind = [](const Cone& g, const IndexedPoint& p) { return perturbed_orient3d(g.v, g.c, g.d, p) < 0; };
  const bool is_convex = is_behind(at_edge[0], {world[apex[1]], apex[1]});
  const bool behind[2] = {is_behind(at_edge[0], x), is_behind(at_edge[1], x)};
  const bool is_inside = is_convex ? behind[0] && behind[1] : behind[0] || behind[1];
  return winding - (is_inside ? 1 : 0);
}

}  // namespace morula::detail
