// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cassert>
#include <morula/collide/containment.hpp>
#include <morula/geometry/inspect.hpp>
#include <stdexcept>
#include <string>

#include "collide/pairs/placed_spheres.hpp"
#include "collide/require.hpp"
#include "geometry/exact_predicates.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

// A half line from a point along an axis, in its direction or against it.
struct HalfLine {
  Vec3 from;
  int axis, side, other;  // axis, side, other are x, y, z in turn
  int sign;               // 1 or -1

  HalfLine(const Vec3& point, int along, int there)
      : from(point), axis(along), side((along + 1) % 3), other((along + 2) % 3), sign(there) {}

  bool may_meet(const Sphere& s) const {
    const double reach = s.radius * (1 + 0x1p-50), ahead = sign * (s.center[axis] - from[axis]);
    const double u = s.center[side] - from[side], v = s.center[other] - from[other];
    return ahead + reach >= 0 && (u * u + v * v) * (1 - 0x1p-49) <= reach * reach;
  }

  // The winding number of the triangle, seen along the axis, around the line: 1, 0 or -1.
  //
  // Edges that pass the point on its right are counted, in the plane of the other two axes. One through the point
  // itself is on its left, a corner at its height is below: as if the point lay higher by e and further right by d,
  // with e much less than d, both less than any number. Each edge is treated alike from both its facets.
  int winding(const Triangle& t) const {
    int turns = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = t[k], &b = t[(k + 1) % 3];
      // mutant inside-counts-corners-twice: `b[other] <=` -> `b[other] <`
      const bool a_below = a[other] <= from[other], b_below = b[other] <= from[other];
      if (a_below == b_below) continue;
      const int turn = orient2d(a, b, from, projections[axis]);
      if (a_below && turn > 0) ++turns;
      if (b_below && turn < 0) --turns;
    }
    return turns;
  }
};

// Whether p is in the closed triangle, exactly.
bool holds(const Triangle& t, const Vec3& p) {
  for (int axis = 0; axis < 3; ++axis) {
    const double a = t[0][axis], b = t[1][axis], c = t[2][axis];
    if (p[axis] < std::min({a, b, c}) || p[axis] > std::max({a, b, c})) return false;
  }
  // mutant inside-surface: `if (orient3d(t[0], t[1], t[2], p) != 0) return` -> `return`
  if (orient3d(t[0], t[1], t[2], p) != 0) return false;
  // The point has to be in the plane, and on no wrong side of an edge along any axis. For triangles without area, it
  // has to be on their line and in the box.
  for (int axis = 0; axis < 3; ++axis) {
    int least = 0, most = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = t[k], &b = t[(k + 1) % 3];
      const int turn = orient2d(a, b, p, projections[axis]);
      least = std::min(least, turn);
      most = std::max(most, turn);
    }
    if (least < 0 && most > 0) return false;
  }
  return true;
}

bool is_in_range(const Vec3& p) {
  return is_finite(p) && max_norm(p) < 0x1p200;
}

// The half line, of the six along the axes, that meets the fewest facets, estimated from nodes two levels down; the
// first of equals.
HalfLine emptiest_way_out(const Collider& body, const PlacedSpheres& spheres, const Vec3& from, std::size_t& tests) {
  const SphereTree& tree = body.tree();
  const std::size_t level = std::min<std::size_t>(2, tree.level_count() - 1);
  const std::array<HalfLine, 6> lines{HalfLine(from, 0, 1),  HalfLine(from, 1, 1),  HalfLine(from, 2, 1),
                                      HalfLine(from, 0, -1), HalfLine(from, 1, -1), HalfLine(from, 2, -1)};
  std::array<std::size_t, 6> facets{};
  for (std::uint32_t node = 0; node < tree.level_begin[level + 1]; ++node) {
    if (node < tree.level_begin[level] && !tree.is_leaf(node)) continue;
    ++tests;
    const Sphere s = spheres(node);
    for (std::size_t k = 0; k < 6; ++k)
      if (lines[k].may_meet(s)) facets[k] += body.facets(node).size();
  }
  return lines[static_cast<std::size_t>(std::min_element(facets.begin(), facets.end()) - facets.begin())];
}

// The facets of all leaves whose spheres the half line may meet, ascending, each once.
std::size_t facets_met(const Collider& body, const PlacedSpheres& spheres, const HalfLine& line,
                       std::vector<std::uint32_t>& facets) {
  const SphereTree& tree = body.tree();
  std::array<std::uint32_t, max_depth * max_branching + 1> stack;
  std::size_t top = 0, tests = 0;
  facets.clear();
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t node = stack[--top];
    ++tests;
    if (!line.may_meet(spheres(node))) continue;
    if (tree.is_leaf(node)) {
      const auto owned = body.facets(node);
      facets.insert(facets.end(), owned.begin(), owned.end());
      continue;
    }
    assert(top + tree.child_count[node] <= stack.size());
    for (std::uint32_t k = 0; k < tree.child_count[node]; ++k) stack[top++] = tree.first_child[node] + k;
  }
  std::sort(facets.begin(), facets.end());
  facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
  return tests;
}

}  // namespace

