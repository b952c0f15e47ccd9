// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Coverage: is any of the surface bare, how much, and how far out does it lie? Exact, not sampled.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/parallel/workers.hpp>
#include <span>

namespace morula {

struct [[nodiscard]] Coverage {
  /// The certificate: every corner of every power cell lies in the cell's sphere, within `tolerance`. Where rounding
  /// misplaced a cell, smaller pieces of it are held against whichever sphere contains them.
  bool covered = false;
  double uncovered_area = 0;  ///< share of the surface outside the union, closed form per power cell; 0 when covered
  double uncovered_distance = 0;  ///< largest distance of a surface point from the union, attained; 0 when covered
  double uncovered_distance_upper = 0;  ///< proven upper bound of the gap: within relative 1e-6 and twice the tolerance
                                        ///< of it; 0 when covered
  double tolerance = 0;           ///< rounding allowance of the certificate, mesh units
  std::uint32_t worst_facet = 0;  ///< where the gap is; among equals the lowest
};

/// spheres: one level set, at least one sphere. Zero-area facets count for the certificate and the gap, not the area.
/// Rounding: corners are evaluated in double; tolerance = 2⁻⁴⁶ × the largest |coordinate| or radius. "Covered" means
/// covered by spheres whose radii are larger by the tolerance.
/// Same bits for any number of workers. Throws std::invalid_argument for bad spheres.
/// Cost: O(F log n + pieces), the gap by branch and bound on the bare pieces only (at most 2²⁰ steps; should they run
/// out, uncovered_distance_upper is still proven).
Coverage coverage(const MeshView& mesh, std::span<const Sphere> spheres, Workers& workers = serial_workers());

}  // namespace morula
