// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/self_loops.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <tuple>

#include "collide/patches/self_predicates.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

constexpr std::uint32_t no_vertex = 0xffffffffu;

int largest_axis(const Vec3& v) {
  const double x = std::abs(v.x), y = std::abs(v.y), z = std::abs(v.z);
  return x > y && x > z ? 0 : y > z ? 1 : 2;
}

bool has_corner(const Facet& facet, std::uint32_t vertex) {
  return facet[0] == vertex || facet[1] == vertex || facet[2] == vertex;
}

std::size_t common_corners(const Facet& f, const Facet& g) {
  std::size_t count = 0;
  for (const std::uint32_t corner : f) count += has_corner(g, corner) ? 1 : 0;
  return count;
}

/// True if a plane through v surely separates a and b from c and d.
bool surely_separate(const Vec3& v, const std::array<Vec3, 2>& f, const std::array<Vec3, 2>& g) {
  const auto unit = [](const Vec3& x) { return x / std::max(length(x), 1e-300); };
  const Vec3 across = unit(f[0] - v) + unit(f[1] - v) - unit(g[0] - v) - unit(g[1] - v);
  const auto is_beyond = [&](const Vec3& p, double sign) {
    // Differences are off by 2^-53, products by twice this, sums of three by four times.
    const Vec3 x = p - v;
    const double size = std::abs(across.x * x.x) + std::abs(across.y * x.y) + std::abs(across.z * x.z);
    // mutant self-separate: `8 * 0x1p-53` -> `-0.3`
    return sign * dot(across, x) > 8 * 0x1p-53 * size + 0x1p-1000;
  };
  return is_beyond(f[0], 1) && is_beyond(f[1], 1) && is_beyond(g[0], -1) && is_beyond(g[1], -1);
}

/// The middle of the part of segment p q that lies in the triangle, all in one plane, as a share of the segment.
double middle_in_plane(const Vec3& p, const Vec3& q, const Triangle& t) {
  const Projection axes = projections[largest_axis(area_vector(t))];
  const int first = axes.first, second = axes.second;
  const auto turn = [&](std::size_t k, const Vec3& x) {
    const Vec3 d = t[(k + 1) % 3] - t[k], e = x - t[k];
    return d[first] * e[second] - d[second] * e[first];
  };
  const double sign = turn(0, t[2]) < 0 ? -1 : 1;
  double low = 0, high = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double at_p = sign * turn(k, p), at_q = sign * turn(k, q);
    if (at_p < 0 && at_q > 0) low = std::max(low, at_p / (at_p - at_q));
    if (at_p > 0 && at_q < 0) high = std::min(high, at_p / (at_p - at_q));
  }
  return 0.5 * (low + high);
}

/// The share of segment p q at which it is nearest to the triangle's longest side; the middle of all if they are
/// parallel.
double nearest_to_sliver(const Vec3& p, const Vec3& q, const Triangle& t) {
  std::size_t k = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (squared_distance(t[i], t[(i + 1) % 3]) > squared_distance(t[k], t[(k + 1) % 3])) k = i;
  const Vec3 d = q - p, e = t[(k + 1) % 3] - t[k], w = t[k] - p, normal = cross(d, e);
  const double square = squared_length(d), across = squared_length(normal);
  if (!(square > 0)) return 0.5;
  if (across > 0x1p-60 * square * squared_length(e)) return std::clamp(dot(cross(w, e), normal) / across, 0.0, 1.0);
  const double from = dot(w, d) / square, to = dot(w + e, d) / square;
  return 0.5 * (std::clamp(std::min(from, to), 0.0, 1.0) + std::clamp(std::max(from, to), 0.0, 1.0));
}

/// True if the triangle's normal is only a few digits, or none.
bool is_sliver(const Triangle& t) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0];
  const double size = std::max({squared_length(u), squared_length(v), squared_distance(t[1], t[2])});
  return !(length(cross(u, v)) > 0x1p-26 * size);
}

}  // namespace

/// Two facets, with the sides of each one's corners relative to the plane of the other; sign 0 for a common corner.
struct SelfLoops::FacetPair {
  std::array<std::uint32_t, 2> facet;
  std::array<Facet, 2> corners;
  std::array<Triangle, 2> triangle;
  std::array<std::array<TrianglePlane::Side, 3>, 2> side;

