// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sampled fit: the figures by which cuRobo judges spheres, so that sets of both can be compared in one table.
#pragma once

#include <morula/query/signed_distance.hpp>
#include <optional>
#include <span>
#include <vector>

namespace morula {

/// Estimates from samples, without proof; what measure() says beside them is proven. Lengths are in mesh units.
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

}  // namespace morula
