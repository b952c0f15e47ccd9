// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Largest protrusion of a set's spheres, computed from the parts of the surface that they own, without an index of
// facets.
#pragma once

#include <span>

#include "generators/driver/top_down.hpp"
#include "generators/fit/object_shape.hpp"

namespace morula::detail {

/// Returns max of (r + φ(c))⁺ over the leaves, with φ as in SignedDistance::protrusion_bound. leaves: their regions are
/// the whole surface, and each lies in its sphere. The index of the shape computes φ if there is one, if the mesh is
/// not closed, or if a center is on the surface up to rounding. Cost: O(leaves · facets that near spheres own).
double largest_protrusion(const MeshView& mesh, const ObjectShape& shape, std::span<const BuildNode> leaves);

}  // namespace morula::detail
