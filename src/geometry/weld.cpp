// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/geometry/weld.hpp>
#include <stdexcept>
#include <string>

#include "geometry/index_table.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

void require_weld_of(const MeshWeld& weld, std::size_t vertices) {
  if (weld.new_vertex.size() != vertices)
    throw std::invalid_argument("the weld is of a mesh of " + std::to_string(weld.new_vertex.size()) +
                                " vertices, not of " + std::to_string(vertices));
}

}  // namespace

MeshWeld weld_vertices(const MeshView& mesh, std::span<const std::uint32_t> labels) {
  const StandardFloats standard;  // equality depends on it: a host may treat denormal numbers as 0
  const std::size_t count = mesh.vertex_count();
  if (!labels.empty() && labels.size() != count)
    throw std::invalid_argument(std::to_string(labels.size()) + " labels were given for " + std::to_string(count) +
                                " vertices");
  MeshWeld weld;
  weld.new_vertex.reserve(count);
  IndexTable kept, places;  // the first vertices of a position and label; and of a position
  const auto hash_of = [&](std::uint32_t v) {
    const Vec3 p = mesh.positions[v];
    return hash_of_numbers(p.x, p.y, p.z);
  };
  // Many vertices of one position, each with a label of its own, have different hashes.
  const auto hash_with_label = [&](std::uint32_t v) {
    return hash_of(v) + (labels.empty() ? 0 : labels[v]) * std::uint64_t{0x9e3779b97f4a7c15u};
  };
  InterruptPoller poll_interrupt(1u << 14);
  for (std::uint32_t v = 0; v < count; ++v) {
    poll_interrupt();
    const Vec3 here = mesh.positions[v];
    const bool is_place = is_finite(here);
    const auto is_equal = [&](std::uint32_t w) {
      // mutant weld-labels: `labels.empty() || labels[w] == labels[v]` -> `true`
      return mesh.positions[w] == here && (labels.empty() || labels[w] == labels[v]);
    };
    const std::uint32_t first = is_place ? kept.find(hash_with_label(v), is_equal) : IndexTable::none;
    if (first != IndexTable::none) {
      weld.new_vertex.push_back(weld.new_vertex[first]);
      continue;
    }
    weld.new_vertex.push_back(static_cast<std::uint32_t>(weld.old_vertex.size()));
    weld.old_vertex.push_back(v);
    if (!is_place) continue;
    kept.add(v, hash_with_label);
    if (places.find(hash_of(v), [&](std::uint32_t w) { return mesh.positions[w] == here; }) != IndexTable::none)
      ++weld.kept_apart;
    else
      places.add(v, hash_of);
  }
  return weld;
}

Mesh welded(const MeshView& mesh, const MeshWeld& weld) {
  Mesh result{welded_positions(mesh.positions, weld), {mesh.facets.begin(), mesh.facets.end()}};
  for (Facet& facet : result.facets)
    for (std::uint32_t& v : facet) {
      if (v >= weld.new_vertex.size())
        throw std::invalid_argument("facet " + std::to_string(&facet - result.facets.data()) + " has vertex " +
                                    std::to_string(v) + " of " + std::to_string(weld.new_vertex.size()));
      v = weld.new_vertex[v];
    }
  return result;
}

std::vector<Vec3> welded_positions(const PositionView& positions, const MeshWeld& weld) {
  const StandardFloats standard;
  require_weld_of(weld, positions.size());
  std::vector<Vec3> result;
  result.reserve(weld.old_vertex.size());
  for (const std::uint32_t v : weld.old_vertex) result.push_back(positions[v]);
  return result;
}

}  // namespace morula
