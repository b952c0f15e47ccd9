// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Nodes of one level hand parts of their regions to each other, across parents.
#pragma once

#include "generators/divide/node_fit.hpp"

namespace morula::detail {

/// Divides the whole level by power once more. A part may go to a node of another parent when that node's sphere and
/// every ancestor of it, the root aside, contain the part already: cover and wrapping hold at every moment, and no
/// ancestor changes. Then each sphere is fitted to what it owns now. No node loses everything.
/// Same bits for any number of workers.
void exchange(const FitInput& input, std::vector<BuildNode>& nodes, int rounds, Workers& workers);
/// The second half of it alone: nothing changes hands, each sphere is fitted to what it owns, beside those of all
/// others.
void settle(const FitInput& input, std::vector<BuildNode>& nodes, int rounds, Workers& workers);

}  // namespace morula::detail
