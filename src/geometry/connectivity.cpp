// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/geometry/connectivity.hpp>

#include "geometry/disjoint_sets.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

bool repeats_an_index(const Facet& f) {
  return f[0] == f[1] || f[1] == f[2] || f[2] == f[0];
}

std::uint32_t next_side(std::uint32_t side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}

// Computes where the lists of a counting sort begin: counts[v + 1] is the length of list v.
void add_up(std::vector<std::uint32_t>& counts) {
  for (std::size_t v = 1; v < counts.size(); ++v) counts[v] += counts[v - 1];
}

void take_fans(const MeshView& mesh, Connectivity& c) {
  c.fan_begin.assign(mesh.vertex_count() + 1, 0);
  InterruptPoller poll_interrupt(1u << 16);
  for (const Facet& f : mesh.facets) {
    poll_interrupt();
    if (!repeats_an_index(f))
      for (const std::uint32_t v : f) ++c.fan_begin[v + 1];
  }
  add_up(c.fan_begin);
  c.fan_facets.resize(c.fan_begin.back());
  std::vector<std::uint32_t> next(c.fan_begin.begin(), c.fan_begin.end() - 1);
  for (std::uint32_t f = 0; f < mesh.facet_count(); ++f) {
    poll_interrupt();
    if (!repeats_an_index(mesh.facets[f]))
      for (const std::uint32_t v : mesh.facets[f]) c.fan_facets[next[v]++] = f;
  }
}

// Sides are assigned to the lower of their vertices, then sorted by the higher one.
void take_edges(const MeshView& mesh, Connectivity& c) {
  c.facet_edges.assign(mesh.facet_count(), {no_edge, no_edge, no_edge});
  std::vector<std::uint32_t> begin(mesh.vertex_count() + 1, 0);
  InterruptPoller poll_interrupt(1u << 16);
  const auto each_side = [&](const auto& visit) {
    for (std::uint32_t f = 0; f < mesh.facet_count(); ++f) {
      poll_interrupt();
      const Facet& facet = mesh.facets[f];
      if (repeats_an_index(facet)) continue;
      for (std::uint32_t k = 0; k < 3; ++k)
        visit(3 * f + k, std::min(facet[k], facet[(k + 1) % 3]), std::max(facet[k], facet[(k + 1) % 3]));
    }
  };
  each_side([&](std::uint32_t, std::uint32_t lower, std::uint32_t) { ++begin[lower + 1]; });
  add_up(begin);
  std::vector<std::uint64_t> sorted(begin.back());  // the higher vertex, then the side
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  each_side([&](std::uint32_t side, std::uint32_t lower, std::uint32_t higher) {
    sorted[next[lower]++] = std::uint64_t{higher} << 32 | side;
  });

  c.sides.reserve(sorted.size());
  for (std::uint32_t lower = 0; lower < mesh.vertex_count(); ++lower) {
    poll_interrupt();
    const auto first = sorted.begin() + begin[lower], last = sorted.begin() + begin[lower + 1];
    std::sort(first, last);
    for (auto at = first; at != last; ++at) {
      const auto higher = static_cast<std::uint32_t>(*at >> 32), side = static_cast<std::uint32_t>(*at);
      if (at == first || higher != c.edges.back()[1]) {
        c.edges.push_back({lower, higher});
        c.side_begin.push_back(static_cast<std::uint32_t>(c.sides.size()));
      }
      c.facet_edges[side / 3][side % 3] = static_cast<std::uint32_t>(c.edges.size() - 1);
      c.sides.push_back(side);
    }
  }
  c.side_begin.push_back(static_cast<std::uint32_t>(c.sides.size()));
}

// Numbers the components of facets, facet f being in set sets[f], in the order of their lowest facets.
Components numbered(std::size_t facet_count, DisjointSets& sets) {
  Components components;
  components.of_facet.resize(facet_count);
  InterruptPoller poll_interrupt(1u << 16);
  for (std::uint32_t f = 0; f < facet_count; ++f) {
    poll_interrupt();
    components.of_facet[f] = sets.root(f) == f ? components.count++ : components.of_facet[sets.root(f)];
  }
  return components;
}

template <class Wanted>
std::vector<std::uint32_t> edges_with(const Connectivity& connectivity, const Wanted& wanted) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t e = 0; e < connectivity.edge_count(); ++e)
    if (wanted(connectivity.side_begin[e + 1] - connectivity.side_begin[e])) found.push_back(e);
  return found;
}

}  // namespace

std::uint32_t Connectivity::facet_across(std::uint32_t facet, std::uint32_t k) const {
  const std::uint32_t edge = facet_edges[facet][k];
  if (edge == no_edge) return no_facet;
  const auto all = edge_sides(edge);
  if (all.size() > 2) return several_facets;
  return all.size() == 1 ? no_facet : (all[0] / 3 == facet ? all[1] : all[0]) / 3;
}

Connectivity connectivity(const MeshView& mesh) {
  Connectivity c;
  take_edges(mesh, c);
  take_fans(mesh, c);
  return c;
}

