// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The tables of the study: what does not fit into curves.
#pragma once

#include "study/claims.hpp"
#include "study/figures.hpp"

namespace morula::cli {

/// Trees and void spheres, means and worst samples of every rule, the floor, mixes, cost, bodies.
/// of_bodies: the claims of each body, in their order.
std::vector<StudyTable> make_tables(const StudyPlan& plan, const StudyResult& result, const StudyCost& cost,
                                    const std::vector<std::vector<StudyClaim>>& of_bodies);

}  // namespace morula::cli
