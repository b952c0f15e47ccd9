// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Layer patches: the connected parts where two surfaces, open or closed, are nearer to each other than a thickness, or
// where one surface is that near to itself.
//
//   morula::LayerPatchQuery query({.thickness = 0.01});    // made once; it keeps its memory
//   if (!cloth.update(positions) || !query.run(cloth, ball)) return;
//   for (const morula::LayerPatch& patch : query.patches())
//     for (const morula::VertexGradient& g : patch.a.gradients)
//       force[g.vertex] -= stiffness * g.gradient;         // of the energy stiffness · volume
#pragma once

#include <memory>
#include <morula/collide/contact_patches.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/surface_tree.hpp>
#include <vector>

namespace morula {

struct LayerPatchOptions {
  /// Distance below which surfaces act on each other, mesh units; finite, more than 0. The cost grows with the number
  /// of pairs of facets within it.
  double thickness = 0;
  /// Largest number of points of a patch, from 0 to 16. Three or more reproduce force and torque of the patch; one or
  /// two reproduce the force.
  std::uint32_t max_points = 4;
  /// Pairs of facets to be skipped (PairKind::facet_facet). An edge and a facet act on each other if the facet and any
  /// facet of the edge do. One surface with itself needs a `rest_distance` of `thickness` or more, or neighbors act on
  /// each other at rest.
  PairFilter filter{};
  Budget budget{};
  Clock clock{};
};

/// One surface's side of a patch.
struct LayerSide {
  Vec3 area_vector;  ///< derivative of the volume with respect to a translation of this side, mesh units²; the other
                     ///< side's is its negative, up to rounding
  Vec3 moment;       ///< the same for a rotation about LayerPatch::centroid, mesh units³
  double area = 0;   ///< rest area of this side nearer to the other than the thickness, as often as it counts, mesh
                     ///< units²
  std::span<const std::uint32_t> facets;  ///< facets nearer to a facet of the other side than the thickness; ascending
  std::span<const VertexGradient> gradients;  ///< ascending. Their sum is `area_vector`
};

/// A point that stands for a sector of a patch, about its center of pressure. Sectors pass into each other smoothly.
struct LayerPoint {
  std::uint32_t id;         ///< number of the sector; with LayerPatch::id it stays
                            ///< while the patch exists; its sector turns when the normal turns far
  Vec3 point;               ///< center of pressure of the sector, midway between both surfaces, world coordinates
  Vec3 force;               ///< share of this point in −LayerSide::area_vector of a, mesh units²
  double volume = 0;        ///< volume of the sector, mesh units³; the sum over all points is LayerPatch::volume
  double depth = 0;         ///< mean depth of the sector, as LayerPatch::mean_depth, mesh units
  SurfacePoint on_a, on_b;  ///< points of LayerSide::facets that are nearest to `point`
};

/// A connected group of pairs of facets that are nearer to each other than the thickness. Two pairs are connected if
/// they have one facet in common and their other facets share a vertex.
struct LayerPatch {
  /// Number of the patch. It stays from run to run while a vertex with a gradient stays on the same side, however far
  /// the surfaces move; where patches join or part, the one with more such vertices has it.
  std::uint32_t id = 0;
  double volume = 0;  ///< mesh units³; LayerPatchQuery defines it
  Vec3 centroid;      ///< mean of the points midway between both surfaces, weighted as in the volume, world coordinates
  Vec3 normal;        ///< unit vector from b to a, against the area vector of a; (0, 0, 0) if that vanishes
  double depth = 0;   ///< thickness minus the least distance, mesh units
  double mean_depth = 0;  ///< mean of thickness minus distance, weighted by itself, mesh units
  LayerSide a, b;
  std::span<const LayerPoint> points;  ///< none without a normal, and where holes leave no pressure
};

/// Finds layer patches in every frame, and reuses its memory. Only one thread may use it at a time.
///
/// **Volume.** Each point x of a surface whose distance d from the other is less than the thickness h counts with
/// φ(d) = (h − d)² / 2h, which is the overlap h − d of layers, smoothed so that its derivative vanishes at h. The
/// volume is half of the sum of both surfaces' integrals, over their areas at rest. So the energy k · volume is an
/// elastic layer with the pressure k (1 − d/h). An integral over a surface is taken along its edges: an edge counts
/// with a third of the rest area of its facets. So each edge acts on facets, edges and vertices of the other surface,
/// and none is missed between samples.
///
/// **No double counting.** The distance is that from facets, minus that from edges between facets, plus that from
/// vertices: f(x) = Σ over facets, edges and vertices of c φ(distance), with c = 1 for facets, 1 − (facets) for an
/// edge, and 1 − (facets) + Σ over its edges of (facets − 1) for a vertex. Then f(x) is exactly φ(distance of the whole
/// surface) if every ball about x with a radius up to h meets the surface in one part without a hole. If it meets
/// several parts, each counts: both sheets of a fold, both sides of a groove, both sides of a seam whose vertices are
/// not shared. If it meets a part with a hole, the hole is subtracted. So near holes narrower than about 2 h, as in a
/// net, forces are less, and volumes, areas and forces may have the wrong sign: choose h below the width of holes.
///
/// **Continuity.** The distance of x from a facet, edge or vertex is a continuous function of all positions, and
/// continuously differentiable where it is not 0 and the feature is not degenerate; so is φ of it, since φ(h) = φ'(h) =
/// 0. The weights c and the rest areas are constant. So volumes and gradients (LayerSide::gradients) are continuous
/// functions of all positions, except gradients
/// - where a part of an edge lies in a facet, edge or vertex of the other side, up to 2^-46 of the largest coordinate:
///   such a part has no direction, and no share in gradients;
/// - where a facet passes through a line, or an edge through a point: the force passes to other vertices of it. A facet
///   counts as its longest edge from a height of 1e-8 of that edge on.
/// The volume is still continuous there. Patches that join add up.
///
/// **Exact and convergent.** The integrals along edges have relative errors of about 1e-10, and up to 1e-8 of its
/// longest edge at a facet that is nearly a line; forces and torques of both sides add up to 0 up to rounding at any
/// error. The edges' areas are a quadrature that is exact where φ is a linear function on each facet, so volumes and
/// gradients converge to those of the smooth surfaces with the square of the edge length, if h is below the radii of
/// curvature. Facets have to be small against the contact: inside a large one its surface does not count, and at an
/// edge of one it counts with the area of the whole facet per length of the edge.
///
/// **Sides.** Distances have no sign: surfaces that have passed through each other are pushed apart on the wrong side.
/// Limit steps by SweptQuery::collision_free_step(), or let the stiffness grow, to keep sides.
class LayerPatchQuery {
 public:
  /// Throws std::invalid_argument for a thickness that is not finite and positive, more than 16 points, and a negative
  /// budget.
  explicit LayerPatchQuery(LayerPatchOptions options);
  ~LayerPatchQuery();
  LayerPatchQuery(LayerPatchQuery&&) noexcept;
  LayerPatchQuery& operator=(LayerPatchQuery&&) noexcept;
  void set_options(LayerPatchOptions options);
  const LayerPatchOptions& options() const;

