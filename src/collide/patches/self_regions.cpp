// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/self_regions.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>

#include "parallel/interruption.hpp"

namespace morula::detail {

namespace {

std::vector<Vec3> positions_of(const Collider& body) {
  std::vector<Vec3> world(body.vertex_count());
  for (std::uint32_t v = 0; v < world.size(); ++v) world[v] = body.vertex(v);
  return world;
}

}  // namespace

SelfSurface::SelfSurface(const Collider& body)
    : closed(body, ""),
      parts(components_by_edges(body.surface(), closed.connectivity)),
      part_edge(parts.count, no_edge),
      tree(body.mesh_facets(), positions_of(body)) {
  // Around an edge of four facets there are two numbers outside.
  std::size_t edges = 0;
  for (std::uint32_t e = 0; e < closed.connectivity.edge_count(); ++e)
    edges += closed.connectivity.edge_sides(e).size() > 2 ? 1 : 0;
  if (edges > 0)
    throw std::invalid_argument("the body has " + std::to_string(edges) +
                                " edges with more than two facets; contact patches of one body need two at each edge");
  for (std::uint32_t f = 0; f < parts.of_facet.size(); ++f)
    if (std::uint32_t& edge = part_edge[parts.of_facet[f]]; edge == no_edge)
      edge = closed.connectivity.facet_edges[f][0];
}

void SelfRegions::find(const Collider& body, const SelfSurface& surface, const SelfLoops& loops,
                       const Earlier& earlier) {
  origin_ = loops.origin;
  SurfaceRegion& s = side[0];
  s.start(body, surface.closed, true);
  side[1].start(body, surface.closed, false);
  start(loops);
  sort(loops);
  find_numbers(surface, loops);
  add_cut_facets(loops);
  const std::size_t cut = s.parts.size();
  add_whole_facets(s);
  for (std::size_t i = 0; i < cut; ++i) join_holes(s, s.parts[i]);
  assign_patches(loops);
  choose_sides(earlier);
  join_cavities();
  number_patches();
  distribute();
}

// Elements 2 n and 2 n + 1 are node n on the surface of its edge and on that of its facet. A vertex is one element.
void SelfRegions::start(const SelfLoops& loops) {
  SurfaceRegion& s = side[0];
  points.clear();
  sets_.clear();
  for (std::uint32_t n = 0; n < loops.nodes.size(); ++n) {
    points.insert(points.end(), 2, loops.points[n]);
    sets_.add(), sets_.add();
    const SelfNode& node = loops.nodes[n];
    if (!node.is_vertex()) continue;
    s.element_run[node.facet] = s.now;
    s.element[node.facet] = 2 * n;
  }
}

std::uint32_t SelfRegions::on_sheet(const SelfLoops& loops, std::uint32_t node, std::uint32_t facet) const {
  const SelfNode& n = loops.nodes[node];
  return !n.is_vertex() && n.facet == facet ? 2 * node + 1 : 2 * node;
}

void SelfRegions::sort(const SelfLoops& loops) {
  SurfaceRegion& s = side[0];
  incidences_.clear();
  for (std::uint32_t i = 0; i < loops.segments.size(); ++i) {
    incidences_.push_back({loops.segments[i].facet_a, i});
    incidences_.push_back({loops.segments[i].facet_b, i});
  }
  std::sort(incidences_.begin(), incidences_.end(), [](const Incidence& p, const Incidence& q) {
    return std::tie(p.facet, p.segment) < std::tie(q.facet, q.segment);
  });
  cut_begin_.resize(s.facet_run.size());
  for (std::uint32_t i = 0; i < incidences_.size(); ++i) {
    const std::uint32_t facet = incidences_[i].facet;
    if (s.facet_run[facet] == s.now) continue;
    s.facet_run[facet] = s.now;
    s.is_cut[facet] = 1;
    cut_begin_[facet] = i;
  }
  s.edge_nodes.clear();
  for (std::uint32_t n = 0; n < loops.nodes.size(); ++n)
    if (!loops.nodes[n].is_vertex()) s.edge_nodes.push_back(n);
  std::sort(s.edge_nodes.begin(), s.edge_nodes.end(), [&](std::uint32_t p, std::uint32_t q) {
    const SelfNode &m = loops.nodes[p], &n = loops.nodes[q];
    return std::tie(m.edge, m.along, m.facet) < std::tie(n.edge, n.along, n.facet);
  });
  for (std::uint32_t i = 0; i < s.edge_nodes.size(); ++i) {
    const std::uint32_t edge = loops.nodes[s.edge_nodes[i]].edge;
    if (s.edge_run[edge] != s.now) s.edge_begin[edge] = i;
    s.edge_run[edge] = s.now;
    s.edge_end[edge] = i + 1;
  }
}

std::span<const SelfRegions::Incidence> SelfRegions::segments_of(std::uint32_t facet) const {
  std::size_t end = cut_begin_[facet];
  while (end < incidences_.size() && incidences_[end].facet == facet) ++end;
  return std::span(incidences_).subspan(cut_begin_[facet], end - cut_begin_[facet]);
}

// One edge of each connected set of cut facets is located; edges of cut facets, and facets wholly inside, lead from one
// edge to the next. A part of the surface that no curve crosses is wholly inside or outside.
void SelfRegions::find_numbers(const SelfSurface& surface, const SelfLoops& loops) {
  SurfaceRegion& s = side[0];
  const Connectivity& connectivity = surface.closed.connectivity;
  number_run_.resize(connectivity.edge_count());
  number_.resize(connectivity.edge_count());
  s.component_run.resize(std::max<std::size_t>(s.component_run.size(), surface.parts.count));
  std::fill(s.component_run.begin(), s.component_run.end(), 0);
  std::fill(number_run_.begin(), number_run_.end(), 0);
  const auto locate = [&](std::uint32_t edge) {
    if (edge == no_edge || number_run_[edge] == s.now) return;
    check_interrupt();
    spread(loops, edge, number_outside(s.body->mesh_facets(), connectivity, surface.tree, loops.world, edge));
  };
  for (const Incidence& incidence : incidences_) {
    s.component_run[surface.parts.of_facet[incidence.facet]] = s.now;
    locate(connectivity.facet_edges[incidence.facet][0]);
  }
  for (std::uint32_t part = 0; part < surface.parts.count; ++part)
    if (s.component_run[part] != s.now) locate(surface.part_edge[part]);
}

int SelfRegions::jumps_of(const SelfLoops& loops, std::uint32_t edge) const {
  int sum = 0;
  for (const std::uint32_t node : side[0].nodes_of(edge)) sum += loops.nodes[node].jump;
  return sum;
}

/// The number at the edge with which the boundary of the facet leaves the vertex, less that at the edge with which it
/// arrives: the segments that end in the vertex, less those that begin there.
int SelfRegions::step_at(const SelfLoops& loops, std::uint32_t facet, std::uint32_t vertex) const {
  int step = 0;
  for (const Incidence& incidence : segments_of(facet)) {
    const SelfSegment& segment = loops.segments[incidence.segment];
    const int forward = segment.facet_a == facet ? 1 : -1;
    const SelfNode &from = loops.nodes[segment.from], &to = loops.nodes[segment.to];
    if (to.is_vertex() && to.facet == vertex) step += forward;
    if (from.is_vertex() && from.facet == vertex) step -= forward;
  }
  return step;
}

// The jumps are exact and consistent, so an edge has the same number from wherever it is reached.
void SelfRegions::spread(const SelfLoops& loops, std::uint32_t edge, int number) {
  SurfaceRegion& s = side[0];
  const Connectivity& connectivity = s.surface->connectivity;
  s.queue.clear();
  const auto reach = [&](std::uint32_t e, int n) {
    assert(number_run_[e] != s.now || number_[e] == n);
    if (number_run_[e] == s.now) return;
    number_run_[e] = s.now;
    number_[e] = n;
    s.queue.push_back(e);
  };
  reach(edge, number);
  for (std::size_t next = 0; next < s.queue.size(); ++next) {
    const std::uint32_t e = s.queue[next];
    const int at_first = number_[e], jumps = jumps_of(loops, e);
    for (const std::uint32_t side_of_edge : connectivity.edge_sides(e)) {
      const std::uint32_t facet = side_of_edge / 3, k = side_of_edge % 3, after = (k + 1) % 3, before = (k + 2) % 3;
      const Facet& corners = s.body->mesh_facets()[facet];
      const auto& edges = connectivity.facet_edges[facet];
      if (s.facet_run[facet] == s.now && s.is_cut[facet]) {
        const bool forward = corners[k] == connectivity.edges[e][0];
        const int begins = forward ? at_first : at_first + jumps, ends = forward ? at_first + jumps : at_first;
        const int leaves = ends + step_at(loops, facet, corners[after]);
        const int arrives = begins - step_at(loops, facet, corners[k]);
        // The side after this one begins at its end; the side before ends at its begin.
        reach(edges[after],
              connectivity.edges[edges[after]][0] == corners[after] ? leaves : leaves - jumps_of(loops, edges[after]));
        reach(edges[before],
              connectivity.edges[edges[before]][0] == corners[k] ? arrives : arrives - jumps_of(loops, edges[before]));
      } else if (s.facet_run[facet] != s.now && at_first != 0) {
        s.facet_run[facet] = s.now;
        s.is_cut[facet] = 0;
        s.wholes.push_back({facet, at_first});
        reach(edges[after], at_first);
        reach(edges[before], at_first);
      }
    }
  }
}

void SelfRegions::add_cut_facets(const SelfLoops& loops) {
  SurfaceRegion& s = side[0];
  for (std::size_t i = 0; i < incidences_.size();) {
    const std::uint32_t facet = incidences_[i].facet;
    const auto begin = static_cast<std::uint32_t>(s.pieces.size());
    for (; i < incidences_.size() && incidences_[i].facet == facet; ++i) {
      const SelfSegment& segment = loops.segments[incidences_[i].segment];
      const std::uint32_t from = on_sheet(loops, segment.from, facet), to = on_sheet(loops, segment.to, facet);
      if (segment.facet_a == facet)
        add_piece(s, {from, to, 1, true});
      else
        add_piece(s, {to, from, 1, true});
    }
    for (std::size_t k = 0; k < 3; ++k) add_edge(loops, facet, k);
    s.parts.push_back({0, facet, begin, static_cast<std::uint32_t>(s.pieces.size())});
  }
}

void SelfRegions::add_edge(const SelfLoops& loops, std::uint32_t facet, std::size_t k) {
  SurfaceRegion& s = side[0];
  const std::uint32_t edge = s.surface->connectivity.facet_edges[facet][k];
  const auto& [low, high] = s.surface->connectivity.edges[edge];
  const bool forward = s.body->mesh_facets()[facet][k] == low;
  const auto add = [&](std::uint32_t from, std::uint32_t to, int number) {
    add_piece(s, forward ? BoundaryPiece{from, to, number, false} : BoundaryPiece{to, from, number, false});
  };
  int number = number_[edge];
  std::uint32_t last = number != 0 ? element_of(s, low) : 0;
  for (const std::uint32_t node : s.nodes_of(edge)) {
    if (number != 0) add(last, 2 * node, number);
    number += loops.nodes[node].jump;
    last = 2 * node;
  }
  if (number != 0) add(last, element_of(s, high), number);
}

// Both facets of a segment are on different sides. Regions that the segments connect are a patch.
void SelfRegions::assign_patches(const SelfLoops& loops) {
  sides_.clear();
  for (std::size_t i = 0; i < 2 * points.size(); ++i) sides_.add();
  for (const SelfSegment& segment : loops.segments)
    for (const std::uint32_t node : {segment.from, segment.to}) {
      const std::uint32_t a = sets_.root(on_sheet(loops, node, segment.facet_a)),
                          b = sets_.root(on_sheet(loops, node, segment.facet_b));
      sides_.join(2 * a, 2 * b + 1);
      sides_.join(2 * a + 1, 2 * b);
    }
  patch_of_.assign(points.size(), 0xffffffffu);
  side_of_.assign(points.size(), 0);
  has_no_sides_.assign(points.size(), 0);
  patch_count = 0;
  std::vector<std::uint32_t> patch_of_set(points.size(), 0xffffffffu);
  for (const FacetPart& part : side[0].parts)
    for (std::uint32_t i = part.begin; i < part.end; ++i) {
      const std::uint32_t root = sets_.root(side[0].pieces[i].from);
      if (patch_of_[root] != 0xffffffffu) continue;
      const std::uint32_t first = sides_.root(2 * root), second = sides_.root(2 * root + 1);
      std::uint32_t& patch = patch_of_set[std::min(first, second) / 2];
      if (patch == 0xffffffffu) patch = static_cast<std::uint32_t>(patch_count++);
      patch_of_[root] = patch;
      has_no_sides_[root] = first == second ? 1 : 0;
      side_of_[root] = first > second ? 1 : 0;
    }
  crossing_counts.assign(patch_count, 0);
  for (std::uint32_t node = 0; node < loops.nodes.size(); ++node)
    if (const std::uint32_t patch = patch_of_[sets_.root(2 * node)];
        patch != 0xffffffffu && !loops.nodes[node].is_vertex())
      ++crossing_counts[patch];
}

// a is the side that has been a; of patches without facets in common with earlier ones, that of the lowest facet.
void SelfRegions::choose_sides(const Earlier& earlier) {
  const SurfaceRegion& s = side[0];
  earlier_.resize(s.facet_run.size());
  for (const PatchFacet& f : earlier.a) ++earlier_[f.facet];
  for (const PatchFacet& f : earlier.b) --earlier_[f.facet];
  struct Votes {
    std::int64_t stays = 0;
    std::uint32_t lowest = 0xffffffffu;
    std::uint8_t side = 0;
  };
  std::vector<Votes> votes(patch_count);
  for (const FacetPart& part : s.parts) {
    std::uint32_t last = 0xffffffffu;
    for (std::uint32_t i = part.begin; i < part.end; ++i) {
      const std::uint32_t root = sets_.root(s.pieces[i].from);
      if (root == last) continue;
      last = root;
      Votes& v = votes[patch_of_[root]];
      v.stays += side_of_[root] == 0 ? earlier_[part.facet] : -earlier_[part.facet];
      if (part.facet < v.lowest) v.lowest = part.facet, v.side = side_of_[root];
    }
  }
  for (std::uint32_t root = 0; root < points.size(); ++root) {
    if (patch_of_[root] == 0xffffffffu) continue;
    const Votes& v = votes[patch_of_[root]];
    if (v.stays < 0 || (v.stays == 0 && v.side == 1)) side_of_[root] ^= 1;
  }
  for (const PatchFacet& f : earlier.a) earlier_[f.facet] = 0;
  for (const PatchFacet& f : earlier.b) earlier_[f.facet] = 0;
}

void SelfRegions::distribute() {
  std::vector<std::uint8_t> one_sided(patch_count, 0);
  for (std::uint32_t root = 0; root < points.size(); ++root)
    if (patch_of_[root] != 0xffffffffu && has_no_sides_[root]) one_sided[patch_of_[root]] = 1;
  for (std::uint32_t root = 0; root < points.size(); ++root)
    if (std::uint32_t& patch = patch_of_[root]; patch != 0xffffffffu)
      patch = 2 * patch + (one_sided[patch] ? 0u : side_of_[root]);
  SurfaceRegion &a = side[0], &b = side[1];
  split_parts(a, 2 * patch_count);
  std::size_t kept = 0;
  for (FacetPart part : a.parts) {
    const bool of_b = part.patch % 2 != 0;
    part.patch /= 2;
    if (!of_b) {
      a.parts[kept++] = part;
      continue;
    }
    const auto begin = static_cast<std::uint32_t>(b.pieces.size());
    b.pieces.insert(b.pieces.end(), a.pieces.begin() + part.begin, a.pieces.begin() + part.end);
    b.parts.push_back({part.patch, part.facet, begin, static_cast<std::uint32_t>(b.pieces.size())});
  }
  a.parts.resize(kept);
}

}  // namespace morula::detail
