// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <morula/accuracy/looseness.hpp>
#include <morula/geometry/inspect.hpp>
#include <stdexcept>
#include <string>

#include "accuracy/border_caps.hpp"
#include "accuracy/usable_spheres.hpp"
#include "accuracy/voxel_columns.hpp"
#include "accuracy/voxel_lattice.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

Box box_of(std::span<const Sphere> spheres) {
  Box box;
  for (const Sphere& s : spheres) {
    box.add(s.center - Vec3{s.radius, s.radius, s.radius});
    box.add(s.center + Vec3{s.radius, s.radius, s.radius});
  }
  return box;
}

Box box_of(const MeshView& mesh) {
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f)
      if (!is_finite(mesh.positions[v]))
        throw std::invalid_argument("looseness: vertex " + std::to_string(v) + " has a coordinate that is not finite");
  return bounding_box(mesh);
}

// What is counted: the mesh of a frame, checked, and the lattice over it.
struct Counted {
  MeshView mesh;
  VoxelLattice lattice{};

  Counted(const PositionView& positions, std::span<const Facet> facets, std::size_t vertex_count,
          std::span<const Sphere> spheres, const VoxelGrid& grid)
      : mesh(positions, facets) {
    if (positions.size() != vertex_count)
      throw std::invalid_argument("looseness: " + std::to_string(positions.size()) + " positions for a mesh of " +
                                  std::to_string(vertex_count) + " vertices");
    require_some_usable(spheres, "looseness");
    const Box object = box_of(mesh);
    require_usable_scale(mesh);
    lattice = voxel_lattice(grid, box_of(spheres), object);
  }

  double volume_of(std::size_t voxels) const {
    return static_cast<double>(voxels) * (lattice.edge * lattice.edge * lattice.edge);
  }
  Looseness result(std::size_t in_union) const {
    Looseness result;
    result.voxel_edge = lattice.edge;
    result.voxels = static_cast<std::size_t>(lattice.count[0]) * static_cast<std::size_t>(lattice.count[1]) *
                    static_cast<std::size_t>(lattice.count[2]);
    result.union_volume = volume_of(in_union);
    return result;
  }
};

}  // namespace

Looseness looseness(const MeshView& mesh, std::span<const Sphere> spheres, const VoxelGrid& grid, WorkersOrAll given) {
  Workers& workers = given;
  const StandardFloats standard;
  return LoosenessMeter(mesh).measure(mesh.positions, spheres, grid, workers);
}

LoosenessMeter::LoosenessMeter(const MeshView& mesh)
    : facets_(mesh.facets.begin(), mesh.facets.end()), vertex_count_(mesh.vertex_count()) {
  const StandardFloats standard;
  const MeshReport report = inspect(mesh);
  closed_ = report.closed;
  oriented_ = report.oriented;
}

Looseness LoosenessMeter::measure(const PositionView& positions, std::span<const Sphere> spheres, const VoxelGrid& grid,
                                  Workers& workers) const {
  const StandardFloats standard;
  const Counted counted(positions, facets_, vertex_count_, spheres, grid);
  const Inside inside = !closed_ ? Inside::unknown : oriented_ ? Inside::nonzero_winding : Inside::odd_crossings;
  const VoxelCounts counts = count_voxels(counted.lattice, counted.mesh, inside, spheres, workers);

  Looseness result = counted.result(counts.in_union);
  if (!closed_) return result;
  result.object_volume = oriented_ ? std::abs(signed_volume(counted.mesh)) : counted.volume_of(counts.inside);
  result.outside_volume = counted.volume_of(counts.in_union - counts.in_both);
  if (result.object_volume > 0) {
    result.looseness = result.outside_volume / result.object_volume;
    result.missed_volume = counted.volume_of(counts.inside - counts.in_both) / result.object_volume;
  }
  return result;
}

Looseness LoosenessMeter::measure_open(const PositionView& positions, std::span<const Sphere> spheres,
                                       const VoxelGrid& grid, Workers& workers) const {
  if (closed_ || !oriented_) return measure(positions, spheres, grid, workers);
  const StandardFloats standard;
  const Counted counted(positions, facets_, vertex_count_, spheres, grid);
  std::vector<Vec3> closed_positions;
  std::vector<Facet> closed_facets;
  BorderCaps(counted.mesh).close(counted.mesh, closed_positions, closed_facets);
  const MeshView closed(closed_positions, closed_facets);
  const double sign = signed_volume(closed) < 0 ? -1 : 1;
  const OpenVoxelCounts counts = count_open_voxels(counted.lattice, closed, facets_.size(), sign, spheres, workers);

  Looseness result = counted.result(counts.in_union);
  constexpr std::size_t quarter = 0, half = 1, three_quarters = 2;
  if (counts.inside[three_quarters] == 0) return result;
  // The volume of the closed surface is known exactly: voxels only say by how much that of the open one differs. A body
  // that is aligned with the lattice would gain or lose a layer of voxels.
  const double beyond_voxels =
      sign * (signed_volume(closed) - static_cast<double>(counts.closed_turns) * counted.volume_of(1));
  const auto object_at = [&](std::size_t threshold) {
    return counted.volume_of(counts.inside[threshold]) + beyond_voxels;
  };
  if (!(object_at(three_quarters) > 0)) return result;
  const auto looseness_at = [&](std::size_t threshold) {
    return counted.volume_of(counts.in_union - counts.in_both[threshold]) / object_at(threshold);
  };
  result.object_volume = object_at(half);
  result.outside_volume = counted.volume_of(counts.in_union - counts.in_both[half]);
  result.looseness = looseness_at(half);
  result.missed_volume = counted.volume_of(counts.inside[half] - counts.in_both[half]) / object_at(half);
  result.range = Looseness::Range{looseness_at(quarter), looseness_at(three_quarters)};
  return result;
}

}  // namespace morula
