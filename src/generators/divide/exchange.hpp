// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Exchange: nodes of one level pass parts of their regions to each other, across parents.
#pragma once

#include "generators/divide/node_fit.hpp"

namespace morula::detail {

/// The whole level is divided by power once more. A part may go to a node of another parent when that node's sphere and
/// every ancestor of it, the root aside, contain the part already: cover and wrapping hold at every moment, and no
/// ancestor changes. Then each sphere is fitted to the region that its node has after that. No node loses everything.
/// The result has the same bits for any number of workers.
void exchange(const FitInput& input, std::vector<BuildNode>& nodes, int rounds, Workers& workers);
/// The second half of exchange() alone: regions stay, and each sphere is fitted to its own region, in the presence of
/// all others.
void settle(const FitInput& input, std::vector<BuildNode>& nodes, int rounds, Workers& workers);

}  // namespace morula::detail
