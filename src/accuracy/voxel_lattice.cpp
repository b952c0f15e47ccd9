// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "accuracy/voxel_lattice.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace morula::detail {
namespace {

// A box side that is a whole number of edges but for rounding must not get a layer of its own.
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
  return edge > 0 ? edge : 1.0;  // everything is one point
}

}  // namespace

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

}  // namespace morula::detail
