// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Looseness: how much empty space a level's spheres take in, counted in voxels [garcia2005, eq. 6–7].
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/parallel/workers.hpp>
#include <optional>
#include <span>

namespace morula {

/// Either lattice goes on past the spheres' box, with the same edge and phase, as far as the object reaches: an object
/// that sticks out of its spheres is missed, not forgotten. No side may need more than 8192 voxels: `level` then takes
/// a longer edge (see Looseness::voxel_edge), `fixed` is refused.
struct VoxelGrid {
  /// level: voxels fill the box of the level's spheres, `resolution` along its longest side: the paper's grid.
  /// fixed: voxels of one edge length on a lattice through the origin, the same for all frames, levels and methods.
  enum class Kind : std::uint8_t { level, fixed };
  Kind kind = Kind::level;
  int resolution = 192;     ///< of `level`: 8…4096
  double voxel_edge = 0.0;  ///< of `fixed`, mesh units; rest diagonal / 192 is a good choice
};

struct Looseness {
  /// Volume inside the spheres and outside the object over the object's volume. Nothing when the mesh does not tell
  /// inside from outside (open), and when the object has no volume: that is said, not guessed.
  std::optional<double> looseness;
  /// Volume of the object that no sphere contains, over the object's volume: the paper assumes this is none.
  std::optional<double> missed_volume;
  double outside_volume = 0;  ///< mesh units cubed; 0 when unknown
  double object_volume = 0;   ///< signed volume of the mesh when oriented, else counted in voxels
  double union_volume = 0;    ///< volume of the union of spheres, always known
  std::size_t voxels = 0;     ///< voxels looked at
  double voxel_edge = 0;
  /// Of an open mesh, by its winding number: the looseness where a voxel counts as inside from ¼ of a turn on, and from
  /// ¾ on. What a surface that closes the mesh makes of the voxels between these is not in the mesh.
  struct Range {
    double low = 0, high = 0;
  };
  std::optional<Range> range{};
};

/// A voxel is inside the object when its center has non-zero winding number (closed, oriented meshes, either way round)
/// or an odd number of crossings (closed but not oriented). A voxel in two overlapping components counts once; the
/// signed volume, by which counts are divided, counts such space twice and a component the wrong way round negatively.
///
/// spheres: one level set, at least one sphere. Same bits for any number of workers. Error O(voxel edge × area).
/// Cost: O(F × columns per facet + spheres × columns per sphere), bits along columns; memory is bounded by one strip of
/// columns per worker. Throws std::invalid_argument for a bad grid, bad spheres and coordinates that are not finite.
Looseness looseness(const MeshView& mesh, std::span<const Sphere> spheres, const VoxelGrid& grid = {},
                    Workers& workers = serial_workers());

/// For many frames of one mesh.
class LoosenessMeter {
 public:
  explicit LoosenessMeter(const MeshView& mesh);  ///< inspects connectivity once; borrows nothing
  /// positions: one per vertex, at rest or deformed.
  Looseness measure(const PositionView& positions, std::span<const Sphere> spheres, const VoxelGrid& grid,
                    Workers& workers = serial_workers()) const;
  /// Of open meshes whose facets agree about which side is out: a voxel is inside when the surface winds around its
  /// center more than half a turn [jacobson2013], which near a hole means about as far as a flat cap would reach.
  /// Looseness, missed and object volume are of that; `range` says how far the holes leave them open. Nothing, as for
  /// measure(), when the mesh is not oriented, or so open that nothing is ¾ of a turn inside. A closed mesh, either
  /// way, is measured as by measure(). Within the same errors of the lattice; the same bits for any number of workers.
  /// Cost: that of measure(), and some microseconds for every voxel near a hole (within about its size).
  Looseness measure_open(const PositionView& positions, std::span<const Sphere> spheres, const VoxelGrid& grid,
                         Workers& workers = serial_workers()) const;

  /// Inside and outside are well defined: closed and consistently oriented.
  bool has_volume() const { return closed_ && oriented_; }

 private:
  std::vector<Facet> facets_;
  std::size_t vertex_count_;
  bool closed_, oriented_;
};

}  // namespace morula
