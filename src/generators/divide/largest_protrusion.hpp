// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Largest protrusion of a set's spheres, by the parts of the surface that they own: without an index of facets.
#pragma once

#include <span>

#include "generators/driver/top_down.hpp"
#include "generators/fit/object_shape.hpp"

namespace morula::detail {

/// max of (r + φ(c))⁺ over the leaves, as SignedDistance::protrusion_bound has it. leaves: their regions are the whole
/// surface, and each lies in its sphere. A shape that has an index is asked, and so is that of a mesh which is not
/// closed, or of a center on the surface but for rounding. Cost: O(leaves · facets that spheres near by own).
double largest_protrusion(const MeshView& mesh, const ObjectShape& shape, std::span<const BuildNode> leaves);

}  // namespace morula::detail
