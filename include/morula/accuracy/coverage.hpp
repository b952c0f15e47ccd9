// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Coverage: is any of the surface bare, how much, and how far out does it lie? Exact, not sampled (ALGORITHMS J.1).
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/parallel/workers.hpp>
#include <span>

namespace morula {

struct Coverage {
  /// The certificate: every corner of every power cell lies in the cell's sphere, within `tolerance`.
  bool covered = false;
  double bare_area = 0;       ///< share of the surface outside the union, closed form per power cell; 0 when covered
  double gap = 0;             ///< largest distance of a surface point from the union; 0 when covered
  double gap_upper = 0;       ///< proven upper bound of the gap: within relative 1e-6 of it
  double tolerance = 0;       ///< rounding allowance of the certificate, mesh units
  std::uint32_t worst_facet = 0;  ///< where the gap is
};

/// spheres: one level set, at least one sphere. Zero-area facets count for the certificate and the gap, not the area.
/// Rounding: corners are evaluated in double; tolerance = 2⁻⁴⁶ × the largest |coordinate| or radius.
/// Cost: O(F log n + pieces), the gap by branch and bound on the bare facets only.
Coverage coverage(const Mesh& mesh, std::span<const Sphere> spheres, Workers& workers = serial_workers());

}  // namespace morula
