// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/triangle.hpp>
#include <numeric>
#include <tuple>
#include <vector>

#include "geometry/own_units.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
namespace {

// Disjoint sets with path halving; the smaller index is the root, so nothing depends on the order of joins.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }
  std::uint32_t root(std::uint32_t i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    if (a < b) parents_[b] = a;
    if (b < a) parents_[a] = b;
  }

 private:
  std::vector<std::uint32_t> parents_;
};

bool repeats_an_index(const Facet& f) {
  return f[0] == f[1] || f[1] == f[2] || f[2] == f[0];
}

// One side of one facet, from its corner number `corner` (3 × facet + 0…2) to the next.
struct Side {
  std::uint64_t edge;  // lower vertex in the upper half, higher vertex in the lower half
  std::uint32_t corner;
  bool forward;  // from the lower to the higher vertex

  bool operator<(const Side& other) const { return std::tie(edge, corner) < std::tie(other.edge, other.corner); }
};

std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

std::vector<Side> sorted_sides(const std::vector<Facet>& facets) {
  std::vector<Side> sides;
  sides.reserve(3 * facets.size());
  for (std::uint32_t f = 0; f < facets.size(); ++f) {
    if (repeats_an_index(facets[f])) continue;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint64_t from = facets[f][k], to = facets[f][(k + 1) % 3];
      sides.push_back({std::min(from, to) << 32 | std::max(from, to), 3 * f + k, from < to});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

// Edges, and fans: corners at a vertex belong to one fan when their facets share an edge there.
void inspect_edges(const Mesh& mesh, MeshReport& report) {
  const std::vector<Side> sides = sorted_sides(mesh.facets);
  DisjointSets fans(3 * mesh.facet_count());
  report.closed = report.oriented = true;
  for (std::size_t first = 0, end; first < sides.size(); first = end) {
    std::size_t forward = 0;
    for (end = first; end < sides.size() && sides[end].edge == sides[first].edge; ++end) {
      forward += sides[end].forward;
      const std::uint32_t a = sides[first].corner, b = sides[end].corner;
      const bool same_way = sides[first].forward == sides[end].forward;
      fans.join(a, same_way ? b : next_corner(b));
      fans.join(next_corner(a), same_way ? next_corner(b) : b);
    }
    const std::size_t count = end - first, backward = count - forward;
    report.boundary_edges += count == 1;
    report.nonmanifold_edges += count > 2;
    report.misoriented_edges += count == 2 && forward != 1;
    report.closed = report.closed && count % 2 == 0;
    report.oriented = report.oriented && std::max(forward, backward) - std::min(forward, backward) == count % 2;
  }
  std::vector<std::uint32_t> fan_counts(mesh.vertex_count(), 0);
  for (std::uint32_t corner = 0; corner < 3 * mesh.facet_count(); ++corner) {
    const Facet& f = mesh.facets[corner / 3];
    if (fans.root(corner) == corner && !repeats_an_index(f)) ++fan_counts[f[corner % 3]];
  }
  for (const std::uint32_t fans_here : fan_counts) report.nonmanifold_vertices += fans_here > 1;
  report.manifold = report.nonmanifold_edges == 0 && report.nonmanifold_vertices == 0;
}

void inspect_vertices(const Mesh& mesh, MeshReport& report) {
  DisjointSets components(mesh.vertex_count());
  std::vector<bool> used(mesh.vertex_count(), false);
  for (const Facet& f : mesh.facets) {
    for (const std::uint32_t v : f) used[v] = true;
    components.join(f[0], f[1]);
    components.join(f[0], f[2]);
  }
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    report.unused_vertices += !used[v];
    report.component_count += used[v] && components.root(v) == v;
  }
  // Unused vertices may hold anything; what is not finite has no order.
  std::vector<Vec3> positions;
  positions.reserve(mesh.vertex_count());
  for (const Vec3& p : mesh.positions)
    if (is_finite(p)) positions.push_back(p);
  std::sort(positions.begin(), positions.end(),
            [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
  for (std::size_t i = 1; i < positions.size(); ++i) report.duplicate_vertices += positions[i] == positions[i - 1];
}

void inspect_facets(const Mesh& mesh, MeshReport& report) {
  const double diagonal = bounding_box(mesh).diagonal();
  const double negligible_area = 1e-12 * diagonal * diagonal;
  std::vector<Facet> triples = mesh.facets;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    report.degenerate_facets += repeats_an_index(mesh.facets[f]) || !(area(mesh.corners(f)) >= negligible_area);
    std::sort(triples[f].begin(), triples[f].end());
  }
  std::sort(triples.begin(), triples.end());
  for (std::size_t f = 1; f < triples.size(); ++f) report.duplicate_facets += triples[f] == triples[f - 1];
}

}  // namespace

MeshReport inspect(const Mesh& mesh) {
  const StandardFloats standard;
  MeshReport report;
  report.vertex_count = mesh.vertex_count();
  report.facet_count = mesh.facet_count();
  report.box = bounding_box(mesh);
  report.area = surface_area(mesh);
  report.volume = signed_volume(mesh);
  inspect_vertices(mesh, report);
  inspect_edges(mesh, report);
  const std::optional<OwnUnits> own = in_own_units(mesh);
  inspect_facets(own ? own->mesh : mesh, report);
  return report;
}

}  // namespace morula
