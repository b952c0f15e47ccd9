// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Looseness: the empty volume inside a level's spheres, measured in voxels [garcia2005, eq. 6–7].
//
//   const morula::CoveredTree model = morula::build(mesh);
//   const std::size_t leaves = model.tree.level_count() - 1;
//   const morula::Looseness loose = morula::looseness(mesh, level_set_spheres(model.tree, leaves));
//   if (loose.looseness) std::printf("%g object volumes are outside the object\n", *loose.looseness);
//   const morula::LoosenessMeter meter(mesh);  // for many frames of one mesh
//   const morula::Looseness moved = meter.measure(positions, level_set_spheres(model.tree, 1), {.resolution = 64});
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/parallel/workers.hpp>
#include <optional>
#include <span>

namespace morula {

/// Both lattices continue beyond the spheres' box, with the same edge and phase, to the end of the object, so parts of
/// the object outside its spheres count as missed. No side may need more than 8192 voxels: `level` then uses a longer
/// edge (see Looseness::voxel_edge), `fixed` is rejected.
struct VoxelGrid {
  /// level: voxels fill the box of the level's spheres, `resolution` along its longest side, like the paper's grid.
  /// fixed: voxels of one edge length on a lattice through the origin, the same for all frames, levels and methods.
  enum class Kind : std::uint8_t { level, fixed };
  Kind kind = Kind::level;
  int resolution = 192;     ///< voxels along the longest side for `level`: 8…4096
  double voxel_edge = 0.0;  ///< edge of a voxel for `fixed`, mesh units; rest diagonal / 192 is a good choice
};

struct Looseness {
  /// Volume inside the spheres and outside the object, divided by the object's volume. No value if the mesh is open, so
  /// that inside is undefined, or if the object has no volume.
  std::optional<double> looseness;
  /// Volume of the object outside all spheres, divided by the object's volume; the paper assumes 0.
  std::optional<double> missed_volume;
  double outside_volume = 0;  ///< volume inside the spheres and outside the object, mesh units³; 0 if unknown
  double object_volume = 0;   ///< signed volume of an oriented mesh, otherwise counted in voxels; mesh units³
  double union_volume = 0;    ///< volume of the union of spheres, mesh units³; always known
  std::size_t voxels = 0;     ///< number of classified voxels
  double voxel_edge = 0;
  /// For an open mesh, by its winding number: the looseness if a voxel counts as inside from ¼ of a turn on, and from ¾
  /// on. The mesh does not determine the voxels between these: they depend on the surface that closes it.
  struct Range {
    double low = 0, high = 0;
  };
  std::optional<Range> range{};
};

/// Measures the looseness of a set of spheres. A voxel is inside the object if its center has a non-zero winding number
/// (closed, oriented meshes of either orientation) or an odd number of crossings (closed but not oriented). A voxel in
/// two overlapping components counts once; the signed volume, which divides the counts, counts such space twice and
/// inverted components negatively.
///
/// spheres: one level set, at least one sphere. The result has the same bits for any number of workers. Error: O(voxel
/// edge × area). Cost: O(F × columns per facet + spheres × columns per sphere), with bits along columns; memory is
/// bounded by one strip of columns per worker. Throws std::invalid_argument for a bad grid, bad spheres and coordinates
/// that are not finite.
Looseness looseness(const MeshView& mesh, std::span<const Sphere> spheres, const VoxelGrid& grid = {},
                    WorkersOrAll workers = {});

/// Measures looseness for many frames of one mesh.
class LoosenessMeter {
 public:
  explicit LoosenessMeter(const MeshView& mesh);  ///< inspects connectivity once; borrows nothing
  /// Measures one frame. positions: one per vertex, at rest or deformed.
  Looseness measure(const PositionView& positions, std::span<const Sphere> spheres, const VoxelGrid& grid,
                    Workers& workers = serial_workers()) const;
  /// Measures open, oriented meshes: a voxel is inside if the winding number of the surface at its center exceeds one
  /// half [jacobson2013], which near a hole means about up to a flat cap. Looseness, missed volume and object volume
  /// refer to this inside; `range` bounds the effect of the holes. No value, as in measure(), if the mesh is not
  /// oriented, or so open that no voxel is ¾ of a turn inside. A closed mesh of either orientation gives the result of
  /// measure(). The lattice errors are those of measure(); the same bits for any number of workers. Cost: that of
  /// measure(), and a few microseconds for every voxel near a hole (within about its size).
  Looseness measure_open(const PositionView& positions, std::span<const Sphere> spheres, const VoxelGrid& grid,
                         Workers& workers = serial_workers()) const;

  /// True if inside and outside are well defined: the mesh is closed and consistently oriented.
  bool has_volume() const { return closed_ && oriented_; }

 private:
  std::vector<Facet> facets_;
  std::size_t vertex_count_;
  bool closed_, oriented_;
};

}  // namespace morula
