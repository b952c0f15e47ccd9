// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Optimizers [bradshaw2002]: better spheres for the same samples, before the region is divided among them.
#pragma once

#include "generators/reduce/reduce.hpp"

namespace morula::detail {

/// Replaces the spheres of a proposal by ones that contain the node's samples; with `none`, does nothing. The search
/// moves centers so that the worst protrusion bound of spheres that just hold their share of the samples becomes small;
/// balance lets it be larger by the share `excess`. The resulting radii are of equal power. Cost: recenter about a
/// hundred closest-point queries, simplex a few thousand, balance several times that.
void optimize(Proposal& proposal, const ReducerInput& node, Optimizer optimizer, double excess);

}  // namespace morula::detail
