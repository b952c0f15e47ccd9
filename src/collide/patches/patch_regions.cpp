// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/patch_regions.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {
constexpr std::uint32_t no_patch = 0xffffffffu;
}  // namespace

void SurfaceRegion::start(const Collider& collider, const ClosedSurface& closed, bool first) {
  body = &collider;
  surface = &closed;
  is_a = first;
  for (std::vector<std::uint32_t>* const run : {&vertex_run, &element_run}) run->resize(collider.vertex_count());
  winding.resize(collider.vertex_count());
  element.resize(collider.vertex_count());
  for (std::vector<std::uint32_t>* const by_edge : {&edge_run, &edge_begin, &edge_end})
    by_edge->resize(closed.connectivity.edge_count());
  facet_run.resize(collider.mesh_facets().size());
  is_cut.resize(collider.mesh_facets().size());
  component_run.resize(closed.components.count);
  if (++now == 0) {
    for (std::vector<std::uint32_t>* const run : {&vertex_run, &edge_run, &facet_run, &element_run, &component_run})
      std::fill(run->begin(), run->end(), 0);
    now = 1;
  }
  pieces.clear();
  parts.clear();
  wholes.clear();
}

Status PatchRegions::find(const Collider& a, const ClosedSurface& surface_a, const Collider& b,
                          const ClosedSurface& surface_b, const ContactLoops& loops, const Vec3& origin) {
  origin_ = origin;
  points.assign(loops.points.begin(), loops.points.end());
  sets_.clear();
  for (std::size_t k = 0; k < points.size(); ++k) sets_.add();
  side[0].start(a, surface_a, true);
  side[1].start(b, surface_b, false);
  for (std::uint8_t k = 0; k < 2; ++k) {
    SurfaceRegion& s = side[k];
    sort_loops(s, loops);
    if (!find_windings(s, *side[1 - k].body, loops))
      return {Status::Code::inside_out, static_cast<std::uint8_t>(1 - k)};
    add_cut_facets(s, loops);
    const std::size_t cut = s.parts.size();
    add_whole_facets(s);
    for (std::size_t i = 0; i < cut; ++i) join_holes(s, s.parts[i]);
  }
  assign_patches(loops);
  join_cavities();
  number_patches();
  for (SurfaceRegion& s : side) split_parts(s, patch_count);
  return {};
}

void PatchRegions::sort_loops(SurfaceRegion& s, const ContactLoops& loops) {
  facet_keys_.clear();
  for (std::uint32_t i = 0; i < loops.segments.size(); ++i) {
    const std::uint32_t facet = s.is_a ? loops.segments[i].facet_a : loops.segments[i].facet_b;
    s.facet_run[facet] = s.now;
    s.is_cut[facet] = 1;
    facet_keys_.push_back(std::uint64_t{facet} << 32 | i);
  }
  if (!s.is_a) std::sort(facet_keys_.begin(), facet_keys_.end());
  s.facet_segments.clear();
  for (const std::uint64_t key : facet_keys_) s.facet_segments.push_back(static_cast<std::uint32_t>(key));

  nodes_of_edges_.clear();
  for (std::uint32_t n = 0; n < loops.nodes.size(); ++n)
    if (const LoopNode& node = loops.nodes[n]; (node.side == 0) == s.is_a)
      nodes_of_edges_.push_back({node.along, node.edge, node.facet, n});
  std::sort(nodes_of_edges_.begin(), nodes_of_edges_.end(), [](const NodeOfEdge& m, const NodeOfEdge& n) {
    return std::tie(m.edge, m.along, m.facet) < std::tie(n.edge, n.along, n.facet);
  });
  s.edge_nodes.clear();
  for (const NodeOfEdge& node : nodes_of_edges_) {
    const auto i = static_cast<std::uint32_t>(s.edge_nodes.size());
    s.edge_nodes.push_back(node.node);
    if (s.edge_run[node.edge] != s.now) s.edge_begin[node.edge] = i;
    s.edge_run[node.edge] = s.now;
    s.edge_end[node.edge] = i + 1;
  }
}

// One vertex of each connected set of cut facets is located; edges of cut facets, and facets wholly inside, lead from
// one vertex to the next. The surface outside the overlap is not visited. A component that no loop crosses is wholly
// inside or outside.
bool PatchRegions::find_windings(SurfaceRegion& s, const Collider& other, const ContactLoops& loops) {
  const auto locate_from = [&](std::uint32_t vertex) {
    check_interrupt();
    return spread(s, loops, vertex, location_.around(other, s.body->vertex(vertex), s.is_a));
  };
  for (const std::uint32_t segment : s.facet_segments) {
    const std::uint32_t facet = s.is_a ? loops.segments[segment].facet_a : loops.segments[segment].facet_b;
    s.component_run[s.surface->components.of_facet[facet]] = s.now;
    const std::uint32_t vertex = s.body->mesh_facets()[facet][0];
    if (s.vertex_run[vertex] != s.now && !locate_from(vertex)) return false;
  }
  for (std::uint32_t c = 0; c < s.component_run.size(); ++c)
    if (s.component_run[c] != s.now && !locate_from(s.surface->component_vertex[c])) return false;
  return true;
}

