// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A body: a mesh with its tree and cover, whose spheres follow the vertices.
#pragma once

#include <memory>
#include <morula/geometry/positions.hpp>
#include <morula/tree/cover.hpp>
#include <morula/update/rules.hpp>

namespace morula {

struct UpdateStatus {
  enum class Code : std::uint8_t { ok, wrong_vertex_count, non_finite_position, bad_range };
  Code code = Code::ok;
  std::size_t first_bad_vertex = 0;  ///< of non_finite_position: the lowest
  // Work done, the same on every run; all 0 when nothing was changed.
  std::size_t nodes_updated = 0;
  std::size_t vertices_read = 0;
  std::size_t cut_points_moved = 0;
  std::size_t points_tested = 0;  ///< vertices and corners that nodes looked at: measured or, by approach2, boxed

  explicit operator bool() const { return code == Code::ok; }
};

/// Degenerate cases met when the body was made.
struct BindReport {
  std::size_t void_spheres = 0;  ///< nodes that enclose no vertex (traditional, weighted): they follow a linked facet
  std::size_t unlinked_spheres = 0;    ///< leaves that touch no facet: linked to the nearest one (approaches 1 and 2)
  std::size_t degenerate_anchors = 0;  ///< nodes with fewer than four independent anchors: they follow their mean
  std::size_t carried_centers = 0;  ///< centres far outside the hull of their anchors: the remainder turns with these
  std::size_t corners_owned = 0;    ///< points tested by a leaf level of `exact`
};

/// Reads positions, writes spheres, nothing else. Every update starts from the rest state, so the result depends only
/// on the positions: back at rest the spheres are those of rest, bit for bit.
class Body {
 public:
  /// Copies what it needs from mesh and built. The tree must be the cover's.
  ///
  /// Starts at rest, with the spheres that update(mesh.positions) makes: the tree's, narrowed to float with radii
  /// rounded up, by approach1 and approach2; of the same centre and the radius that their rule gives, by the others.
  /// Throws std::invalid_argument when mesh and built do not belong together (sizes, indices, regions, mesh hash), a
  /// rule list is empty, an option is out of range, or coordinates about the centre reach 2^57 (1.4e17): their squares
  /// would leave the range of float.
  Body(const Mesh& mesh, const Built& built, UpdateOptions options = {}, Workers& workers = serial_workers());
  ~Body();
  Body(Body&&) noexcept;
  Body& operator=(Body&&) noexcept;

  /// Moves every sphere to the given positions: one per mesh vertex, in mesh order and units, float or double.
  ///
  /// With the rule `exact`, every level then covers the surface; radii are rounded up, so rounding cannot lose cover.
  /// Positions are narrowed to float about an origin that moves with the body, so being far away costs no precision.
  /// A wrong count or a coordinate (of a vertex that facets use) that is not finite, or 2^57 or more from the origin,
  /// is reported and changes nothing: the last good spheres stay. No allocation. Same bits for any number of workers.
  /// Cost: linear in vertices + cut points + owned corners (exact) or links (other rules).
  UpdateStatus update(const PositionView& positions, Workers& workers = serial_workers()) noexcept;

  /// The same spheres, bit for bit, when only vertices in these ranges may differ from the last update's positions.
  ///
  /// positions: of all vertices. With `exact` on all levels, the cost follows what moved: the leaves that own something
  /// of it, and the leaves below nodes whose centres hang on it. Everything is updated where that is not possible: other
  /// rules, after an update that failed, and when the vertex moved that the origin follows (the first one that a facet
  /// uses). A range that ends before it begins or behind the last vertex gives bad_range and changes nothing.
  UpdateStatus update(const PositionView& positions, std::span<const VertexRange> changed,
                      Workers& workers = serial_workers()) noexcept;

  /// The current spheres, one per node, about origin(). Read them between updates, not during one.
  std::span<const Spheref> spheres() const;
  Vec3 origin() const;
  /// The current spheres in mesh coordinates.
  Sphere sphere(std::uint32_t node) const;
  void copy_spheres(std::vector<Sphere>& spheres) const;
  /// The current tree in mesh coordinates: what `morula update` writes per frame.
  SphereTree current_tree() const;
  /// 64-bit FNV-1a over origin and spheres.
  std::uint64_t hash() const;

  const SphereTree& rest_tree() const;
  const Cover& cover() const;
  const UpdateOptions& options() const;
  const BindReport& bind_report() const;
  std::size_t vertex_count() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
