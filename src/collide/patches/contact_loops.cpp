// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/contact_loops.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "collide/patches/shifted_predicates.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

/// The position on an edge that is nearest to `along` and in the triangle, both projected along the triangle's normal;
/// `along` if the edge passes the triangle.
double within(const Triangle& t, const Vec3& from, const Vec3& to, double along) {
  const Projection axes = TrianglePlane(t).projection();
  const int first = axes.first, second = axes.second;
  const auto turn = [&](const Vec3& p, const Vec3& q, const Vec3& x) {
    return (q[first] - p[first]) * (x[second] - p[second]) - (q[second] - p[second]) * (x[first] - p[first]);
  };
  const double outward = turn(t[0], t[1], t[2]) < 0 ? -1 : 1;
  double low = 0, high = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double h = outward * turn(t[k], t[(k + 1) % 3], from), g = outward * turn(t[k], t[(k + 1) % 3], to);
    if (h < 0 && g > 0) low = std::max(low, h / (h - g));
    if (h > 0 && g < 0) high = std::min(high, h / (h - g));
  }
  return low <= high ? std::clamp(along, low, high) : along;
}

}  // namespace

void LoopNodeTable::clear() {
  used_ = 0;
  if (++now_ != 0) return;
  std::fill(slots_.begin(), slots_.end(), Slot{0, 0, none});
  now_ = 1;
}

LoopNodeTable::Slot& LoopNodeTable::slot_of(std::uint64_t key) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t place = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15u) >> 32) & mask;
  while (slots_[place].batch == now_ && slots_[place].key != key) place = (place + 1) & mask;
  return slots_[place];
}

void LoopNodeTable::grow() {
  const std::vector<Slot> before = std::exchange(slots_, std::vector<Slot>(4 * slots_.size(), Slot{0, 0, none}));
  for (const Slot& slot : before)
    if (slot.batch == now_) slot_of(slot.key) = slot;
}

std::uint32_t& LoopNodeTable::operator[](std::uint64_t key) {
  if (2 * (used_ + 1) > slots_.size()) grow();
  Slot& slot = slot_of(key);
  if (slot.batch != now_) slot = {key, now_, none}, ++used_;
  return slot.node;
}

/// Two facets with the signs of their corners: side[0] of a's corners relative to the plane of b's facet, side[1] of
/// b's corners relative to the plane of a's facet.
struct ContactLoops::FacetPair {
  std::array<std::uint32_t, 2> facet;
  std::array<const Triangle*, 2> triangle;
  std::array<const Facet*, 2> corners;
  std::array<const ClosedSurface*, 2> surface;
  std::array<std::array<TrianglePlane::Side, 3>, 2> side;

  /// True if all corners of one facet are strictly on one side of the other: then they do not cross.
  bool is_apart(std::size_t which) const {
    const auto& s = side[which];
    return s[0].sign != 0 && s[0].sign == s[1].sign && s[0].sign == s[2].sign;
  }
};

bool ContactLoops::find(const Collider& a, const ClosedSurface& surface_a, const Collider& b,
                        const ClosedSurface& surface_b, std::span<const FacetPairKey> pairs, const Vec3& origin,
                        Meter* meter) {
  nodes.clear();
  points.clear();
  segments.clear();
  table_[0].clear();
  table_[1].clear();
  origin_ = origin;
  Triangle corners_a, corners_b;
  std::uint32_t read = no_facet;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i % 64 == 0) {
      check_interrupt();
      if (meter && meter->out_of_time()) return false;
    }
    const std::uint32_t facet_a = pairs[i].facet_a(), facet_b = pairs[i].facet_b();
    // Facets with a repeated index have no area, no edges of their own, and do not count as part of the surface.
    if (surface_a.connectivity.facet_edges[facet_a][0] == no_edge ||
        surface_b.connectivity.facet_edges[facet_b][0] == no_edge)
      continue;
    if (read != facet_a) corners_a = a.triangle(read = facet_a);
    corners_b = b.triangle(facet_b);
    FacetPair pair{{facet_a, facet_b},
                   {&corners_a, &corners_b},
                   {&a.mesh_facets()[facet_a], &b.mesh_facets()[facet_b]},
                   {&surface_a, &surface_b},
                   {}};
    const ShiftedPlane plane_b(corners_b, true), plane_a(corners_a, false);
    for (std::size_t k = 0; k < 3; ++k) pair.side[0][k] = plane_b.side(corners_a[k]);
    if (pair.is_apart(0)) continue;
    for (std::size_t k = 0; k < 3; ++k) pair.side[1][k] = plane_a.side(corners_b[k]);
    if (pair.is_apart(1)) continue;
    add(pair);
  }
  return true;
}

