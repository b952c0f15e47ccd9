// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "medial/delaunay.hpp"

#include <algorithm>
#include <cassert>

#include "geometry/wide_integers.hpp"

namespace morula::detail {
namespace {

using Difference = std::array<std::int64_t, 3>;  // each at most 2²⁰ in size

Difference operator-(const LatticePoint& a, const LatticePoint& b) {
  return {std::int64_t{a[0]} - b[0], std::int64_t{a[1]} - b[1], std::int64_t{a[2]} - b[2]};
}

Difference cross(const Difference& a, const Difference& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Three products below 2⁶¹: the sum stays below 2⁶³.
std::int64_t determinant(const Difference& a, const Difference& b, const Difference& c) {
  const Difference n = cross(a, b);
  return n[0] * c[0] + n[1] * c[1] + n[2] * c[2];
}

std::int64_t squared_length(const Difference& a) {
  return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
}

/// Positive when a, b, c are counter-clockwise seen from d.
std::int64_t orientation(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c, const LatticePoint& d) {
  return determinant(b - a, c - a, d - a);
}

/// p strictly inside the sphere through four points of positive orientation.
bool in_sphere(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c, const LatticePoint& d,
               const LatticePoint& p) {
  const Difference pa = a - p, pb = b - p, pc = c - p, pd = d - p;
  // The determinant of the rows (x, y, z, x² + y² + z²), by its last column; the two cross products serve all four.
  const Difference ab = cross(pa, pb), cd = cross(pc, pd);
  const auto dot = [](const Difference& u, const Difference& v) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; };
  const Int128 sum = Int128{squared_length(pa)} * dot(pb, cd) - Int128{squared_length(pb)} * dot(pa, cd) +
                     Int128{squared_length(pc)} * dot(ab, pd) - Int128{squared_length(pd)} * dot(ab, pc);
  return sum > 0;
}

std::uint32_t index_in(const std::array<std::uint32_t, 4>& items, std::uint32_t item) {
  return items[0] == item ? 0 : items[1] == item ? 1 : items[2] == item ? 2 : 3;
}

}  // namespace

bool Delaunay::insert(const LatticePoint& p) {
  assert(std::all_of(p.begin(), p.end(), [](std::int32_t x) { return x >= 0 && x <= lattice_size; }));
  if (simplex_.size() < 4) return wait_for_space(p);
  points_.push_back(p);
  at_point_.push_back(no_point);
  if (insert_in_space(static_cast<std::uint32_t>(points_.size() - 1))) return true;
  points_.pop_back();
  at_point_.pop_back();
  return false;
}

/// Points on one line or in one plane wait for a point that is not; then all of them are inserted.
bool Delaunay::wait_for_space(const LatticePoint& p) {
  if (std::find(points_.begin(), points_.end(), p) != points_.end()) return false;
  const auto point = static_cast<std::uint32_t>(points_.size());
  points_.push_back(p);
  at_point_.push_back(no_point);
  const auto corner = [&](std::size_t i) { return points_[simplex_[i]]; };
  switch (simplex_.size()) {
    case 2:
      if (cross(corner(1) - corner(0), p - corner(0)) == Difference{0, 0, 0}) return true;
      break;
    case 3:
      if (orientation(corner(0), corner(1), corner(2), p) == 0) return true;
      break;
    default:
      break;  // the point differs from all earlier ones, and the first two need nothing else
  }
  simplex_.push_back(point);
  if (simplex_.size() == 4) start(point);
  return true;
}

void Delaunay::start(std::uint32_t apex) {
  std::array<std::uint32_t, 4> v = {simplex_[0], simplex_[1], simplex_[2], apex};
  if (orientation(points_[v[0]], points_[v[1]], points_[v[2]], points_[v[3]]) < 0) std::swap(v[0], v[1]);
  for (int i = 0; i < 5; ++i) take_slot();
  tetrahedra_[0] = {v, {1, 2, 3, 4}};
  // Ghost k + 1 is behind the facet across from v[k]: v with no_point for v[k] has that facet's outside turned in, so
  // two corners change places.
  for (std::uint32_t k = 0; k < 4; ++k) {
    Tetrahedron& ghost = tetrahedra_[k + 1];
    std::uint32_t corner = 0;
    for (std::uint32_t j = 0; j < 4; ++j) {
      if (j == k) continue;
      ghost.vertices[corner] = v[j];
      ghost.neighbors[corner++] = j + 1;  // across from v[j], facing both v[k]'s ghost and v[j]'s
    }
    ghost.vertices[3] = no_point;
    ghost.neighbors[3] = 0;
    // (…, v[k] moved to the end) is as positive as v after an even number of exchanges, and the ghost must be the
    // opposite of that.
    if ((3 - k) % 2 == 0) {
      std::swap(ghost.vertices[0], ghost.vertices[1]);
      std::swap(ghost.neighbors[0], ghost.neighbors[1]);
    }
    at_point_[v[k]] = 0;
  }
  created_.assign({0, 1, 2, 3, 4});
  for (std::uint32_t point = 0; point < points_.size(); ++point) {
    if (std::find(v.begin(), v.end(), point) == v.end()) insert_in_space(point);
  }
  // Many insertions in one: no slot was filled earlier.
  free_.insert(free_.end(), cavity_.begin(), cavity_.end());
  cavity_.clear();
  created_.clear();
  for (std::uint32_t slot = 0; slot < tetrahedra_.size(); ++slot) {
    if (is_alive(slot)) created_.push_back(slot);
  }
}

bool Delaunay::insert_in_space(std::uint32_t point) {
  const LatticePoint& p = points_[point];
  const std::uint32_t first = locate(p);
  if (!is_ghost(first)) {
    for (const std::uint32_t vertex : tetrahedra_[first].vertices) {
      if (points_[vertex] == p) return false;
    }
  }
  find_cavity(first, p);
  fill_cavity(point);
  for (const std::uint32_t slot : cavity_) tetrahedra_[slot].vertices[0] = no_point;
  return true;
}

/// The nearest of a few points, the last one among them: n^¼ of them balance this search with the walk that follows.
std::uint32_t Delaunay::walk_start(const LatticePoint& p) const {
  std::uint32_t best = no_point;
  std::int64_t best_distance = 0;
  const auto consider = [&](std::uint32_t point) {
    if (at_point_[point] == no_point) return;
    const std::int64_t distance = squared_length(points_[point] - p);
    if (best != no_point && distance >= best_distance) return;
    best = point;
    best_distance = distance;
  };
  for (const std::uint32_t point : simplex_) consider(point);
  const std::size_t count = points_.size() - 1;
  consider(static_cast<std::uint32_t>(count - 1));
  std::uint64_t state = count;
  for (std::size_t tries = 1; tries * tries * tries * tries < count; ++tries) {
    state = state * 0x9e3779b97f4a7c15u + 0x7f4a7c15u;
    consider(static_cast<std::uint32_t>((state >> 32) % count));
  }
  return at_point_[best];
}

/// A tetrahedron that contains p, or a ghost that p is strictly outside of. A step from T to N lowers p's power, or
/// leaves it where both have one sphere; and as ties are broken by the order of insertion, which is a perturbation of
/// the points' heights on the paraboloid, the walk cannot return to an earlier place.
std::uint32_t Delaunay::locate(const LatticePoint& p) const {
  std::uint32_t slot = walk_start(p);
  std::uint32_t from = no_point;
  while (!is_ghost(slot)) {
    const Tetrahedron& t = tetrahedra_[slot];
    std::uint32_t k = 0;
    for (; k < 4; ++k) {
      if (t.neighbors[k] == from) continue;
      std::array<const LatticePoint*, 4> corners;
      for (std::uint32_t j = 0; j < 4; ++j) corners[j] = j == k ? &p : &points_[t.vertices[j]];
      if (orientation(*corners[0], *corners[1], *corners[2], *corners[3]) < 0) break;
    }
    if (k == 4) break;
    from = slot;
    slot = t.neighbors[k];
  }
  return slot;
}

bool Delaunay::in_conflict(std::uint32_t slot, const LatticePoint& p) const {
  const Tetrahedron& t = tetrahedra_[slot];
  const LatticePoint &a = points_[t.vertices[0]], &b = points_[t.vertices[1]], &c = points_[t.vertices[2]];
  if (!is_ghost(slot)) return in_sphere(a, b, c, points_[t.vertices[3]], p);
  // A ghost's sphere is the half-space outside, and of its plane the inside of the facet's circle, which is where the
  // plane meets the sphere on the other side of the facet.
  const std::int64_t side = orientation(a, b, c, p);
  return side > 0 || (side == 0 && in_conflict(t.neighbors[3], p));
}

void Delaunay::find_cavity(std::uint32_t first, const LatticePoint& p) {
  stamp_ += 2;
  free_.insert(free_.end(), cavity_.begin(),
               cavity_.end());  // only after the fill, so that no slot is both freed and filled
  cavity_.assign(1, first);
  border_.clear();
  mark_[first] = stamp_;
  for (std::size_t i = 0; i < cavity_.size(); ++i) {
    const std::uint32_t slot = cavity_[i];
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t neighbor = tetrahedra_[slot].neighbors[k];
      if (mark_[neighbor] == stamp_) continue;
      if (mark_[neighbor] != stamp_ + 1 && in_conflict(neighbor, p)) {
        mark_[neighbor] = stamp_;
        cavity_.push_back(neighbor);
      } else {
        mark_[neighbor] = stamp_ + 1;
        border_.push_back({slot, k});
      }
    }
  }
}

