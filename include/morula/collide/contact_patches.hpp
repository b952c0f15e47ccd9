// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches: the connected parts of the overlap of two solid bodies, or of one with itself, exactly for their
// piecewise linear surfaces.
//
//   morula::ContactPatchQuery query(a, b);                // made once; it follows both bodies
//   if (!query.run()) return;
//   for (const morula::ContactPatch& patch : query.patches())
//     for (const morula::VertexGradient& g : patch.a.gradients)
//       force[g.vertex] -= stiffness * query.volume() * g.gradient;   // energy: stiffness / 2 · volume²
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <morula/collide/budget.hpp>
#include <morula/collide/collider.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/geometry/triangle.hpp>
#include <span>

namespace morula {

struct ContactPatchOptions {
  /// Largest number of points of a patch, from 0 to 16. Three or more reproduce force and torque of the patch, of
  /// any shape; one or two reproduce the force.
  std::uint32_t max_points = 4;
  /// true: compute ContactPatch::depth; for patches of 1,000 facets this may cost more than the rest of the run.
  bool depths = true;
  /// Limit of the work: pair tests, of spheres or of facets; or time by `clock`. Not negative.
  Budget budget{};
  Clock clock{};  ///< clock of a budget of time; empty: std::chrono::steady_clock
};

/// The derivative of the volume of a patch with respect to the position of a vertex.
struct VertexGradient {
  std::uint32_t vertex;
  Vec3 gradient;  ///< mesh units², world coordinates; a third of the area vector of facets wholly in the region
};

/// A facet of which a region contains the whole or a part.
struct PatchFacet {
  std::uint32_t facet;
  Vec3 area_vector;  ///< area vector of the part in the region: its area along the outer normal, mesh units²
};

/// The region of one body's surface that lies inside the other body.
struct PatchSide {
  Vec3 area_vector;  ///< integral of the outer unit normal over the region, mesh units²; the other side's is its
                     ///< negative, up to rounding
  /// Integral of (x − ContactPatch::centroid) × outer unit normal over the region, mesh units³; the other side's is its
  /// negative, up to rounding. It is the derivative of the volume with respect to a rotation about the centroid.
  Vec3 moment;
  double area = 0;                            ///< area of the region, mesh units²
  std::span<const PatchFacet> facets;         ///< ascending
  std::span<const VertexGradient> gradients;  ///< ascending; all vertices of `facets`. Their sum is `area_vector`
};

/// A point that stands for a sector of a patch, about its center of pressure.
struct PatchPoint {
  std::uint32_t id;  ///< number of the sector; with ContactPatch::id it stays while the patch exists;
                     ///< its sector turns when the normal turns far
  Vec3 point;        ///< world coordinates
  /// Share of this point in −PatchSide::area_vector of a, mesh units²: the area of the sector across the normal, along
  /// the normal, plus the least correction with which all forces and torques sum up to those of the patch.
  /// Where facets of a face along the normal, it may be short, or against the normal.
  Vec3 force;
  /// Volume of the sector, and an equal share in sectors without a point, mesh units³; the sum over all points is
  /// ContactPatch::volume.
  double volume = 0;
  /// Mean depth of the sector, mesh units: the mean length of the segments in which lines along the normal pass through
  /// it. That is its volume over the area, across the normal, of the facets of both bodies that face against the
  /// normal; over the length of `force` only if all of those are a's, and no facet of a faces along it. 0 for a sector
  /// without area, which has a point only where fewer than three sectors have one.
  double depth = 0;
  /// Points of both surfaces on the line through `point` along the normal; where the line misses the region, the center
  /// of the facet's part that is nearest to it.
  SurfacePoint on_a, on_b;
};

/// A connected part of the overlap of two bodies. Its surface consists of a region of each body's surface, and both
/// regions meet in the crossing loops.
///
/// For one body a and b are the two sides of its surface that lie inside each other. In the first run a is the side
/// with the lowest facet; later a side remains a while it has facets in common with it. Where the loops do not separate
/// two sides, as at a fold, where three parts overlap, and around a part inside another, a has the whole region: then
/// there is volume, centroid and gradients, but b is empty, and there are no normal, depth and points.
struct ContactPatch {
  /// Number of the patch, the same in later runs while its centroid moves, with one of both bodies, by less than the
  /// square root of its area from run to run. Where several patches are so near, the sum of their moves over these
  /// roots decides which has which number.
  std::uint32_t id = 0;
  double volume = 0;  ///< mesh units³, positive
  Vec3 centroid;      ///< centroid of the volume, world coordinates
  /// Unit vector from b to a: against the area vector of a's region. (0, 0, 0) if that vanishes, for example for a body
  /// wholly inside the other, and for a patch of one body without two sides.
  Vec3 normal;
  /// Least translation of a along the normal that parts both regions, mesh units: the largest distance, along the
  /// normal, from a point of a's region up to a point of b's region. If all facets of a's region face against the
  /// normal and all of b's along it, that parts the overlap. 0 without a normal or without ContactPatchOptions::depths.
  double depth = 0;
  /// Volume over the length of the area vector, mesh units; 0 without a normal. Where facets of a's region face along
  /// the normal, or of b's against it, it may exceed the depth.
  double mean_depth = 0;
  std::size_t crossing_count = 0;  ///< number of points where an edge of one body passes through a facet of the other
  PatchSide a, b;
  std::span<const PatchPoint> points;
};

/// Finds contact patches in every frame, and reuses its memory. Only one thread may use it at a time.
///
/// The overlap consists of the points inside both bodies; where a surface overlaps itself, points count with the
/// product of both winding numbers. All quantities are integrals over its boundary, computed without constructing a
/// polygon; their only errors are those of rounding, relative to the world positions that Collider::vertex returns.
/// Decisions are exact. Surfaces that touch, coplanar facets and identical bodies are treated as if a were translated
/// by an infinitely small vector; volumes, centroids and gradients of volumes are those of the limit. The volume is a
/// continuous function of all positions.
///
/// For one body the integrand is w (w - 1) / 2, w its winding number: a point counts once for each pair of parts of the
/// surface around it. Where the surface is inside out, w < 0, this is the overlap of the outside with itself, so a dent
/// that comes out at the other side counts, too. Vertices are treated as if each were translated by an infinitely small
/// vector of its own.
///
/// Patches of two bodies are complete if the spheres of both cover (SphereState::covers); those of one are complete.
///
/// A run that its budget ends gives no patches, because a loop that is not closed yet bounds no region. It gives
/// contacts of spheres that hold all crossings. Ids of patches last over such runs.
class ContactPatchQuery {
 public:
  /// Keeps both sides (Collider). Throws std::invalid_argument for a collider without facets, a surface that is open or
  /// not oriented, and for a body that is inside out (its volume is negative in the present positions). Cost: O(F log
  /// F) for F facets, once.
  ContactPatchQuery(const Collider& a, const Collider& b);
  /// The patches of a body with itself. Keeps the side; throws and costs like ContactPatchQuery(a, b). Throws
  /// std::invalid_argument also for edges of more than two facets.
  explicit ContactPatchQuery(const Collider& body);
  ~ContactPatchQuery();
  ContactPatchQuery(ContactPatchQuery&&) noexcept;
  ContactPatchQuery& operator=(ContactPatchQuery&&) noexcept;

