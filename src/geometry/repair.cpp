// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/connectivity.hpp>
#include <morula/geometry/repair.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/geometry/triangle.hpp>
#include <numbers>
#include <numeric>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>

#include "geometry/index_table.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {

namespace detail {
namespace {

constexpr std::size_t most_cap_edges = 500;

bool repeats_a_vertex(const Facet& f) {
  return f[0] == f[1] || f[1] == f[2] || f[2] == f[0];
}

void turn(Facet& f) {
  std::swap(f[1], f[2]);
}

/// For every vertex, the vertex into which it is merged: itself, or an earlier one that is kept.
std::vector<std::uint32_t> merge_targets(const std::vector<Vec3>& positions, double distance,
                                         std::span<const std::uint32_t> labels) {
  std::vector<std::uint32_t> target(positions.size());
  std::iota(target.begin(), target.end(), std::uint32_t{0});
  Box box;
  for (const Vec3& p : positions)
    if (is_finite(p)) box.add(p);
  // The side of cells is no smaller than the distance, and not so small that their numbers would be rounded.
  const double cell = std::max(distance, 1e-12 * std::max(box.diagonal(), std::numeric_limits<double>::min()));
  using Cell = std::array<double, 3>;
  std::vector<Cell> cells(positions.size());
  const auto label_of = [&](std::uint32_t v) { return labels.empty() ? 0 : labels[v]; };
  // The first kept vertex of each cell and label, and for each kept vertex the next one of both: many labels at one
  // position make no long chain.
  IndexTable first_in_cell;
  constexpr std::uint32_t none = IndexTable::none;
  std::vector<std::uint32_t> next(positions.size(), none), last(positions.size(), none);  // last: last kept vertex of a
                                                                                          // cell, by its first one
  const auto hash_of = [](const Cell& c, std::uint32_t label) {
    return hash_of_numbers(c[0], c[1], c[2]) + label * std::uint64_t{0x9e3779b97f4a7c15u};
  };
  const auto first_in = [&](const Cell& at, std::uint32_t label) {
    return first_in_cell.find(hash_of(at, label),
                              [&](std::uint32_t v) { return cells[v] == at && label_of(v) == label; });
  };
  const auto cell_along = [cell](double x, double lower) {
    const double number = std::floor((x - lower) / cell);
    return std::isnan(number) ? 0 : number;  // both overflow
  };
  const auto cell_of = [&](const Vec3& p) {
    return Cell{cell_along(p.x, box.lower.x), cell_along(p.y, box.lower.y), cell_along(p.z, box.lower.z)};
  };
  InterruptPoller poll_interrupt(1024);
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    poll_interrupt();
    if (!is_finite(positions[v])) continue;
    const Cell own = cells[v] = cell_of(positions[v]);
    std::uint32_t first = v;
    for (int n = 0; n < 27; ++n) {
      const int along_x = n % 3 - 1, along_y = n / 3 % 3 - 1, along_z = n / 9 - 1;
      std::uint32_t other = first_in({own[0] + along_x, own[1] + along_y, own[2] + along_z}, label_of(v));
      for (; other < first; other = next[other]) {
        poll_interrupt();
        if (positions[other] == positions[v] || scaled_length(positions[other] - positions[v]) <= distance)
          first = other;
      }
    }
    target[v] = first;
    if (first != v) continue;
    if (const std::uint32_t head = first_in(own, label_of(v)); head == none) {
      first_in_cell.add(v, [&](std::uint32_t w) { return hash_of(cells[w], label_of(w)); });
      last[v] = v;
    } else {
      next[last[head]] = v;
      last[head] = v;
    }
  }
  return target;
}

void merge(Mesh& mesh, double distance, std::span<const std::uint32_t> labels, RepairReport& report) {
  const std::vector<std::uint32_t> target = merge_targets(mesh.positions, distance, labels);
  std::vector<Vec3> kept;
  report.old_vertex.clear();
  for (std::uint32_t v = 0; v < target.size(); ++v) {
    if (target[v] == v) {
      report.new_vertex[v] = static_cast<std::uint32_t>(kept.size());
      report.old_vertex.push_back(v);
      kept.push_back(mesh.positions[v]);
    } else {
      report.new_vertex[v] = report.new_vertex[target[v]];  // it comes earlier
      ++report.merged_vertices;
    }
  }
  mesh.positions = std::move(kept);
  std::erase_if(mesh.facets, [&](Facet& f) {
    const bool was_whole = !repeats_a_vertex(f);
    for (std::uint32_t& v : f) v = report.new_vertex[v];
    const bool collapsed = was_whole && repeats_a_vertex(f);
    report.collapsed_facets += collapsed;
    return collapsed;
  });
}

void remove_degenerate(Mesh& mesh, RepairReport& report) {
  const double diagonal = bounding_box(mesh).diagonal();
  const double negligible = 1e-12 * diagonal * diagonal;
  const std::size_t before = mesh.facet_count();
  std::erase_if(mesh.facets, [&](const Facet& f) {
    return repeats_a_vertex(f) ||
           !(area({mesh.positions[f[0]], mesh.positions[f[1]], mesh.positions[f[2]]}) >= negligible);
  });
  report.degenerate_facets += before - mesh.facet_count();
}

/// Sheets: facets connected by edges of two facets, which have one orientation.
struct Sheets {
  std::vector<std::uint32_t> of_facet;
  std::vector<std::vector<std::uint32_t>> facets;
  std::vector<char> is_closed;  // each edge has two facets
};

/// Turns facets so that those that share an edge of two agree; in every sheet the minority is turned.
Sheets orient_sheets(Mesh& mesh, RepairReport& report) {
  const Connectivity sides = connectivity(mesh);
  Sheets sheets;
  sheets.of_facet.assign(mesh.facet_count(), no_facet);
  std::vector<char> turned(mesh.facet_count(), 0);
  // mutant looks-repair: `14` -> `30`
  InterruptPoller poll_interrupt(1u << 14);
  for (std::uint32_t start = 0; start < mesh.facet_count(); ++start) {
    if (sheets.of_facet[start] != no_facet) continue;
    const auto sheet = static_cast<std::uint32_t>(sheets.facets.size());
    std::vector<std::uint32_t> queue{start};
    sheets.of_facet[start] = sheet;
    bool closed = true, orientable = true;
    std::size_t minority = 0;
    for (std::size_t done = 0; done < queue.size(); ++done) {
      poll_interrupt();
      const std::uint32_t f = queue[done];
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t other = sides.facet_across(f, k);
        closed = closed && other < several_facets;
        if (other >= several_facets) continue;
        const auto both = sides.edge_sides(sides.facet_edges[f][k]);
        const bool same_way = side_ends(mesh.facets, both[0]) == side_ends(mesh.facets, both[1]);
        const char wanted = static_cast<char>(turned[f] ^ (same_way ? 1 : 0));
        if (sheets.of_facet[other] == no_facet) {
          sheets.of_facet[other] = sheet;
          turned[other] = wanted;
          minority += static_cast<std::size_t>(wanted);
          queue.push_back(other);
        } else if (turned[other] != wanted) {
          orientable = false;
        }
      }
    }
    if (!orientable) {
      ++report.unorientable_pieces;
      closed = false;
    } else {
      const bool turn_the_others = 2 * minority > queue.size();
      for (const std::uint32_t f : queue)
        if ((turned[f] != 0) != turn_the_others) turn(mesh.facets[f]);
    }
    sheets.facets.push_back(std::move(queue));
    sheets.is_closed.push_back(closed);
  }
  return sheets;
}