/// One tetrahedron from each facet of the border to the point: the one inside the cavity with its corner replaced,
/// which keeps orientations, and ghosts stay ghosts.
void Delaunay::fill_cavity(std::uint32_t point) {
  created_.clear();
  for (const Side& side : border_) {
    const std::uint32_t slot = take_slot();
    created_.push_back(slot);
    Tetrahedron& t = tetrahedra_[slot];
    t.vertices = tetrahedra_[side.tetrahedron].vertices;
    t.vertices[side.facet] = point;
    const std::uint32_t outer = tetrahedra_[side.tetrahedron].neighbors[side.facet];
    t.neighbors[side.facet] = outer;
    std::array<std::uint32_t, 4>& back = tetrahedra_[outer].neighbors;
    back[index_in(back, side.tetrahedron)] = slot;
    replacements_[side.tetrahedron][side.facet] = slot;
    if (t.vertices[3] == no_point) continue;
    for (const std::uint32_t vertex : t.vertices) at_point_[vertex] = slot;
  }
  for (std::size_t i = 0; i < border_.size(); ++i) {
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (k == border_[i].facet) continue;
      std::uint32_t pivot = border_[i].facet;
      const Side end = around_edge({border_[i].tetrahedron, k}, pivot);
      const std::uint32_t other = replacements_[end.tetrahedron][end.facet];
      tetrahedra_[created_[i]].neighbors[k] = other;
      tetrahedra_[other].neighbors[pivot] = created_[i];
    }
  }
}