  /// Computes the patches of the present positions and transforms. Rejects a body that CrossingQuery rejects, more than
  /// 16 points, a negative budget, and a budget for one body (bad_option), and of two bodies a surface that is inside
  /// out where it meets the other (inside_out); all results then stay as they were. If a callback (clock) throws or
  /// moves a body, the query has no results, and patches get new ids.
  ///
  /// A budget of pair tests is never exceeded, and gives the same bits on any machine. A budget of time is read before
  /// every block of at most 64 tests of spheres, before the facets of each pair of leaves, before every 64 pairs of
  /// facets that intersect, and before the integrals of each patch and its depth and points. The run ends late by one
  /// of these steps, by the boundaries of all regions, by the matching of patches with those of the last run, or by the
  /// list of contacts.
  ///
  /// Cost: that of CrossingQuery, about 0.5 µs per pair of facets that intersect and 0.1 µs per facet inside; for one
  /// body instead of CrossingQuery about 0.7 µs per facet. Depths and points cost twice as much in addition, and ids
  /// the square of the number of patches. For two bodies whose overlap has no cavity, allocates nothing where earlier
  /// runs needed as much memory.
  Status run(const ContactPatchOptions& options = {});

  /// The patches of the last run that was not rejected, in the order of the lowest facet of a, then of b. Valid until
  /// the next run.
  std::span<const ContactPatch> patches() const;
  /// True after a run that computed all patches; false after a run that its budget ended, and before the first run.
  bool finished() const;
  /// Contacts of a run that its budget ended, as of ContactQuery with this budget; otherwise empty. Each point where
  /// the surfaces cross, so each loop that bounds a patch, lies in the regions of one of these pairs, within its error
  /// bound. A body wholly inside the other has no crossing, and may be in no contact. Valid until the next run.
  std::span<const Contact> contacts() const;
  double volume() const;  ///< sum of the volumes of all patches, mesh units³
  /// SphereState::covers of both bodies in that run, true for one body; if false, patches may be incomplete.
  bool certified() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
