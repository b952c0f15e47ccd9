// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Wrapping: the last step of a build, after which every sphere is proven to contain its region.
#pragma once

#include <morula/tree/cover.hpp>

namespace morula::detail {

/// Grows every sphere that is not proven to contain its region, about its own center, to the radius that
/// rounded_up_radius gives it. Afterwards certify() holds at rest, and its verdict is true of the real numbers.
///
/// model: its cover is of this mesh, whose scale is usable. A sphere with the proof stays as it is, bit for bit;
/// spheres that rounded_up_radius made for the same corners have it, in whatever order their products were added. The
/// result lists the growth of each level. Cost: O(levels × corners).
LevelGrowth wrap_regions(const MeshView& mesh, CoveredTree& model, Workers& workers);

}  // namespace morula::detail
