// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Clumps: a few overlapping spheres that represent a grain in discrete element codes, with their mass and inertia.
#pragma once

#include <functional>
#include <morula/accuracy/measure.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <string>
#include <vector>

namespace morula {

enum class ClumpKind {
  cover,  ///< the spheres contain the surface: no part of the grain is outside
  inner,  ///< every sphere is inside the grain: no part of a sphere is outside
};
/// The name: "cover", "inner".
std::string_view name(ClumpKind kind);

struct ClumpOptions {
  ClumpKind kind = ClumpKind::cover;
  std::size_t spheres = 16;  ///< largest number of spheres; 0 for a cover that max_protrusion limits
  /// Largest protrusion of a cover, above 0, mesh units; the cover then uses as few spheres as it can.
  std::optional<double> max_protrusion{};
  /// Distance within which a cover has to cover, 0 or more, mesh units; above 0 only for the method `optimized`. Its
  /// spheres then leave surface uncovered on purpose and are fitted for less outside volume.
  double tolerance = 0;
  /// Smallest radius, mesh units; smaller spheres of a cover are enlarged, smaller inner spheres are dropped.
  double min_radius = 0;
  /// Largest radius, above 0, mesh units. A cover uses as many spheres as this requires; inner spheres are reduced to
  /// it.
  std::optional<double> max_radius{};
  double density = 1000;                ///< mass per mesh unit³
  Method method = Method::optimized;    ///< method of a cover
  Quality quality = Quality::standard;  ///< quality of a cover
  std::size_t candidates = 2000;        ///< number of inner balls to select from
  std::uint64_t seed = 1;
  StopToken stop{};
  std::function<void(const BuildProgress&)> progress{};
};

/// A clump: all lengths in mesh units, all coordinates in the mesh's axes.
struct Clump {
  ClumpKind kind = ClumpKind::cover;
  std::vector<Sphere> spheres;
  /// True if the guarantee of the kind is proven, with a tolerance that of covering within it, for the spheres as they
  /// are and for any other axes and floats that a file may use: radii include the possible rounding.
  bool proven = false;
  /// For a cover: proven distance from the spheres, rounded in any way, within which every point of the surface lies,
  /// mesh units; 0 if they cover.
  double within = 0;
  /// For a cover: largest distance of a surface point from the spheres without their allowance for rounding, mesh
  /// units; 0 if they cover.
  double uncovered_distance = 0;
  double protrusion_max = 0;  ///< largest (r + φ(c))⁺: an upper bound of the protrusion of a sphere, mesh units
  std::optional<double> object_volume;   ///< volume of the object, mesh units³; no value if the mesh has no inside
  std::optional<double> missed_volume;   ///< volume of the object outside all spheres, mesh units³
  std::optional<double> outside_volume;  ///< volume of the spheres outside the object, mesh units³
  UnionMass solid;                       ///< mass properties of the union of the spheres
  double solid_change = 0;               ///< relative change of these at the last refinement
  double density = 0;
  /// Transform to principal axes about the center of mass: x ↦ rows · (x − center). The axes are numbered for the least
  /// rotation away from the mesh's axes, which are kept if the tensor is diagonal within its accuracy.
  RigidTransform principal;
  Vec3 principal_inertia{};  ///< inertia about those axes, at density 1
  std::vector<std::string> notes;

  double mass() const { return density * solid.volume; }
};

/// Fits a clump to a mesh. Throws std::invalid_argument for options out of range and unusable meshes, and for inner
/// spheres of a mesh that has no inside or no balls of this size; throws BuildStopped. The result has the same bits for
/// any number of workers.
Clump fit_clump(const MeshView& mesh, const ClumpOptions& options = {}, WorkersOrAll workers = {});

/// An input format of a discrete element code: text, numbers with the fewest digits that read back as the same bits.
struct ClumpFormat {
  std::string_view name;       ///< name, such as "kratos"
  std::string_view extension;  ///< usual extension; "" if there is none
  std::string_view program;    ///< program that defines the format
  std::string_view axes;       ///< axes of the numbers, as text
  std::string (*text)(const Clump& clump, std::string_view name);
};
std::span<const ClumpFormat> clump_formats();

}  // namespace morula