// The jumps of an edge are exact and consistent, so a vertex has the same winding number from wherever it is reached.
bool PatchRegions::spread(SurfaceRegion& s, const ContactLoops& loops, std::uint32_t vertex, int winding) {
  s.queue.clear();
  const auto reach = [&](std::uint32_t v, int w) {
    if (s.vertex_run[v] == s.now) return;
    s.vertex_run[v] = s.now;
    s.winding[v] = w;
    s.queue.push_back(v);
  };
  reach(vertex, winding);
  const Connectivity& connectivity = s.surface->connectivity;
  for (std::size_t next = 0; next < s.queue.size(); ++next) {
    const std::uint32_t v = s.queue[next];
    const int w = s.winding[v];
    if (w < 0) return false;
    for (const std::uint32_t facet : connectivity.vertex_facets(v)) {
      const Facet& corners = s.body->mesh_facets()[facet];
      if (s.facet_run[facet] != s.now) {
        if (w == 0) continue;
        s.facet_run[facet] = s.now;
        s.is_cut[facet] = 0;
        s.wholes.push_back({facet, w});
        for (const std::uint32_t corner : corners) reach(corner, w);
      } else if (s.is_cut[facet]) {
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t from = corners[k], to = corners[(k + 1) % 3];
          if (from != v && to != v) continue;
          const std::uint32_t edge = connectivity.facet_edges[facet][k];
          int jump = 0;
          for (const std::uint32_t node : s.nodes_of(edge)) jump += loops.nodes[node].jump;
          reach(from == v ? to : from, v == connectivity.edges[edge][0] ? w + jump : w - jump);
        }
      }
    }
  }
  return true;
}

std::uint32_t PatchRegions::element_of(SurfaceRegion& s, std::uint32_t vertex) {
  if (s.element_run[vertex] != s.now) {
    s.element_run[vertex] = s.now;
    s.element[vertex] = sets_.add();
    points.push_back(s.body->vertex(vertex) - origin_);
  }
  return s.element[vertex];
}

void PatchRegions::add_piece(SurfaceRegion& s, const BoundaryPiece& piece) {
  s.pieces.push_back(piece);
  sets_.join(piece.from, piece.to);
}

void PatchRegions::add_cut_facets(SurfaceRegion& s, const ContactLoops& loops) {
  for (std::size_t i = 0; i < s.facet_segments.size();) {
    const LoopSegment& first = loops.segments[s.facet_segments[i]];
    const std::uint32_t facet = s.is_a ? first.facet_a : first.facet_b;
    const auto begin = static_cast<std::uint32_t>(s.pieces.size());
    for (; i < s.facet_segments.size(); ++i) {
      const LoopSegment& segment = loops.segments[s.facet_segments[i]];
      if ((s.is_a ? segment.facet_a : segment.facet_b) != facet) break;
      if (s.is_a)
        add_piece(s, {segment.from, segment.to, 1, true});
      else
        add_piece(s, {segment.to, segment.from, 1, true});
    }
    for (std::size_t k = 0; k < 3; ++k) add_edge(s, loops, facet, k);
    s.parts.push_back({no_patch, facet, begin, static_cast<std::uint32_t>(s.pieces.size())});
  }
}

void PatchRegions::add_edge(SurfaceRegion& s, const ContactLoops& loops, std::uint32_t facet, std::size_t k) {
  const std::uint32_t edge = s.surface->connectivity.facet_edges[facet][k];
  const auto& [low, high] = s.surface->connectivity.edges[edge];
  const bool forward = s.body->mesh_facets()[facet][k] == low;
  const auto add = [&](std::uint32_t from, std::uint32_t to, int weight) {
    add_piece(s, forward ? BoundaryPiece{from, to, weight, false} : BoundaryPiece{to, from, weight, false});
  };
  int weight = s.winding[low];
  std::uint32_t last = weight != 0 ? element_of(s, low) : 0;
  for (const std::uint32_t node : s.nodes_of(edge)) {
    if (weight != 0) add(last, node, weight);
    weight += loops.nodes[node].jump;
    last = node;
  }
  if (weight != 0) add(last, element_of(s, high), weight);
}

