// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/self_winding.hpp"

#include <array>
#include <cmath>

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

int number_outside(std::span<const Facet> facets, const Connectivity& connectivity, const SelfTree& tree,
                   std::span<const Vec3> world, std::uint32_t edge) {
  const std::uint32_t first = connectivity.edges[edge][0], second = connectivity.edges[edge][1];
  const IndexedPoint v{world[first], first}, u{world[second], second};
  // The nearest way out of the box.
  const Box& box = tree.bounds();
  int axis = 0, sign = 1;
  for (int k = 0; k < 3; ++k)
    for (const int there : {1, -1}) {
      const auto way = [&](int a, int s) { return s > 0 ? box.upper[a] - v.at[a] : v.at[a] - box.lower[a]; };
      if (way(k, there) < way(axis, sign)) axis = k, sign = there;
    }
  // X is translated least of all.
  IndexedPoint x{v.at, 0xffffffffu};
  const double end = sign > 0 ? box.upper[axis] : box.lower[axis];
  x.at[axis] = end + sign * (length(box.extent()) + 0x1p-30 * std::abs(end) + 0x1p-1000);

  int winding = 0;
  tree.each_on_half_line(v.at, axis, sign, [&](std::uint32_t facet) {
    const Facet& f = facets[facet];
    if (connectivity.facet_edges[facet][0] == no_edge) return;
    if (f[0] == first || f[1] == first || f[2] == first) return;
    winding -= passage(v, x, {IndexedPoint{world[f[0]], f[0]}, {world[f[1]], f[1]}, {world[f[2]], f[2]}});
  });
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
