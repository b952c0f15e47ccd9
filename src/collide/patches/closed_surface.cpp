// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/closed_surface.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "collide/pairs/placed_spheres.hpp"
#include "collide/patches/shifted_predicates.hpp"
#include "geometry/disjoint_sets.hpp"
#include "geometry/inspect_sides.hpp"

namespace morula::detail {
namespace {

/// A half line along x or z, or against it, from a point that is translated infinitely little: by (e, e^2, e^3) times
/// `moves`.
struct ShiftedHalfLine {
  Vec3 from;
  int axis, side,
      other;  // axis, side, other are x, y, z in turn: the translation along `side` exceeds that along `other`
  int sign, moves;

  ShiftedHalfLine(const Vec3& point, int along, int there, int shift)
      : from(point), axis(along), side((along + 1) % 3), other((along + 2) % 3), sign(there), moves(shift) {}

  bool may_meet(const Sphere& s) const {
    const double reach = s.radius * (1 + 0x1p-50), ahead = sign * (s.center[axis] - from[axis]);
    const double u = s.center[side] - from[side], v = s.center[other] - from[other];
    return ahead + reach >= 0 && (u * u + v * v) * (1 - 0x1p-49) <= reach * reach;
  }

  // The share of the triangle in the winding number. Edges that pass the point on its right are counted, in the plane
  // of the other two axes; an edge goes upward if its second corner is above the point. A corner at the height of the
  // point is below if the point moves up. A point on the line of an edge moves off it along `side`, because that part
  // of the translation exceeds the other: to the right of an edge that goes upward if it moves in positive direction.
  int share(const Triangle& t) const {
    int turns = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = t[k], &b = t[(k + 1) % 3];
      const bool a_below = is_below(a), b_below = is_below(b);
      if (a_below == b_below) continue;
      const int upward = a_below ? 1 : -1;
      int turn = orient2d(a, b, from, projections[axis]);
      // mutant patches-on-the-edge: `-upward * moves` -> `upward * moves`
      if (turn == 0) turn = -upward * moves;
      if (turn == upward) turns += upward;
    }
    if (turns == 0) return 0;
    int ahead = orient3d(t[0], t[1], t[2], from);
    // The projection along the axis has an area, so the normal is not 0.
    // mutant patches-start-on-facet: `moves * translation_across(t)` -> `1`
    if (ahead == 0) ahead = moves * translation_across(t);
    return ahead * turns * sign < 0 ? turns * sign : 0;
  }

 private:
  bool is_below(const Vec3& corner) const {
    return moves > 0 ? corner[other] <= from[other] : corner[other] < from[other];
  }
};

/// The half line, of the four along x and z, that meets the fewest facets, estimated from nodes two levels down; the
/// first of equals.
ShiftedHalfLine shortest_way_out(const Collider& body, const PlacedSpheres& spheres, const Vec3& from, int moves) {
  const SphereTree& tree = body.tree();
  const std::size_t level = std::min<std::size_t>(2, tree.level_count() - 1);
  const std::array lines{ShiftedHalfLine(from, 0, 1, moves), ShiftedHalfLine(from, 2, 1, moves),
                         ShiftedHalfLine(from, 0, -1, moves), ShiftedHalfLine(from, 2, -1, moves)};
  std::array<std::size_t, 4> facets{};
  for (std::uint32_t node = 0; node < tree.level_begin[level + 1]; ++node) {
    if (node < tree.level_begin[level] && !tree.is_leaf(node)) continue;
    const Sphere s = spheres(node);
    for (std::size_t k = 0; k < 4; ++k)
      if (lines[k].may_meet(s)) facets[k] += body.facets(node).size();
  }
  return lines[static_cast<std::size_t>(std::min_element(facets.begin(), facets.end()) - facets.begin())];
}

/// Components by vertices of all facets but those with a repeated index, which get the number no_facet: they are no
/// part of the surface, and would join components that are apart.
Components components_of(std::size_t facet_count, const Connectivity& connectivity) {
  DisjointSets sets(facet_count);
  for (std::uint32_t v = 0; v + 1 < connectivity.fan_begin.size(); ++v) {
    const auto fan = connectivity.vertex_facets(v);
    for (const std::uint32_t f : fan) sets.join(fan[0], f);
  }
  Components components;
  components.of_facet.assign(facet_count, no_facet);
  for (std::uint32_t f = 0; f < facet_count; ++f) {
    if (connectivity.facet_edges[f][0] == no_edge) continue;
    components.of_facet[f] = sets.root(f) == f ? components.count++ : components.of_facet[sets.root(f)];
  }
  return components;
}

}  // namespace

ClosedSurface::ClosedSurface(const Collider& body, const char* which) {
  const std::string name = std::string("the ") + which + (*which ? " body" : "body");
  if (!body.has_surface()) throw std::invalid_argument(name + " has spheres alone, and contact patches need facets");
  const MeshView mesh = body.surface();
  connectivity = morula::connectivity(mesh);
  const MeshReport report = inspect_sides(mesh, connectivity);
  if (!report.closed)
    throw std::invalid_argument(name + " is not closed: " + std::to_string(report.boundary_edges) +
                                " of its edges have one facet only, " + std::to_string(report.nonmanifold_edges) +
                                " more than two; contact patches need closed surfaces");
  if (!report.oriented)
    throw std::invalid_argument(name + " is not oriented: neighboring facets disagree on the outer side at " +
                                std::to_string(report.misoriented_edges) + " edges");
  if (report.volume < 0)
    throw std::invalid_argument(name + " is inside out: its volume is " + std::to_string(report.volume) +
                                ", so turn its facets over");
  components = components_of(mesh.facet_count(), connectivity);
  component_vertex.assign(components.count, 0xffffffffu);
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)
    if (const std::uint32_t component = components.of_facet[f]; component != no_facet)
      for (const std::uint32_t v : mesh.facets[f])
        component_vertex[component] = std::min(component_vertex[component], v);
}

int ShiftedWinding::around(const Collider& body, const Vec3& point, bool of_a) {
  const PlacedSpheres spheres(body);
  const Sphere root = spheres(0);
  if (length(point - root.center) * (1 - 0x1p-49) > root.radius) return 0;
  const ShiftedHalfLine line = shortest_way_out(body, spheres, point, of_a ? 1 : -1);
  const SphereTree& tree = body.tree();
  std::array<std::uint32_t, max_depth * max_branching + 1> stack;
  std::size_t top = 0;
  crossed_.clear();
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t node = stack[--top];
    if (!line.may_meet(spheres(node))) continue;
    if (tree.is_leaf(node)) {
      for (const std::uint32_t facet : body.facets(node))
        if (const int share = line.share(body.triangle(facet)); share != 0) crossed_.emplace_back(facet, share);
      continue;
    }
    for (std::uint32_t k = 0; k < tree.child_count[node]; ++k) stack[top++] = tree.first_child[node] + k;
  }
  // Several leaves may own parts of a facet.
  std::sort(crossed_.begin(), crossed_.end());
  crossed_.erase(std::unique(crossed_.begin(), crossed_.end()), crossed_.end());
  int winding = 0;
  for (const auto& [facet, share] : crossed_) winding += share;
  return winding;
}

}  // namespace morula::detail