/// The volume is computed about a corner of the sheet, so that no digits are lost far from the origin.
double volume_of(const Mesh& mesh, const std::vector<std::uint32_t>& facets) {
  const Vec3 origin = mesh.positions[mesh.facets[facets.front()][0]];
  double volume = 0;
  for (const std::uint32_t f : facets) {
    const Triangle t = mesh.corners(f);
    volume += dot(t[0] - origin, cross(t[1] - origin, t[2] - origin)) / 6;
  }
  return volume;
}

Box box_of(const Mesh& mesh, const std::vector<std::uint32_t>& facets) {
  Box box;
  for (const std::uint32_t f : facets)
    for (const Vec3& corner : mesh.corners(f)) box.add(corner);
  return box;
}

bool contains(const Box& box, const Vec3& p) {
  return max(p, box.upper) == box.upper && min(p, box.lower) == box.lower;
}

/// Turns closed sheets: a sheet inside no other faces outwards, and the others turn with the one that contains them.
void face_outwards(Mesh& mesh, const Sheets& sheets) {
  std::vector<Box> boxes;
  std::vector<double> volumes;
  InterruptPoller poll_interrupt(1024);
  for (std::size_t s = 0; s < sheets.facets.size(); ++s) {
    poll_interrupt();
    boxes.push_back(box_of(mesh, sheets.facets[s]));
    volumes.push_back(sheets.is_closed[s] ? volume_of(mesh, sheets.facets[s]) : 0);
  }
  std::vector<char> to_turn(sheets.facets.size(), 0);
  for (std::size_t s = 0; s < sheets.facets.size(); ++s) {
    if (volumes[s] == 0) continue;
    // The largest sheet that contains it is the outermost.
    const Vec3 probe = mesh.positions[mesh.facets[sheets.facets[s].front()][0]];
    std::size_t outermost = s;
    for (std::size_t other = 0; other < sheets.facets.size(); ++other) {
      poll_interrupt();
      if (other == s || std::abs(volumes[other]) <= std::abs(volumes[outermost]) || !contains(boxes[other], probe))
        continue;
      double angle = 0;
      for (const std::uint32_t f : sheets.facets[other]) {
        poll_interrupt();
        angle += solid_angle(mesh.corners(f), probe);
      }
      if (std::abs(angle) > 2 * std::numbers::pi) outermost = other;
    }
    to_turn[s] = volumes[outermost] < 0;
  }
  for (std::size_t s = 0; s < sheets.facets.size(); ++s)
    if (to_turn[s] != 0)
      for (const std::uint32_t f : sheets.facets[s]) turn(mesh.facets[f]);
}

