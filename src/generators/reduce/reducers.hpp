// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The reducers: each proposes spheres for a node. A reducer may return nothing; none fails.
#pragma once

#include "generators/reduce/reduce.hpp"

namespace morula::detail {

Proposals propose_grid(const ReducerInput& node);
Proposals propose_hubbard(const ReducerInput& node);
Proposals propose_spawn(const ReducerInput& node);
/// Reduces one adaptive medial axis of the node in each of these ways: merge, burst, expand.
Proposals propose_medial(const ReducerInput& node, std::span<const Reduction> reductions);

/// Combines all of them, in this order; each proposal is optimized by the options. Nodes without any proposal get their
/// own sphere, marked `no_proposal`: the fit halves it.
Reducer combined_reducer(std::vector<Reduction> reductions, const BuildOptions& options);

}  // namespace morula::detail
