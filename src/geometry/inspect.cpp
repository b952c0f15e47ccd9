// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/triangle.hpp>
#include <tuple>
#include <vector>

#include "geometry/inspect_sides.hpp"
#include "geometry/own_units.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruptible_sort.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

void inspect_edges(const MeshView& mesh, const Connectivity& connectivity, MeshReport& report) {
  report.closed = connectivity.edge_count() > 0;
  report.oriented = true;
  InterruptPoller poll_interrupt(1u << 16);
  for (std::uint32_t e = 0; e < connectivity.edge_count(); ++e) {
    poll_interrupt();
    const auto sides = connectivity.edge_sides(e);
    std::size_t forward = 0;
    for (const std::uint32_t side : sides) forward += side_ends(mesh.facets, side) == connectivity.edges[e];
    const std::size_t count = sides.size(), backward = count - forward;
    report.boundary_edges += count == 1;
    report.nonmanifold_edges += count > 2;
    report.misoriented_edges += count == 2 && forward != 1;
    report.closed = report.closed && count % 2 == 0;
    report.oriented = report.oriented && std::max(forward, backward) - std::min(forward, backward) == count % 2;
  }
  report.nonmanifold_vertices = nonmanifold_vertices(mesh, connectivity).size();
  report.manifold = report.nonmanifold_edges == 0 && report.nonmanifold_vertices == 0;
}

void inspect_vertices(const MeshView& mesh, MeshReport& report) {
  std::vector<bool> used(mesh.vertex_count(), false);
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f) used[v] = true;
  report.unused_vertices = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
  report.component_count = components_by_vertices(mesh).count;
  // Unused vertices may hold any values, and values that are not finite have no order.
  std::vector<Vec3> positions;
  positions.reserve(mesh.vertex_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    if (const Vec3 p = mesh.positions[v]; is_finite(p)) positions.push_back(p);
  sort_interruptibly(positions,
                     [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); });
  for (std::size_t i = 1; i < positions.size(); ++i) report.duplicate_vertices += positions[i] == positions[i - 1];
}

void inspect_facets(const OwnUnits& own, const Connectivity& connectivity, MeshReport& report) {
  const MeshView& mesh = own.mesh();
  const double diagonal = own.box().diagonal();
  const double negligible_area = 1e-12 * diagonal * diagonal;
  std::vector<Facet> triples(mesh.facets.begin(), mesh.facets.end());
  InterruptPoller poll_interrupt(1u << 16);
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    poll_interrupt();
    const bool has_sides = connectivity.facet_edges[f][0] != no_edge;
    report.degenerate_facets += !has_sides || !(area(mesh.corners(f)) >= negligible_area);
    std::sort(triples[f].begin(), triples[f].end());
  }
  sort_interruptibly(triples, std::less<>());
  for (std::size_t f = 1; f < triples.size(); ++f) report.duplicate_facets += triples[f] == triples[f - 1];
}

}  // namespace

MeshReport inspect(const MeshView& mesh) {
  return inspect(mesh, connectivity(mesh));
}

MeshReport inspect(const MeshView& mesh, const Connectivity& connectivity) {
  const StandardFloats standard;
  MeshReport report = inspect_sides(mesh, connectivity);
  report.vertex_count = mesh.vertex_count();
  report.facet_count = mesh.facet_count();
  report.box = bounding_box(mesh);
  const OwnUnits own(mesh, report.box);
  report.area = surface_area(own);
  inspect_vertices(mesh, report);
  inspect_facets(own, connectivity, report);
  return report;
}

MeshReport detail::inspect_sides(const MeshView& mesh, const Connectivity& connectivity) {
  const StandardFloats standard;
  MeshReport report;
  report.volume = signed_volume(OwnUnits(mesh, bounding_box(mesh)));
  inspect_edges(mesh, connectivity, report);
  return report;
}

}  // namespace morula