using Edge = std::array<std::uint32_t, 2>;  // lower vertex first

/// Existing edges: the edges of the mesh, ascending, and the edges of caps.
struct Edges {
  std::span<const Edge> of_mesh;
  std::set<Edge> of_caps{};
  bool contain(const Edge& edge) const {
    return std::binary_search(of_mesh.begin(), of_mesh.end(), edge) || of_caps.count(edge) != 0;
  }
};

Edge edge_between(std::uint32_t a, std::uint32_t b) {
  return {std::min(a, b), std::max(a, b)};
}

/// Facets over a loop with the least area; none if every triangulation takes an existing edge.
std::vector<Facet> least_cap(const std::vector<Vec3>& positions, const std::vector<std::uint32_t>& loop,
                             const Edges& edges) {
  const std::size_t n = loop.size();
  constexpr double impossible = std::numeric_limits<double>::infinity();
  std::vector<double> least(n * n, 0);        // area over the corners i … j
  std::vector<std::size_t> middle(n * n, 0);  // the third corner of the facet at i, j
  for (std::size_t span = 2; span < n; ++span) {
    check_interrupt();
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t j = i + span;
      double& best = least[i * n + j];
      best = impossible;
      const bool is_border = i == 0 && j == n - 1;
      if (!is_border && edges.contain(edge_between(loop[i], loop[j]))) continue;
      for (std::size_t k = i + 1; k < j; ++k) {
        const double sum =
            least[i * n + k] + least[k * n + j] + area({positions[loop[i]], positions[loop[k]], positions[loop[j]]});
        if (sum >= best) continue;
        best = sum;
        middle[i * n + j] = k;
      }
    }
  }
  std::vector<Facet> facets;
  if (!(least[n - 1] < impossible)) return facets;
  std::vector<std::array<std::size_t, 2>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const std::size_t k = middle[i * n + j];
    // Facets run against the border, so that each of its edges is used in both directions.
    facets.push_back({loop[j], loop[k], loop[i]});
    open.push_back({i, k});
    open.push_back({k, j});
  }
  return facets;
}

