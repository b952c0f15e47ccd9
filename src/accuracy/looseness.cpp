// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <morula/accuracy/looseness.hpp>
#include <morula/geometry/connectivity.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/mesh_view.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "accuracy/usable_spheres.hpp"
#include "accuracy/voxel_columns.hpp"
#include "geometry/disjoint_sets.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

/// Caps that close an open surface: facets from its border to a point in the middle of each component of the border.
///
/// The caps depend on the facets alone, so that no deformation changes them. The winding number of the open surface is
/// that of the closed one, a whole number, less that of the caps, wherever these lie [jacobson2013].
class BorderCaps {
 public:
  explicit BorderCaps(const MeshView& mesh);

  /// The closed surface: the mesh's vertices and facets, then the middles and the caps.
  void close(const MeshView& mesh, std::vector<Vec3>& positions, std::vector<Facet>& facets) const;

 private:
  struct Side {
    std::uint32_t from, to;  // direction of the cap, against the facet
    std::uint32_t component;
  };
  std::vector<Side> sides_;
  std::uint32_t component_count_ = 0;
};

BorderCaps::BorderCaps(const MeshView& mesh) {
  const Connectivity all = connectivity(mesh);
  DisjointSets sets(mesh.vertex_count());
  for (std::uint32_t e = 0; e < all.edge_count(); ++e) {
    // Facets on both sides of an edge cancel; the rest of the edges is border.
    const auto [a, b] = all.edges[e];
    int forward = 0;
    for (const std::uint32_t side : all.edge_sides(e)) forward += side_ends(mesh.facets, side)[0] == a ? 1 : -1;
    if (forward != 0) sets.join(a, b);
    for (int n = 0; n < std::abs(forward); ++n) sides_.push_back(forward > 0 ? Side{b, a, 0} : Side{a, b, 0});
  }
  std::map<std::uint32_t, std::uint32_t> components;
  for (Side& side : sides_) {
    const auto [found, is_new] = components.try_emplace(sets.root(side.from), component_count_);
    component_count_ += is_new;
    side.component = found->second;
  }
}

void BorderCaps::close(const MeshView& mesh, std::vector<Vec3>& positions, std::vector<Facet>& facets) const {
  const auto first_middle = static_cast<std::uint32_t>(mesh.vertex_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) positions.push_back(mesh.positions[v]);
  std::vector<Vec3> sums(component_count_);
  std::vector<double> counts(component_count_, 0);
  for (const Side& side : sides_) {
    sums[side.component] += mesh.positions[side.from];
    counts[side.component] += 1;
  }
  for (std::size_t component = 0; component < sums.size(); ++component)
    positions.push_back(sums[component] / counts[component]);
  facets.assign(mesh.facets.begin(), mesh.facets.end());
  for (const Side& side : sides_) facets.push_back({side.from, side.to, first_middle + side.component});
}

// A box side that is a whole number of edges except for rounding must not get a layer of its own.
constexpr double rounding_of_a_side = 1e-9;

double longest_side(const Box& box) {
  return max_norm(box.extent());
}

double edge_of(const VoxelGrid& grid, const Box& spheres, const Box& both) {
  if (grid.kind == VoxelGrid::Kind::fixed) {
    if (!(grid.voxel_edge > 0) || !std::isfinite(grid.voxel_edge))
      throw std::invalid_argument("voxel grid: the edge of a fixed grid must be positive and finite, not " +
                                  std::to_string(grid.voxel_edge));
    return grid.voxel_edge;
  }
  if (grid.resolution < 8 || grid.resolution > 4096)
    throw std::invalid_argument("voxel grid: resolution must be 8 to 4096, not " + std::to_string(grid.resolution));
  const double edge =
      std::max(longest_side(spheres) / grid.resolution, longest_side(both) / (most_voxels_along_a_side - 2));
  return edge > 0 ? edge : 1.0;  // all points coincide
}

/// The part of the lattice that contains both boxes, so that all of the object and of the spheres is counted. Edge and
/// phase come from the grid alone (of `level`: from the spheres' box alone), unless that needs too many voxels along a
/// side: then `level` takes a longer edge and `fixed` throws std::invalid_argument, as it does for a bad grid.
VoxelLattice voxel_lattice(const VoxelGrid& grid, const Box& spheres, const Box& mesh) {
  Box both = spheres;
  both.add(mesh);
  VoxelLattice lattice{};
  lattice.edge = edge_of(grid, spheres, both);
  if (grid.kind == VoxelGrid::Kind::level) lattice.origin = spheres.lower;
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = (both.lower[axis] - lattice.origin[axis]) / lattice.edge;
    const double upper = (both.upper[axis] - lattice.origin[axis]) / lattice.edge;
    lattice.first[axis] = std::floor(lower + rounding_of_a_side);
    const double count = std::max(1.0, std::ceil(upper - rounding_of_a_side) - lattice.first[axis]);
    if (!(count <= most_voxels_along_a_side))
      throw std::invalid_argument("voxel grid: an edge of " + std::to_string(lattice.edge) + " needs more than " +
                                  std::to_string(most_voxels_along_a_side) + " voxels along a side");
    lattice.count[axis] = static_cast<int>(count);
  }
  return lattice;
}

Box checked_box(const MeshView& mesh) {
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f)
      if (!is_finite(mesh.positions[v]))
        throw std::invalid_argument("looseness: vertex " + std::to_string(v) + " has a coordinate that is not finite");
  return bounding_box(mesh);
}

// Input of a count: the mesh of a frame, checked, and the lattice over it.
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
    const Box object = checked_box(mesh);
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
  // The volume of the closed surface is computed exactly: voxels only give the difference of the open one. A body that
  // is aligned with the lattice would gain or lose a layer of voxels.
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