void PatchRegions::add_whole_facets(SurfaceRegion& s) {
  for (const SurfaceRegion::Whole& whole : s.wholes) {
    const Facet& f = s.body->mesh_facets()[whole.facet];
    const std::uint32_t e[3] = {element_of(s, f[0]), element_of(s, f[1]), element_of(s, f[2])};
    const auto begin = static_cast<std::uint32_t>(s.pieces.size());
    for (std::size_t k = 0; k < 3; ++k) s.pieces.push_back({e[k], e[(k + 1) % 3], whole.winding, false});
    sets_.join(e[0], e[1]);
    sets_.join(e[0], e[2]);
    s.parts.push_back({no_patch, whole.facet, begin, begin + 3});
  }
}

// Polygons of one set already need no search.
void PatchRegions::join_holes(const SurfaceRegion& s, const FacetPart& part) {
  const auto pieces = std::span(s.pieces).subspan(part.begin, part.end - part.begin);
  const std::uint32_t root = sets_.root(pieces[0].from);
  if (std::all_of(pieces.begin(), pieces.end(),
                  [&](const BoundaryPiece& piece) { return sets_.root(piece.from) == root; }))
    return;
  for (const auto& [hole, around] : holes_.find(pieces, points, area_vector(s.body->triangle(part.facet))))
    sets_.join(hole, around);
}

void PatchRegions::assign_patches(const ContactLoops& loops) {
  patch_of_.assign(points.size(), no_patch);
  patch_count = 0;
  for (SurfaceRegion& s : side)
    for (FacetPart& part : s.parts)
      for (std::uint32_t i = part.begin; i < part.end; ++i)
        if (std::uint32_t& patch = patch_at(s.pieces[i]); patch == no_patch)
          patch = static_cast<std::uint32_t>(patch_count++);
  crossing_counts.assign(patch_count, 0);
  for (std::uint32_t node = 0; node < loops.nodes.size(); ++node)
    if (const std::uint32_t patch = patch_of_[sets_.root(node)]; patch != no_patch) ++crossing_counts[patch];
}

// By the lowest facet of a, then of b.
void PatchRegions::number_patches() {
  if (patch_count <= 1) return;
  lowest_.clear();
  for (std::uint32_t patch = 0; patch < patch_count; ++patch) lowest_.push_back({{no_patch, no_patch}, patch});
  for (std::size_t k = 0; k < 2; ++k)
    for (const FacetPart& part : side[k].parts)
      for (std::uint32_t i = part.begin; i < part.end; ++i) {
        std::uint32_t& facet = lowest_[patch_at(side[k].pieces[i])].facet[k];
        facet = std::min(facet, part.facet);
      }
  std::erase_if(lowest_, [](const Lowest& l) { return l.facet[0] == no_patch && l.facet[1] == no_patch; });
  std::sort(lowest_.begin(), lowest_.end(), [](const Lowest& p, const Lowest& q) {
    return std::tie(p.facet[0], p.facet[1], p.patch) < std::tie(q.facet[0], q.facet[1], q.patch);
  });
  number_.assign(patch_count, no_patch);
  counts_.resize(lowest_.size());
  for (std::uint32_t i = 0; i < lowest_.size(); ++i) {
    number_[lowest_[i].patch] = i;
    counts_[i] = crossing_counts[lowest_[i].patch];
  }
  for (std::uint32_t& patch : patch_of_)
    if (patch != no_patch) patch = number_[patch];
  crossing_counts.swap(counts_);
  patch_count = lowest_.size();
}

void PatchRegions::split_parts(SurfaceRegion& s, std::size_t groups) {
  const std::size_t count = groups > 1 ? s.parts.size() : 0;
  if (count == 0)
    for (FacetPart& part : s.parts) part.patch = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const FacetPart part = s.parts[k];
    const auto pieces = std::span(s.pieces).subspan(part.begin, part.end - part.begin);
    const std::uint32_t patch = patch_at(pieces[0]);
    s.parts[k].patch = patch;
    if (std::all_of(pieces.begin(), pieces.end(), [&](const BoundaryPiece& p) { return patch_at(p) == patch; }))
      continue;
    order_.clear();
    for (std::uint32_t i = 0; i < pieces.size(); ++i) order_.emplace_back(patch_at(pieces[i]), i);
    std::sort(order_.begin(), order_.end());
    sorted_.clear();
    for (const auto& [of, i] : order_) sorted_.push_back(pieces[i]);
    std::copy(sorted_.begin(), sorted_.end(), pieces.begin());
    std::uint32_t first = 0;
    for (std::uint32_t i = 1; i <= order_.size(); ++i) {
      if (i < order_.size() && order_[i].first == order_[first].first) continue;
      const FacetPart split{order_[first].first, part.facet, part.begin + first, part.begin + i};
      if (first == 0)
        s.parts[k] = split;
      else
        s.parts.push_back(split);
      first = i;
    }
  }
  const auto key = [](const FacetPart& part) { return std::uint64_t{part.patch} << 32 | part.facet; };
  std::sort(s.parts.begin(), s.parts.end(), [&](const FacetPart& p, const FacetPart& q) { return key(p) < key(q); });
}

}  // namespace morula::detail
