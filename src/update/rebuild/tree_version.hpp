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

/// A body, and what is known of it at the pose that it was made for. And how loose it was at another pose, at a strain
/// from that one, where it was ever measured; else that strain is 0.
struct TreeVersion {
  /// The body is at the pose that it was made for, posed. levels: figures of looseness wanted. estimator: of that mesh,
  /// and at that pose afterwards.
  TreeVersion(Body its_body, const MeshView& posed, LoosenessEstimator& estimator, std::size_t levels);

  /// How many times what they took up at that pose its spheres take up now: Σ r³ over the same, in the mean of the
  /// levels that count. Cost: linear in the nodes.
  double growth() const noexcept;
  /// What its leaves take up now, in volumes of the object at that pose, as looseness is. Their union is known there,
  /// and is taken to grow as the spheres do: Σ r³ alone would count many times what they share. Not in mesh units:
  /// where an object swells from pose to pose, a tree made for the larger one would seem to take up more at all
  /// others.
  // mutant known-union-at-build: `taken_up_at_build_ * growth` -> `growth`
  double taken_up() const noexcept { return taken_up_at_build_ * growth(); }

  Body body;
  StrainGauge gauge;
  std::vector<double> looseness_at_build;
  std::vector<double> looseness_elsewhere;
  double strain_elsewhere = 0;
  double strain_now = 0;         ///< from that pose to the frame's, when it was last asked for
  std::uint64_t seen_frame = 0;  ///< when it was last updated beside another that served
  double seen_strain = 0;        ///< strain_now then

 private:
  std::vector<double> cubes_at_build_;  // Σ r³, per level
  double taken_up_at_build_ = 0;
};

}  // namespace morula::detail
