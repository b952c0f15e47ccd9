// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// TreeVersion: a tree of the surface as a rebuilt body holds it.
#pragma once

#include <cstdint>
#include <morula/update/body.hpp>
#include <morula/update/looseness_estimate.hpp>
#include <vector>

#include "update/rebuild/strain_gauge.hpp"

namespace morula::detail {

/// A body, and its measures at the pose that it was made for; and its looseness at another pose, with the strain from
/// that one, if it was ever measured; else that strain is 0.
struct TreeVersion {
  /// The body is at the pose that it was made for, posed. levels: number of looseness figures to compute. estimator: of
  /// that mesh; it is at that pose afterwards.
  TreeVersion(Body its_body, const MeshView& posed, LoosenessEstimator& estimator, std::size_t levels);

  /// Ratio of the volume of its spheres to their volume at that pose: Σ r³ over the same, averaged over the levels that
  /// count. Cost: linear in the nodes.
  double growth() const noexcept;
  /// Volume of its leaves, in volumes of the object at that pose, as in looseness. The volume of their union is
  /// computed at the build, and is assumed to grow as the spheres do: Σ r³ alone would count shared volume many times.
  /// It is not in mesh units: if an object swells from pose to pose, a tree made for the larger one would seem to cover
  /// more at all others.
  // mutant known-union-at-build: `taken_up_at_build_ * growth` -> `growth`
  double taken_up() const noexcept { return taken_up_at_build_ * growth(); }

  Body body;
  StrainGauge gauge;
  std::vector<double> looseness_at_build;
  std::vector<double> looseness_elsewhere;
  double strain_elsewhere = 0;
  double strain_now = 0;         ///< strain from that pose to the last measured frame
  std::uint64_t seen_frame = 0;  ///< frame of its last update while another tree served
  double seen_strain = 0;        ///< strain_now in that frame

 private:
  std::vector<double> cubes_at_build_;  // Σ r³, per level
  double taken_up_at_build_ = 0;
};

}  // namespace morula::detail