  /// Computes the patches of one surface with itself, or of two, from the beginning. Trees are borrowed until the last
  /// resume(). A surface in a step is tested at its beginning. Rejected with bad_option: masks of another number of
  /// facets. Complete: every pair of facets nearer than the thickness is found, up to 2^-46 of the largest coordinate,
  /// where neither has a repeated index; such facets take no part.
  /// Cost: a search, and then about 2 µs per pair of facets with near boxes. The first run with a surface makes
  /// tables of its edges, in linear time.
  SurfaceQueryStatus run(const SurfaceTree& surface, Workers& workers = serial_workers());
  SurfaceQueryStatus run(const SurfaceTree& a, const SurfaceTree& b, Workers& workers = serial_workers());
  /// Continues after a budget ended the query, with a new budget; rejected as ProximityQuery::resume() is. Unfinished
  /// patches are those of the pairs of facets compared so far, as if the others did not act on each other.
  SurfaceQueryStatus resume(Workers& workers = serial_workers());

  /// The patches, in the order of the lowest pair of facets. Valid until the next call. They have the same bits for any
  /// number of workers and interruptions. For one surface with itself a is the side of the lower facets of the lowest
  /// pair in the first run of an id, and stays. A patch whose sides are connected with each other, as in a roll, has
  /// the lower facet of each pair in a: gradients of a and b together are right, but area vectors, normal and points
  /// depend on the numbers of facets.
  std::span<const LayerPatch> patches() const;
  double volume() const;  ///< sum of the volumes of all patches, mesh units³
  const std::vector<OpenFacets>& open() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