/// Two facets of the border meet in every edge of theirs. From a tetrahedron whose facet `pivot` is on the border, turn
/// through the cavity about the edge in its facets `pivot` and `from.facet`, to the border. On return `pivot` is the
/// corner there that is neither on the edge nor across from the border.
Delaunay::Side Delaunay::around_edge(Side from, std::uint32_t& pivot) const {
  for (;;) {
    const Tetrahedron& here = tetrahedra_[from.tetrahedron];
    const std::uint32_t next = here.neighbors[from.facet];
    if (mark_[next] != stamp_) return from;
    // next has the edge, the corner `pivot` of here, and one more corner: the walk leaves across from the former, and
    // the latter is the next pivot.
    const Tetrahedron& there = tetrahedra_[next];
    const std::uint32_t leave = index_in(there.vertices, here.vertices[pivot]);
    pivot = index_in(there.neighbors, from.tetrahedron);
    from = {next, leave};
  }
}

std::uint32_t Delaunay::take_slot() {
  if (!free_.empty()) {
    const std::uint32_t slot = free_.back();
    free_.pop_back();
    return slot;
  }
  tetrahedra_.push_back({{no_point, no_point, no_point, no_point}, {no_point, no_point, no_point, no_point}});
  mark_.push_back(0);
  replacements_.emplace_back();
  return static_cast<std::uint32_t>(tetrahedra_.size() - 1);
}

Vec3 Delaunay::circumcenter_offset(std::uint32_t slot) const {
  const std::array<std::uint32_t, 4>& v = tetrahedra_[slot].vertices;
  const LatticePoint& a = points_[v[0]];
  const Difference b = points_[v[1]] - a, c = points_[v[2]] - a, d = points_[v[3]] - a;
  const Difference cd = cross(c, d), db = cross(d, b), bc = cross(b, c);
  const Int128 bb = squared_length(b), cc = squared_length(c), dd = squared_length(d);
  const double denominator = 2.0 * static_cast<double>(determinant(b, c, d));
  Vec3 offset;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    offset[axis] = static_cast<double>(bb * cd[i] + cc * db[i] + dd * bc[i]) / denominator;
  }
  return offset;
}

}  // namespace morula::detail
