// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Counts voxels inside spheres and inside a mesh, column by column.
#pragma once

#include <array>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/parallel/workers.hpp>
#include <span>

#include "accuracy/voxel_lattice.hpp"

namespace morula::detail {

/// How the crossings of a column with the facets are read.
enum class Inside { unknown, nonzero_winding, odd_crossings };

struct VoxelCounts {
  std::size_t in_union = 0;  ///< center in some closed ball
  std::size_t inside = 0;    ///< center in the object; 0 when unknown
  std::size_t in_both = 0;
};

/// On a closed mesh no column leaks, wherever edges and vertices lie: a column that meets one of them counts as if it
/// passed just beside it, on the same side for all facets that share it. A center exactly on a facet along two axes
/// counts as if it lay just beyond it along +x, +y or +z, so boxes side by side share no voxel; on a slanted facet it
/// may count either way.
VoxelCounts count_voxels(const VoxelLattice& lattice, const MeshView& mesh, Inside inside,
                         std::span<const Sphere> spheres, Workers& workers);

/// Winding numbers above which a voxel counts as inside: the figure's, and those between which it is uncertain.
inline constexpr std::array<double, 3> inside_thresholds{0.25, 0.5, 0.75};

struct OpenVoxelCounts {
  std::size_t in_union = 0;
  std::array<std::size_t, 3> inside{}, in_both{};  ///< by threshold
  std::int64_t closed_turns = 0;                   ///< winding numbers of the closed surface, added up over all voxels
};

/// Of an open surface by its generalized winding number: that of the closed one, whose crossings are counted, less that
/// of its caps, which are its last facets, from `first_cap` on. sign: −1 where the surface is inside out. Voxels so far
/// from the caps that these cannot change a verdict are counted in runs; the others ask a tree over the caps.
OpenVoxelCounts count_open_voxels(const VoxelLattice& lattice, const MeshView& closed, std::size_t first_cap,
                                  double sign, std::span<const Sphere> spheres, Workers& workers);

}  // namespace morula::detail
