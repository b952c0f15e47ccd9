// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Clumps: a few overlapping spheres that stand for a grain in discrete element codes, with their mass and inertia.
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
/// "cover", "inner".
std::string_view name(ClumpKind kind);

struct ClumpOptions {
  ClumpKind kind = ClumpKind::cover;
  std::size_t spheres = 16;  ///< most of them; of a cover 0 where max_protrusion says it
  /// Of a cover: as few as needed to stick out by at most so much, above 0, mesh units.
  std::optional<double> max_protrusion{};
  double min_radius = 0;  ///< of a cover smaller ones are enlarged, inner ones are left out
  /// Above 0. A cover has as many spheres as it takes for none to be larger, inner ones are made smaller.
  std::optional<double> max_radius{};
  double density = 1000;                ///< mass over mesh units cubed
  Method method = Method::optimized;    ///< of a cover
  Quality quality = Quality::standard;  ///< of a cover
  std::size_t candidates = 2000;        ///< inner balls to choose from
  std::uint64_t seed = 1;
  std::stop_token stop{};
  std::function<void(const BuildProgress&)> progress{};
};

/// All lengths in mesh units, all of it in the mesh's axes.
struct Clump {
  ClumpKind kind = ClumpKind::cover;
  std::vector<Sphere> spheres;
  /// The promise of the kind, proven for the spheres as they are and for any other axes and floats that a file may use:
  /// radii carry what that can move.
  bool proven = false;
  double uncovered_distance = 0;  ///< of a cover, largest distance of a surface point from the spheres; 0 when proven
  double protrusion_max = 0;      ///< largest (r + φ(c))⁺: an upper bound of how far a sphere sticks out
  std::optional<double> object_volume;   ///< nothing: the mesh tells no inside from outside
  std::optional<double> missed_volume;   ///< of the object, in no sphere
  std::optional<double> outside_volume;  ///< of the spheres, outside the object
  UnionMass solid;                       ///< of the union of the spheres
  double solid_change = 0;               ///< what the last refinement changed of it, as a share
  double density = 0;
  /// About the center of mass along principal axes: x ↦ rows · (x − center). The axes are numbered so that they turn
  /// least away from the mesh's, which stay where the tensor is diagonal within what it is known to.
  RigidTransform principal;
  Vec3 principal_inertia{};  ///< along those axes, of density 1
  std::vector<std::string> notes;

  double mass() const { return density * solid.volume; }
};

/// Throws std::invalid_argument for options out of range, unusable meshes, and inner spheres of a mesh that tells no
/// inside from outside or has none that large; BuildStopped. Same bits for any number of workers.
Clump fit_clump(const MeshView& mesh, const ClumpOptions& options = {}, WorkersOrAll workers = {});

/// What a discrete element code reads. Text, numbers with the fewest digits that read back as the same bits.
struct ClumpFormat {
  std::string_view name;       ///< "kratos"
  std::string_view extension;  ///< the usual one, "" where there is none
  std::string_view program;    ///< whose it is
  std::string_view axes;       ///< which ones the numbers are in, in words
  std::string (*text)(const Clump& clump, std::string_view name);
};
std::span<const ClumpFormat> clump_formats();

}  // namespace morula
