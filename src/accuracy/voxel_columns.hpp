// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Counts voxels inside spheres and inside a mesh, column by column.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/parallel/workers.hpp>
#include <span>

#include "accuracy/voxel_lattice.hpp"

namespace morula::detail {

/// How the crossings of a column with the facets are read.
enum class Inside { unknown, nonzero_winding, odd_crossings };

struct VoxelCounts {
  std::size_t in_union = 0;  ///< centre in some closed ball
  std::size_t inside = 0;    ///< centre in the object; 0 when unknown
  std::size_t in_both = 0;
};

/// On a closed mesh no column leaks, wherever edges and vertices lie: a column that meets one of them counts as if it
/// passed just beside it, on the same side for all facets that share it. A centre exactly on a facet along two axes
/// counts as if it lay just beyond it along +x, +y or +z, so boxes side by side share no voxel; on a slanted facet it
/// may count either way.
VoxelCounts count_voxels(const VoxelLattice& lattice, const MeshView& mesh, Inside inside,
                         std::span<const Sphere> spheres, Workers& workers);

}  // namespace morula::detail