  IndexedPoint point(std::size_t which, std::size_t k) const { return {triangle[which][k], corners[which][k]}; }
  /// Returns false if all other corners are on one side: then the facets do not cross.
  bool find_sides(std::size_t which, std::uint32_t common) {
    const std::size_t other = 1 - which;
    const TrianglePlane plane(triangle[other]);
    int least = 1, most = -1;
    for (std::size_t k = 0; k < 3; ++k) {
      if (corners[which][k] == common) continue;
      TrianglePlane::Side& s = side[which][k] = plane.side(triangle[which][k]);
      if (s.sign == 0)
        s = {perturbation_orient3d(point(other, 0), point(other, 1), point(other, 2), point(which, k)), 0.0};
      least = std::min(least, s.sign), most = std::max(most, s.sign);
    }
    return least < most;
  }
};

void SelfLoops::find(const Collider& body, const ClosedSurface& surface, SelfTree& tree) {
  body_ = &body;
  surface_ = &surface;
  nodes.clear(), points.clear(), segments.clear(), ends_.clear();
  world.resize(body.vertex_count());
  for (std::uint32_t v = 0; v < world.size(); ++v) world[v] = body.vertex(v);
  InterruptPoller poll_interrupt(256);
  const auto facets = body.mesh_facets();
  tree.update(facets, world);
  tree.each_pair([&](std::uint32_t f, std::uint32_t g) {
    poll_interrupt();
    if (common_corners(facets[f], facets[g]) == 0) test(f, g, no_vertex);
  });
  find_pointed_fans();
  for (std::uint32_t v = 0; v < fans_.size(); ++v)
    if (fans_[v].is_pointed) {
      poll_interrupt();
      test_fan(v);
    }
  number_nodes();
}

// Let the fan of v be projected along an axis. If all its facets run counter-clockwise, and once around v together,
// their projections have common points only at common edges and in v, and so have the facets. The boundary of the fan
// runs around v as often as it passes the height of v upward.
void SelfLoops::find_pointed_fans() {
  const auto facets = body_->mesh_facets();
  fans_.assign(world.size(), {});
  for (std::uint32_t f = 0; f < facets.size(); ++f) {
    if (surface_->connectivity.facet_edges[f][0] == no_edge) continue;
    const Facet& c = facets[f];
    const Vec3 normal = cross(world[c[1]] - world[c[0]], world[c[2]] - world[c[0]]);
    for (const std::uint32_t v : c) fans_[v].normal += normal;
  }
  for (std::uint32_t f = 0; f < facets.size(); ++f) {
    if (surface_->connectivity.facet_edges[f][0] == no_edge) continue;
    const Facet& c = facets[f];
    for (std::size_t k = 0; k < 3; ++k) {
      Fan& fan = fans_[c[k]];
      const int axis = largest_axis(fan.normal);
      const Vec3 &v = world[c[k]], &a = world[c[(k + 1) % 3]], &b = world[c[(k + 2) % 3]];
      const int turn = certain_orient2d(v, a, b, projections[axis]);
      if (turn == 0 || (turn > 0) != (fan.normal[axis] > 0)) fan.is_pointed = true;
      const int second = projections[axis].second;
      if (a[second] <= v[second] && b[second] > v[second] && ++fan.upward > 1) fan.is_pointed = true;
    }
  }
}

void SelfLoops::test_fan(std::uint32_t vertex) {
  const auto fan = surface_->connectivity.vertex_facets(vertex);
  const auto facets = body_->mesh_facets();
  const auto others = [&](std::uint32_t f) {
    const Facet& c = facets[f];
    const std::size_t k = c[0] == vertex ? 0 : c[1] == vertex ? 1 : 2;
    return std::array{world[c[(k + 1) % 3]], world[c[(k + 2) % 3]]};
  };
  for (std::size_t i = 0; i < fan.size(); ++i)
    for (std::size_t j = i + 1; j < fan.size(); ++j)
      if (common_corners(facets[fan[i]], facets[fan[j]]) == 1 &&
          !surely_separate(world[vertex], others(fan[i]), others(fan[j])))
        test(fan[i], fan[j], vertex);
}