Components components_by_vertices(const MeshView& mesh) {
  DisjointSets sets(mesh.facet_count());
  std::vector<std::uint32_t> first(mesh.vertex_count(), no_facet);  // a facet of each vertex
  InterruptPoller poll_interrupt(1u << 16);
  for (std::uint32_t f = 0; f < mesh.facet_count(); ++f) {
    poll_interrupt();
    for (const std::uint32_t v : mesh.facets[f]) {
      if (first[v] == no_facet) first[v] = f;
      sets.join(first[v], f);
    }
  }
  return numbered(mesh.facet_count(), sets);
}

Components components_by_edges(const MeshView& mesh, const Connectivity& connectivity) {
  DisjointSets sets(mesh.facet_count());
  InterruptPoller poll_interrupt(1u << 16);
  for (std::uint32_t e = 0; e < connectivity.edge_count(); ++e) {
    poll_interrupt();
    for (const std::uint32_t side : connectivity.edge_sides(e)) sets.join(connectivity.edge_sides(e)[0] / 3, side / 3);
  }
  return numbered(mesh.facet_count(), sets);
}

std::vector<std::uint32_t> border_edges(const Connectivity& connectivity) {
  return edges_with(connectivity, [](std::uint32_t sides) { return sides == 1; });
}

std::vector<std::uint32_t> nonmanifold_edges(const Connectivity& connectivity) {
  return edges_with(connectivity, [](std::uint32_t sides) { return sides > 2; });
}

std::vector<std::uint32_t> nonmanifold_vertices(const MeshView& mesh, const Connectivity& connectivity) {
  // Corners at a vertex belong to one fan when their facets share an edge there. Corner 3 f + k is where side 3 f + k
  // starts.
  DisjointSets fans(3 * mesh.facet_count());
  InterruptPoller poll_interrupt(1u << 16);
  for (std::uint32_t e = 0; e < connectivity.edge_count(); ++e) {
    poll_interrupt();
    const auto sides = connectivity.edge_sides(e);
    const std::uint32_t a = sides[0];
    for (const std::uint32_t b : sides.subspan(1)) {
      const bool same_way = side_ends(mesh.facets, a) == side_ends(mesh.facets, b);
      fans.join(a, same_way ? b : next_side(b));
      fans.join(next_side(a), same_way ? next_side(b) : b);
    }
  }
  std::vector<std::uint32_t> found;
  std::vector<std::uint32_t> count(mesh.vertex_count(), 0);
  for (const std::uint32_t side : connectivity.sides) {
    poll_interrupt();
    if (fans.root(side) == side) ++count[side_ends(mesh.facets, side)[0]];
  }
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
    if (count[v] > 1) found.push_back(v);
  return found;
}

BorderLoops border_loops(const MeshView& mesh, const Connectivity& connectivity) {
  // Border sides by the vertex where they start, ascending.
  std::vector<std::uint32_t> border;
  for (const std::uint32_t e : border_edges(connectivity)) border.push_back(connectivity.edge_sides(e)[0]);
  std::sort(border.begin(), border.end());
  std::vector<std::uint32_t> begin(mesh.vertex_count() + 1, 0), arriving(mesh.vertex_count(), 0);
  for (const std::uint32_t side : border) {
    const auto [from, to] = side_ends(mesh.facets, side);
    ++begin[from + 1], ++arriving[to];
  }
  add_up(begin);
  std::vector<std::uint32_t> leaving(border.size()), next(begin.begin(), begin.end() - 1);
  for (const std::uint32_t side : border) leaving[next[side_ends(mesh.facets, side)[0]]++] = side;
  std::copy(begin.begin(), begin.end() - 1, next.begin());

  BorderLoops loops;
  loops.begin.push_back(0);
  constexpr std::uint32_t off_path = 0xffffffffu;
  std::vector<std::uint32_t> place(mesh.vertex_count(), off_path);  // by vertex: number of sides ahead of it on the
                                                                    // path
  std::vector<std::uint32_t> path;
  const auto close_run = [&](std::size_t first, bool is_loop) {
    for (std::size_t i = first; i < path.size(); ++i) place[side_ends(mesh.facets, path[i])[0]] = off_path;
    loops.sides.insert(loops.sides.end(), path.begin() + static_cast<std::ptrdiff_t>(first), path.end());
    loops.begin.push_back(static_cast<std::uint32_t>(loops.sides.size()));
    loops.is_loop.push_back(is_loop ? 1 : 0);
    path.resize(first);
  };
  InterruptPoller poll_interrupt(1u << 16);
  // Walks to the end of the path. When the path returns to itself, a loop is cut off.
  const auto walk = [&](std::uint32_t vertex) {
    while (next[vertex] < begin[vertex + 1]) {
      poll_interrupt();
      place[vertex] = static_cast<std::uint32_t>(path.size());
      path.push_back(leaving[next[vertex]++]);
      vertex = side_ends(mesh.facets, path.back())[1];
      if (place[vertex] != off_path) close_run(place[vertex], true);
    }
    if (!path.empty()) close_run(0, false);
  };
  // An open run begins at a vertex that more sides leave than enter. After all open runs only loops remain.
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
    for (std::uint32_t more = begin[v + 1] - begin[v]; more > arriving[v]; --more) walk(v);
  for (const std::uint32_t side : border) walk(side_ends(mesh.facets, side)[0]);
  return loops;
}

}  // namespace morula
