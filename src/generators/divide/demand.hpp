// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Demand for small spheres over the surface, estimated from a draft tree.
#pragma once

#include "generators/divide/node_fit.hpp"

namespace morula::detail {

/// Method optimized with its fastest settings.
CoveredTree fast_tree(const FitInput& input, const BuildRun& run, Workers& workers);

/// Demand of surface points, computed from the leaves of such a tree. The result borrows nothing.
Demand demand_from(const FitInput& input, const CoveredTree& first, Workers& workers);

}  // namespace morula::detail
