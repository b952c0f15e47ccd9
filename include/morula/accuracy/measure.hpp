// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Measurements: a tree level by level, and each figure by itself. looseness.hpp has the looseness.
#pragma once

#include <array>
#include <morula/accuracy/looseness.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <optional>
#include <span>
#include <vector>

namespace morula {

/// Coverage: the uncovered part of the surface, its area and its distance from the spheres. Exact, not sampled.
struct [[nodiscard]] Coverage {
  /// The certificate: every corner of every power cell lies in the cell's sphere, within `tolerance`. If rounding
  /// misplaced a cell, smaller parts of it are compared with any sphere that contains them.
  bool covered = false;
  /// Share of the surface outside the union of spheres, in closed form per power cell; 0 if covered.
  double uncovered_area = 0;
  /// Largest distance of a surface point from the union, attained, mesh units; 0 if covered.
  double uncovered_distance = 0;
  double uncovered_distance_upper = 0;  ///< proven upper bound of that distance, within relative 1e-6 and twice the
                                        ///< tolerance of it, mesh units; 0 if covered
  double tolerance = 0;                 ///< rounding allowance of the certificate, mesh units
  std::uint32_t worst_facet = 0;        ///< facet with the largest distance; among equals the lowest
};

/// Computes the coverage of a mesh. spheres: one level set, at least one sphere. Zero-area facets count for the
/// certificate and the distance, not for the area. Rounding: corners are evaluated in double; tolerance = 2⁻⁴⁶ × the
/// largest |coordinate| or radius. "Covered" means covered by spheres whose radii are larger by the tolerance. The
/// result has the same bits for any number of workers. Throws std::invalid_argument for bad spheres. Cost: O(F log n +
/// polygons); the distance by branch and bound on the uncovered polygons only (at most 2²⁰ steps; beyond them
/// uncovered_distance_upper is still proven).
Coverage coverage(const MeshView& mesh, std::span<const Sphere> spheres, WorkersOrAll workers = {});

/// Largest distance from a point of the ball to the object: max over the ball of φ⁺, including cavities; mesh units.
struct BallProtrusion {
  double lower;  ///< attained by a point of the ball
  double upper;  ///< proven bound; upper − lower ≤ tolerance × radius
};
/// Branch and bound on the octree of the ball's cube, started from directions on the sphere. The object must be a
/// closed, oriented mesh, so that inside is defined. tolerance: positive, share of the radius; never finer than 2⁻⁴⁶ of
/// the largest coordinate. Cost: a few distances if the nearest surface continues straight, as on convex objects;
/// otherwise about 1/tolerance. Throws std::invalid_argument for a bad ball or tolerance.
BallProtrusion protrusion(const SignedDistance& object, const Sphere& ball, double tolerance = 1e-3);

struct Protrusion {
  double worst = 0;  ///< largest upper bound over the spheres, mesh units
  double mean = 0;
};
/// Protrusion of a set of spheres. The result has the same bits for any number of workers.
Protrusion protrusion(const SignedDistance& object, std::span<const Sphere> spheres, double tolerance = 1e-2,
                      WorkersOrAll workers = {});

/// cuRobo's figures for spheres, so that one table can compare sets of both programs: estimates from samples, without
/// proof. The other results of measure() are proven. Lengths are in mesh units.
struct SampledFit {
  // The optional values are empty if the mesh has no volume.
  std::optional<double> coverage;         ///< share of interior samples inside some sphere
  std::optional<double> protrusion;       ///< share of samples on the spheres that lie outside the object
  std::optional<double> protrusion_mean;  ///< mean distance of those samples from the object; 0 if there are none
  std::optional<double> protrusion_p95;   ///< 95th percentile of these distances
  std::optional<double> protrusion_max;
  /// Sum of the spheres' volumes, overlaps included, divided by the object's volume.
  std::optional<double> volume_ratio;

  double surface_gap_mean = 0;  ///< mean distance of samples of the surface from the nearest sphere, 0 inside one
  double surface_gap_p95 = 0;
  double surface_gap_max = 0;
};

struct SampleCounts {
  std::size_t interior = 10000;  ///< largest number; less if the object fills little of its box
  std::size_t surface = 5000;
  std::size_t of_a_sphere = 200;
  std::uint64_t seed = 1;
};

/// Samples for several sets of spheres of one mesh: draws the samples of the object once.
class FitSampler {
 public:
  /// Interior samples are uniform in the box and restricted to the object; surface samples are stratified by area;
  /// samples on a sphere form a Fibonacci lattice. cuRobo draws all of them at random. Borrows nothing. Throws
  /// std::invalid_argument for an unusable mesh (require_usable, require_usable_scale).
  explicit FitSampler(const MeshView& mesh, const SampleCounts& counts = {}, Workers& workers = serial_workers());

  /// Measures a set of at least one sphere. The result has the same bits for any number of workers. Cost: samples ×
  /// spheres, and a signed distance for each sample on a sphere. Throws std::invalid_argument for spheres that
  /// measure() rejects.
  SampledFit measure(std::span<const Sphere> spheres, Workers& workers = serial_workers()) const;

 private:
  SampleCounts counts_;
  std::optional<SignedDistance> object_;  // signed distance of a mesh with a volume
  double volume_ = 0;
  std::vector<Vec3> interior_, surface_;
};

struct LevelMeasure {
  std::size_t level = 0;
  std::size_t spheres = 0;  ///< number of spheres of the level set, including early leaves
  Looseness looseness;
  Coverage coverage;
  std::optional<Protrusion> protrusion;  ///< protrusion; no value if switched off or if the mesh has no inside
  std::optional<SampledFit> sampled{};   ///< cuRobo's figures, if requested
};

struct MeasureOptions {
  VoxelGrid grid{};
  bool with_protrusion = true;
  double protrusion_tolerance = 1e-2;  ///< share of each radius
  bool with_sampled_fit = false;       ///< compute cuRobo's figures as well
  bool open_by_winding = false;        ///< measure open meshes by LoosenessMeter::measure_open
};

/// Measures every level of a tree. tree: in mesh coordinates, at rest or in a frame, with the mesh at the same
/// positions.
std::vector<LevelMeasure> measure(const MeshView& mesh, const SphereTree& tree, const MeasureOptions& options = {},
                                  WorkersOrAll workers = {});

/// Measures spheres without a tree as one level, 0. spheres: at least one.
LevelMeasure measure_spheres(const MeshView& mesh, std::span<const Sphere> spheres, const MeasureOptions& options = {},
                             WorkersOrAll workers = {});

/// Mass properties of a set of spheres as one solid of density 1; each point counts once.
struct UnionMass {
  double volume = 0;
  Vec3 center{};
  std::array<double, 6> inertia{};  ///< moments xx, xy, xz, yy, yz, zz about the center
};
/// Mass properties from exact columns along z, `resolution` of them across the longer side; the error is a few tenths
/// of a percent.
UnionMass union_mass(std::span<const Sphere> spheres, int resolution = 160);

struct ConvergedMass {
  UnionMass solid;
  double change;  ///< relative change of volume and inertia at the last halving of the columns
};
/// Mass properties from columns that are halved until the relative change of volume and inertia is at most `tolerance`,
/// or until 2560 lie across the longer side. Cost: about 0.2 s for 16 spheres and the usual tolerance.
ConvergedMass converged_union_mass(std::span<const Sphere> spheres, double tolerance = 1e-4);

}  // namespace morula