// An edge passes through a facet if its ends are on different sides of the plane and its line passes the three edges of
// the facet on the same side. The signs are exact, so both facets of an edge find the same nodes.
void SelfLoops::test(std::uint32_t facet_a, std::uint32_t facet_b, std::uint32_t common) {
  // Facets with a repeated index have no area, no edges of their own, and do not count as part of the surface.
  const auto& edges = surface_->connectivity.facet_edges;
  if (edges[facet_a][0] == no_edge || edges[facet_b][0] == no_edge) return;
  FacetPair pair{{facet_a, facet_b}, {body_->mesh_facets()[facet_a], body_->mesh_facets()[facet_b]}, {}, {}};
  for (std::size_t which = 0; which < 2; ++which)
    for (std::size_t k = 0; k < 3; ++k) pair.triangle[which][k] = world[pair.corners[which][k]];
  if (!pair.find_sides(0, common) || !pair.find_sides(1, common)) return;
  std::size_t found = 0;
  const auto segment = static_cast<std::uint32_t>(segments.size());
  for (std::size_t which = 0; which < 2; ++which)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (pair.corners[which][k] == common || pair.corners[which][next] == common) continue;
      const int first = pair.side[which][k].sign, second = pair.side[which][next].sign;
      if (first == second) continue;
      const auto turn = [&](std::size_t j) {
        return perturbed_orient3d(pair.point(which, k), pair.point(which, next), pair.point(1 - which, j),
                                  pair.point(1 - which, (j + 1) % 3));
      };
      const int passes = turn(0);
      if (passes != turn(1) || passes != turn(2)) continue;
      const bool enters = first > second;
      ends_.push_back({node_of(pair, which, k, next), segment, enters == (which == 0)});
      ++found;
    }
  if (found == 0) return;
  if (common != no_vertex) {
    assert(found == 1);
    ends_.push_back({{no_edge, common, 0, 0}, segment, !ends_.back().is_to});
  } else {
    assert(found == 2);
  }
  segments.push_back({facet_a, facet_b, 0, 0});
}

// The planes' normals of slivers have no digits. There, and where the edge lies in the plane, any point on the edge
// that lies in the facet will do: the facets' parts are those of a surface that is moved within its rounding errors.
SelfNode SelfLoops::node_of(const FacetPair& pair, std::size_t side, std::size_t k, std::size_t next) const {
  const std::uint32_t edge = surface_->connectivity.facet_edges[pair.facet[side]][k];
  if (pair.corners[side][k] != surface_->connectivity.edges[edge][0]) std::swap(k, next);
  const TrianglePlane::Side &s0 = pair.side[side][k], &s1 = pair.side[side][next];
  const double h0 = std::max(0.0, s0.value * s0.sign), h1 = std::max(0.0, s1.value * s1.sign), sum = h0 + h1;
  const Vec3 &p = pair.triangle[side][k], &q = pair.triangle[side][next];
  const Triangle& other = pair.triangle[1 - side];
  // mutant self-sliver: `is_sliver(other)` -> `false`
  const double along = is_sliver(other) ? nearest_to_sliver(p, q, other)
                       : sum > 0        ? h0 / sum
                                        : middle_in_plane(p, q, other);
  return {edge, pair.facet[1 - side], along, s0.sign > s1.sign ? 1 : -1};
}

// Both facets of an edge have found its node; they have computed the same bits for it.
void SelfLoops::number_nodes() {
  std::sort(ends_.begin(), ends_.end(), [](const End& p, const End& q) {
    return std::tie(p.node.edge, p.node.facet, p.segment, p.is_to) <
           std::tie(q.node.edge, q.node.facet, q.segment, q.is_to);
  });
  for (const End& end : ends_) {
    if (nodes.empty() || nodes.back().edge != end.node.edge || nodes.back().facet != end.node.facet)
      nodes.push_back(end.node);
    SelfSegment& segment = segments[end.segment];
    (end.is_to ? segment.to : segment.from) = static_cast<std::uint32_t>(nodes.size() - 1);
  }
  const auto& edges = surface_->connectivity.edges;
  origin = nodes.empty() ? world[body_->mesh_facets()[0][0]] : world[edges[nodes[0].edge][0]];
  for (const SelfNode& node : nodes) {
    if (node.is_vertex()) {
      points.push_back(world[node.facet] - origin);
      continue;
    }
    const Vec3 p = world[edges[node.edge][0]] - origin, q = world[edges[node.edge][1]] - origin;
    points.push_back(node.along <= 0.5 ? p + (q - p) * node.along : q + (p - q) * (1 - node.along));
  }
}

}  // namespace morula::detail