void cap_holes(Mesh& mesh, std::size_t most_edges, RepairReport& report) {
  const Connectivity sides = connectivity(mesh);
  const BorderLoops loops = border_loops(mesh, sides);
  Edges edges{sides.edges};
  std::vector<Facet> caps;
  for (std::size_t i = 0; i < loops.count(); ++i) {
    std::vector<std::uint32_t> loop;
    for (const std::uint32_t side : loops.run(i)) loop.push_back(side_ends(mesh.facets, side)[0]);
    std::vector<Facet> cap;
    check_interrupt();
    if (loops.is_loop[i] != 0 && loop.size() >= 3 && loop.size() <= most_edges)
      cap = least_cap(mesh.positions, loop, edges);
    if (cap.empty()) {
      ++report.open_holes;
      continue;
    }
    ++report.capped_holes;
    for (const Facet& f : cap) {
      for (std::size_t k = 0; k < 3; ++k) edges.of_caps.insert(edge_between(f[k], f[(k + 1) % 3]));
      caps.push_back(f);
    }
  }
  report.cap_facets = caps.size();
  mesh.facets.insert(mesh.facets.end(), caps.begin(), caps.end());
}

bool same_way_round(const Facet& a, const Facet& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (a[0] == b[k] && a[1] == b[(k + 1) % 3] && a[2] == b[(k + 2) % 3]) return true;
  return false;
}

}  // namespace
}  // namespace detail

RepairedMesh repair(const MeshView& view, const RepairOptions& options) {
  using namespace detail;
  const StandardFloats standard;
  require_usable(view);
  if (options.merge_distance && !(*options.merge_distance >= 0 && std::isfinite(*options.merge_distance)))
    throw std::invalid_argument("repair: the merge distance is not a length of 0 or more");
  if (options.cap_edges > most_cap_edges)
    throw std::invalid_argument("repair: caps of " + std::to_string(options.cap_edges) + " edges, more than " +
                                std::to_string(most_cap_edges));
  if (!options.labels.empty() && options.labels.size() != view.vertex_count())
    throw std::invalid_argument("repair: " + std::to_string(options.labels.size()) + " labels were given for " +
                                std::to_string(view.vertex_count()) + " vertices");
  RepairedMesh result;
  Mesh& mesh = result.mesh;
  RepairReport& report = result.report;
  mesh.facets.assign(view.facets.begin(), view.facets.end());
  for (std::size_t v = 0; v < view.vertex_count(); ++v) mesh.positions.push_back(view.positions[v]);
  report.new_vertex.resize(mesh.vertex_count());
  std::iota(report.new_vertex.begin(), report.new_vertex.end(), std::uint32_t{0});
  report.old_vertex = report.new_vertex;

  if (options.merge_distance) merge(mesh, *options.merge_distance, options.labels, report);
  if (options.remove_degenerate) remove_degenerate(mesh, report);
  const std::vector<Facet> before = mesh.facets;
  if (options.orient) orient_sheets(mesh, report);
  cap_holes(mesh, options.cap_edges, report);
  if (options.orient && !mesh.facets.empty()) {
    RepairReport again;  // the facets already agree
    face_outwards(mesh, orient_sheets(mesh, again));
  }
  InterruptPoller poll_interrupt(1u << 16);
  for (std::size_t f = 0; f < before.size(); ++f) {
    poll_interrupt();
    report.turned_facets += !same_way_round(before[f], mesh.facets[f]);
  }
  return result;
}

UsedVertices used_vertices(const MeshView& mesh) {
  std::vector<std::uint32_t> place(mesh.vertex_count(), 0);
  for (const Facet& facet : mesh.facets) {
    for (const std::uint32_t v : facet) place[v] = 1;
  }
  UsedVertices used;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] == 0) continue;
    place[v] = static_cast<std::uint32_t>(used.index.size());
    used.index.push_back(static_cast<std::uint32_t>(v));
    used.mesh.positions.push_back(mesh.positions[v]);
  }
  for (const Facet& facet : mesh.facets)
    used.mesh.facets.push_back({place[facet[0]], place[facet[1]], place[facet[2]]});
  return used;
}

}  // namespace morula
