// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Voxel lattice. Counting works in lattice coordinates, in which voxel centers are the integers.
#pragma once

#include <array>
#include <morula/accuracy/looseness.hpp>
#include <morula/geometry/box.hpp>

namespace morula::detail {

/// A finite piece of a cubic lattice: voxel (i, j, k) has its center at lattice coordinates (i, j, k),
/// 0 ≤ i < count[0] and so on.
struct VoxelLattice {
  Vec3 origin;                  // a corner of the lattice, mesh units
  std::array<double, 3> first;  // whole numbers: the piece starts this many voxels from the origin
  std::array<int, 3> count;     // at least 1 each
  double edge;

  Vec3 to_lattice(const Vec3& p) const {
    const Vec3 u = (p - origin) / edge;
    return {u.x - first[0] - 0.5, u.y - first[1] - 0.5, u.z - first[2] - 0.5};
  }
};

/// Twice the finest resolution: room for an object that sticks out of its spheres, within seconds.
inline constexpr int most_voxels_along_a_side = 8192;

/// The piece that holds both boxes, so that nothing of the object or of the spheres goes uncounted. Edge and phase come
/// from the grid alone (of `level`: from the spheres' box alone), unless that needs too many voxels along a side: then
/// `level` takes a longer edge and `fixed` throws std::invalid_argument, as it does for a bad grid.
VoxelLattice voxel_lattice(const VoxelGrid& grid, const Box& spheres, const Box& mesh);

}  // namespace morula::detail