std::vector<std::uint32_t> component_vertices(const MeshView& mesh) {
  const Components components = components_by_vertices(mesh);
  std::vector<std::uint32_t> lowest(components.count, 0xffffffffu);
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)
    for (const std::uint32_t v : mesh.facets[f])
      lowest[components.of_facet[f]] = std::min(lowest[components.of_facet[f]], v);
  std::sort(lowest.begin(), lowest.end());
  return lowest;
}

InsideQuery::InsideQuery(const Collider& body) : body_(hold(body)) {
  const StandardFloats standard;
  if (!body.has_surface()) throw std::invalid_argument(message(Status{Status::Code::no_surface}));
  const MeshReport report = inspect(body.surface());
  if (!report.closed)
    throw std::invalid_argument("an open surface has no inside: " + std::to_string(report.boundary_edges) +
                                " of its edges have one facet only, " + std::to_string(report.nonmanifold_edges) +
                                " more than two");
  is_oriented_ = report.oriented;
}

PointLocation InsideQuery::locate(const Vec3& point) {
  const StandardFloats standard;
  PointLocation result;
  result.status = askable(*body_);
  if (result.status && !is_in_range(point)) result.status = {Status::Code::bad_shape};
  if (!result.status) return result;
  result.certified = body_->sphere_state().covers;

  const PlacedSpheres spheres(*body_);
  const Sphere root = spheres(0);
  result.sphere_tests = 1;
  const Vec3 offset = point - root.center;
  if (length(offset) * (1 - 0x1p-49) > root.radius) return result;
  const HalfLine line = emptiest_way_out(*body_, spheres, point, result.sphere_tests);
  result.sphere_tests += facets_met(*body_, spheres, line, facets_);

  std::size_t crossings = 0;
  for (const std::uint32_t facet : facets_) {
    ++result.facet_tests;
    const Triangle t = body_->triangle(facet);
    if (holds(t, point)) {
      result.on_surface = result.inside = true;
      result.winding = 0;
      return result;
    }
    const int turns = line.winding(t);
    // A facet that faces along the axis (turns = 1) is ahead when the point is behind it.
    if (turns == 0 || orient3d(t[0], t[1], t[2], point) * turns * line.sign >= 0) continue;
    result.winding += turns * line.sign;
    ++crossings;
  }
  result.inside = is_oriented_ ? result.winding != 0 : crossings % 2 == 1;
  if (!is_oriented_) result.winding = 0;
  return result;
}

Probe InsideQuery::probe(const Sphere& ball) {
  const StandardFloats standard;
  Probe result;
  const Touch& touch = touch_.run(*body_, ball, {.nearest = true});
  if (!touch.status) {
    result.status = touch.status;
    return result;
  }
  const PointLocation location = locate(ball.center);
  result.inside = location.inside;
  result.nearest = touch.deepest->point;
  const Vec3 out = result.nearest.point - ball.center;
  const double away = length(out);
  result.distance = result.inside ? -away : away;
  result.depth = ball.radius - result.distance;
  result.touches = result.depth >= 0;
  // From the center through the wall, or back from the wall; where the two coincide, up to rounding, along the facet's
  // normal.
  if (max_norm(out) > 0x1p-40 * max_norm(ball.center))
    result.normal = normalized(result.inside ? out : -out);
  else
    result.normal = normalized(area_vector(body_->triangle(result.nearest.facet)));
  return result;
}

bool InsideQuery::components_inside(const Collider& other, std::span<const std::uint32_t> vertices,
                                    Containment& result) {
  const StandardFloats standard;
  result.status = askable(*body_, 1);
  if (result.status) result.status = askable(other, 0);
  for (const std::uint32_t vertex : vertices)
    if (result.status && vertex >= other.vertex_count()) result.status = {Status::Code::bad_option};
  result.inside.clear();
  result.inside_count = 0;
  result.certified = body_->sphere_state().covers;
  if (!result.status) return false;
  // An exception leaves a result whose status is ended_by_exception.
  result.status = {Status::Code::ended_by_exception};
  const PairAsRead read(other, *body_);
  for (const std::uint32_t vertex : vertices) {
    check_interrupt();
    const bool inside = locate(other.vertex(vertex)).inside;
    result.inside.push_back(inside ? 1 : 0);
    result.inside_count += inside ? 1 : 0;
  }
  result.status = read.status();
  if (result.status) return true;
  result.inside.clear();
  result.inside_count = 0;
  return false;
}

}  // namespace morula
