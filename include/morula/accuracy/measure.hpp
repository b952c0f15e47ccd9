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

/// Coverage: is any of the surface bare, how much, and how far out does it lie? Exact, not sampled.
struct [[nodiscard]] Coverage {
  /// The certificate: every corner of every power cell lies in the cell's sphere, within `tolerance`. Where rounding
  /// misplaced a cell, smaller pieces of it are held against whichever sphere contains them.
  bool covered = false;
  double uncovered_area = 0;  ///< share of the surface outside the union, closed form per power cell; 0 when covered
  double uncovered_distance = 0;  ///< largest distance of a surface point from the union, attained; 0 when covered
  double uncovered_distance_upper = 0;  ///< proven upper bound of the gap: within relative 1e-6 and twice the tolerance
                                        ///< of it; 0 when covered
  double tolerance = 0;                 ///< rounding allowance of the certificate, mesh units
  std::uint32_t worst_facet = 0;        ///< where the gap is; among equals the lowest
};

/// spheres: one level set, at least one sphere. Zero-area facets count for the certificate and the gap, not the area.
/// Rounding: corners are evaluated in double; tolerance = 2⁻⁴⁶ × the largest |coordinate| or radius. "Covered" means
/// covered by spheres whose radii are larger by the tolerance.
/// Same bits for any number of workers. Throws std::invalid_argument for bad spheres.
/// Cost: O(F log n + pieces), the gap by branch and bound on the bare pieces only (at most 2²⁰ steps; should they run
/// out, uncovered_distance_upper is still proven).
Coverage coverage(const MeshView& mesh, std::span<const Sphere> spheres, WorkersOrAll workers = {});

/// Largest distance from a point of the ball to the object: max over the ball of φ⁺, cavities included.
struct BallProtrusion {
  double lower;  ///< attained
  double upper;  ///< proven; upper − lower ≤ tolerance × radius
};
/// Branch and bound on the octree of the ball's cube, started from directions on the sphere. The object must tell
/// inside from outside (a closed, oriented mesh). tolerance: positive, share of the radius; never finer than 2⁻⁴⁶ of
/// the largest coordinate. Cost: a few distances where the nearest surface goes on straight, as on convex objects; else
/// about 1/tolerance. Throws std::invalid_argument for a bad ball or tolerance.
BallProtrusion protrusion(const SignedDistance& object, const Sphere& ball, double tolerance = 1e-3);

struct Protrusion {
  double worst = 0;  ///< over the spheres, upper ends; mesh units
  double mean = 0;
};
/// Same bits for any number of workers.
Protrusion protrusion(const SignedDistance& object, std::span<const Sphere> spheres, double tolerance = 1e-2,
                      WorkersOrAll workers = {});

/// The figures by which cuRobo judges spheres, so that sets of both can be compared in one table: estimates from
/// samples, without proof. What measure() says beside them is proven. Lengths are in mesh units.
struct SampledFit {
  // Nothing where the mesh has no volume.
  std::optional<double> coverage;         ///< share of interior samples inside some sphere
  std::optional<double> protrusion;       ///< share of samples on the spheres that lie outside the object
  std::optional<double> protrusion_mean;  ///< distance of those samples from the object; 0 where there are none
  std::optional<double> protrusion_p95;   ///< the distance that 95 % of them do not exceed
  std::optional<double> protrusion_max;
  std::optional<double> volume_ratio;  ///< the spheres' volumes, overlaps counted each time, over the object's

  double surface_gap_mean = 0;  ///< distance of samples of the surface from the nearest sphere; 0 inside one
  double surface_gap_p95 = 0;
  double surface_gap_max = 0;
};

struct SampleCounts {
  std::size_t interior = 10000;  ///< at most; fewer where the object fills little of its box
  std::size_t surface = 5000;
  std::size_t of_a_sphere = 200;
  std::uint64_t seed = 1;
};

/// For several sets of spheres about one mesh: draws the samples of the object once.
class FitSampler {
 public:
  /// Interior samples are uniform in the box and kept where the object is; those of the surface are stratified by area,
  /// those on a sphere a Fibonacci lattice, where cuRobo draws all at random. Borrows nothing.
  /// Throws std::invalid_argument for an unusable mesh (require_usable, require_usable_scale).
  explicit FitSampler(const MeshView& mesh, const SampleCounts& counts = {}, Workers& workers = serial_workers());

  /// At least one sphere. The same bits for any number of workers. Cost: samples × spheres, and a signed distance for
  /// each sample on a sphere. Throws std::invalid_argument for spheres that measure() refuses.
  SampledFit measure(std::span<const Sphere> spheres, Workers& workers = serial_workers()) const;

 private:
  SampleCounts counts_;
  std::optional<SignedDistance> object_;  // of a mesh with a volume
  double volume_ = 0;
  std::vector<Vec3> interior_, surface_;
};

struct LevelMeasure {
  std::size_t level = 0;
  std::size_t spheres = 0;  ///< of the level set, early leaves included
  Looseness looseness;
  Coverage coverage;
  std::optional<Protrusion> protrusion;  ///< not taken when switched off or on a mesh without inside
  std::optional<SampledFit> sampled{};   ///< when asked for
};

struct MeasureOptions {
  VoxelGrid grid{};
  bool with_protrusion = true;
  double protrusion_tolerance = 1e-2;  ///< share of each radius
  bool with_sampled_fit = false;       ///< cuRobo's figures as well
  bool open_by_winding = false;        ///< looseness of open meshes by LoosenessMeter::measure_open
};

/// One entry per level. tree: in mesh coordinates, at rest or of a frame whose positions the mesh has.
std::vector<LevelMeasure> measure(const MeshView& mesh, const SphereTree& tree, const MeasureOptions& options = {},
                                  WorkersOrAll workers = {});

/// The same of spheres that are in no tree, as one level, 0. At least one.
LevelMeasure measure_spheres(const MeshView& mesh, std::span<const Sphere> spheres, const MeasureOptions& options = {},
                             WorkersOrAll workers = {});

/// Of a set of spheres as one solid of density 1, each point counted once.
struct UnionMass {
  double volume = 0;
  Vec3 center{};
  std::array<double, 6> inertia{};  ///< xx, xy, xz, yy, yz, zz about the center
};
/// Columns along z are exact, and as many as `resolution` lie across the longer side: within some tenths of a percent.
UnionMass union_mass(std::span<const Sphere> spheres, int resolution = 160);

struct ConvergedMass {
  UnionMass solid;
  double change;  ///< of volume and inertia at the last halving of the columns, as a share of them
};
/// The same with columns that are halved until volume and inertia change by no more than the share `tolerance`, or
/// until 2560 lie across the longer side. Cost: about 0.2 s for 16 spheres and the usual tolerance.
ConvergedMass converged_union_mass(std::span<const Sphere> spheres, double tolerance = 1e-4);

}  // namespace morula
