// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Samples that move with the surface, with the outward direction and the curvature there.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/positions.hpp>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <vector>

namespace morula::detail {

/// Lanes of one block: loops over them are of fixed length, so that compilers turn them into vector instructions.
inline constexpr std::size_t block_size = 16;
/// Blocks of a group: consecutive, so near each other.
inline constexpr std::size_t group_size = 8;

/// Samples near each other, component by component.
struct SampleBlock {
  using Lanes = std::array<float, block_size>;
  Lanes x, y, z;  ///< place, about origin(), in units of 1 / per_mesh_unit()
  Lanes dx, dy,
      dz;      ///< unit direction outward: normals averaged over the neighbors, so that neighboring rays fan out
  Lanes flux;  ///< area, times the cosine between direction and normal
  Lanes growth1, growth2;  ///< area of the surface moved out by t, over its own: 1 + growth1 t + growth2 t²; 2H and K
};

/// Bounds of a block, stored apart from it: blocks are skipped far more often than read.
struct BlockBound {
  Spheref places;              ///< contains the block's samples
  Vec3f axis;                  ///< axis of the cone of directions
  float cosine = 1, sine = 0;  ///< half angle of the cone, 0…π
};

class SurfaceSamples {
 public:
  SurfaceSamples(const MeshView& rest, std::size_t count);

  void move(const PositionView& positions) noexcept;
  /// The same move in steps, one after the other, all for the same positions: [begin, end) of 0 … move_steps. The first
  /// half moves samples; the second adds up the volume, which takes longer if facets are many.
  void move(std::span<const Vec3> positions, std::size_t begin, std::size_t end) noexcept;
  static constexpr std::size_t move_steps = 16;

  const std::vector<SampleBlock>& blocks() const { return blocks_; }
  const std::vector<BlockBound>& bounds() const { return bounds_; }
  /// One sphere for every group_size blocks: contains the samples of these.
  const std::vector<Spheref>& group_bounds() const { return group_bounds_; }
  const Vec3& origin() const { return origin_; }
  std::size_t count() const { return sites_.size(); }
  std::size_t facet_count() const { return facets_.size(); }
  /// Whether the mesh separates inside from outside; otherwise the side of directions is arbitrary.
  bool has_volume() const { return has_volume_; }
  /// Volume of the object, in mesh units; for an open mesh, of the ball with its area.
  double volume() const { return volume_; }
  /// Scale of the samples: they have units of their own, a power of two, if volumes in mesh units would leave the range
  /// of float.
  double per_mesh_unit() const { return per_mesh_unit_; }

 private:
  static constexpr std::size_t ring_size = 6;
  struct Site {
    Facet facet;
    std::array<double, 3> barycentric;
    double share;                                 // area of the sample over that of its facet, at rest
    std::array<std::uint32_t, ring_size> ring{};  // neighbors, counter-clockwise; repeated if there are fewer
  };

  void sort_into_blocks(std::vector<Vec3f> points);
  struct ComponentIndex;
  ComponentIndex index_components(const MeshView& rest) const;
  void choose_rings(double spacing, const ComponentIndex& index);
  std::array<std::uint32_t, ring_size> ring_of(std::uint32_t sample, double spacing, const ComponentIndex& index) const;
  template <class Reader>
  void move_step(const Reader& positions, std::size_t step) noexcept;
  template <class Reader>
  void place(const Reader& positions, std::size_t begin, std::size_t end) noexcept;
  void bound_blocks() noexcept;
  void bound_groups() noexcept;
  void average_directions(std::size_t begin, std::size_t end) noexcept;
  void measure_curvature(std::size_t begin, std::size_t end) noexcept;
  template <class Reader>
  void measure_volume(const Reader& positions, std::size_t part, std::size_t parts) noexcept;

  std::vector<Site> sites_;  // sites of the samples, block by block
  std::vector<Facet> facets_;
  std::vector<SampleBlock> blocks_;
  std::vector<BlockBound> bounds_;
  std::vector<Spheref> group_bounds_;
  std::vector<Vec3f> point_, normal_, direction_;
  std::vector<float> area_;
  Vec3 origin_;
  double per_mesh_unit_ = 1;
  double volume_ = 0, six_volumes_ = 0;  // six_volumes_: signed, of the facets added up so far
  bool has_volume_ = false;
  bool inside_out_ = false;
};

}  // namespace morula::detail