// An edge passes through a facet if its ends are on different sides of the plane and its line passes the three edges of
// the facet on the same side. The signs are exact, so both facets of an edge find the same nodes, and two facets have
// two nodes or none.
void ContactLoops::add(const FacetPair& pair) {
  constexpr int unknown = 2;
  int turns[3][3] = {{unknown, unknown, unknown}, {unknown, unknown, unknown}, {unknown, unknown, unknown}};
  const auto turn = [&](std::size_t i, std::size_t j) {
    int& known = turns[i][j];
    const Triangle &t = *pair.triangle[0], &u = *pair.triangle[1];
    if (known == unknown) known = shifted_edges(t[i], t[(i + 1) % 3], u[j], u[(j + 1) % 3]);
    return known;
  };
  std::uint32_t ends[2] = {LoopNodeTable::none, LoopNodeTable::none};  // from, to
  const auto is_complete = [&] { return ends[0] != LoopNodeTable::none && ends[1] != LoopNodeTable::none; };
  for (std::size_t which = 0; which < 2; ++which)
    for (std::size_t k = 0; k < 3 && !is_complete(); ++k) {
      const std::size_t next = (k + 1) % 3;
      const int first = pair.side[which][k].sign, second = pair.side[which][next].sign;
      if (first == second) continue;
      const auto passes = [&](std::size_t other) { return which == 0 ? turn(k, other) : turn(other, k); };
      if (passes(0) != passes(1) || passes(0) != passes(2)) continue;
      const bool enters = first > second;
      ends[enters == (which == 0) ? 1 : 0] = node(pair, which, k, next);
    }
  if (!is_complete()) {
    assert(ends[0] == ends[1]);
    return;
  }
  segments.push_back({pair.facet[0], pair.facet[1], ends[0], ends[1]});
}

// The point is on the edge up to rounding, wherever the facet's plane meets it, and the same for both facets of the
// edge.
std::uint32_t ContactLoops::node(const FacetPair& pair, std::size_t side, std::size_t k, std::size_t next) {
  const std::uint32_t edge = pair.surface[side]->connectivity.facet_edges[pair.facet[side]][k];
  const std::uint32_t facet = pair.facet[1 - side];
  std::uint32_t& place = table_[side][std::uint64_t{edge} << 32 | facet];
  if (place != LoopNodeTable::none) return place;
  place = static_cast<std::uint32_t>(nodes.size());
  if ((*pair.corners[side])[k] != pair.surface[side]->connectivity.edges[edge][0]) std::swap(k, next);
  const TrianglePlane::Side &s0 = pair.side[side][k], &s1 = pair.side[side][next];
  const double h0 = std::max(0.0, s0.value * s0.sign), h1 = std::max(0.0, s1.value * s1.sign), sum = h0 + h1;
  const Triangle& t = *pair.triangle[1 - side];
  const Vec3 &from = (*pair.triangle[side])[k], &to = (*pair.triangle[side])[next];
  // Heights above the plane have errors of 10 times 2^-53 of the permanent (TrianglePlane), which is at most six times
  // the product of three max norms. For an edge in the plane, up to rounding, the point may be anywhere on the edge.
  const double error =
      0x1p-46 * max_norm(t[1] - t[0]) * max_norm(t[2] - t[0]) * (max_norm(from - t[0]) + max_norm(to - t[0]));
  double along = sum > 0 ? h0 / sum : 0.5, back = sum > 0 ? h1 / sum : 0.5;
  // mutant patches-in-plane-anywhere: `16 * error > sum` -> `false`
  if (16 * error > sum) {
    along = within(t, from, to, along);
    back = 1 - along;
  }
  const Vec3 p = from - origin_, q = to - origin_;
  points.push_back(along <= back ? p + (q - p) * along : q + (p - q) * back);
  nodes.push_back({edge, facet, along, s0.sign > s1.sign ? 1 : -1, static_cast<std::uint8_t>(side)});
  return place;
}

}  // namespace morula::detail
