// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Counts voxels inside spheres and inside a mesh, column by column.
#pragma once

#include <array>
#include <morula/accuracy/looseness.hpp>
#include <morula/geometry/box.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/parallel/workers.hpp>
#include <span>

namespace morula::detail {

/// A finite part of a cubic lattice. Counting works in lattice coordinates, in which voxel centers are the integers:
/// voxel (i, j, k) has its center at lattice coordinates (i, j, k), 0 ≤ i < count[0] and so on.
struct VoxelLattice {
  Vec3 origin;                  // a corner of the lattice, mesh units
  std::array<double, 3> first;  // whole numbers: lower end of the lattice, in voxels from the origin
  std::array<int, 3> count;     // at least 1 each
  double edge;

  Vec3 to_lattice(const Vec3& p) const {
    const Vec3 u = (p - origin) / edge;
    return {u.x - first[0] - 0.5, u.y - first[1] - 0.5, u.z - first[2] - 0.5};
  }
};

/// Twice the finest resolution: room for an object that sticks out of its spheres, within seconds.
inline constexpr int most_voxels_along_a_side = 8192;

/// The rule by which the crossings of a column with the facets are read.
enum class Inside { unknown, nonzero_winding, odd_crossings };

struct VoxelCounts {
  std::size_t in_union = 0;  ///< voxels with the center in some closed ball
  std::size_t inside = 0;    ///< voxels with the center in the object; 0 if that is unknown
  std::size_t in_both = 0;
};

/// On a closed mesh no column leaks, wherever edges and vertices lie: a column that meets one of them counts as if it
/// passed just next to it, on the same side for all facets that share it. A center exactly on a facet along two axes
/// counts as if it lay just beyond it along +x, +y or +z, so boxes side by side share no voxel; on a slanted facet it
/// may count either way.
VoxelCounts count_voxels(const VoxelLattice& lattice, const MeshView& mesh, Inside inside,
                         std::span<const Sphere> spheres, Workers& workers);

/// Winding numbers above which a voxel counts as inside: the middle one gives the figure, and between the other two it
/// is uncertain.
inline constexpr std::array<double, 3> inside_thresholds{0.25, 0.5, 0.75};

struct OpenVoxelCounts {
  std::size_t in_union = 0;
  std::array<std::size_t, 3> inside{}, in_both{};  ///< numbers by threshold
  std::int64_t closed_turns = 0;                   ///< winding numbers of the closed surface, added up over all voxels
};

/// Counts voxels in an open surface by its generalized winding number: that of the closed one, whose crossings are
/// counted, less that of its caps, which are its last facets, from `first_cap` on. sign: −1 if the surface is inside
/// out. Voxels so far from the caps that these cannot change a verdict are counted in runs; for the others a tree over
/// the caps computes it.
OpenVoxelCounts count_open_voxels(const VoxelLattice& lattice, const MeshView& closed, std::size_t first_cap,
                                  double sign, std::span<const Sphere> spheres, Workers& workers);

}  // namespace morula::detail
