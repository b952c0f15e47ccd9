// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// One's own entries of a plan: their checks, and what the cache keeps of them.
#pragma once

#include <morula/study/plan.hpp>

#include "json.hpp"

namespace morula::study {

/// Throws std::invalid_argument for names that are taken, given twice or no names of files, and for missing functions.
void check_own(const Plan& plan);

/// Throws std::invalid_argument, which names the generator, unless the tree and its cover are sound.
CoveredTree make_own_tree(const OwnGenerator& generator, const Mesh& mesh);
/// Throws std::invalid_argument, which names the rule, for a tree with faults or with another number of nodes.
void require_sound(const OwnRule& rule, const SphereTree& tree, std::size_t nodes);

/// False if an entry without a version decides the figures of the cell.
bool has_version(const Plan& plan, const Source& source, const FollowRule& rule);
/// Names and versions.
Json metrics_json(const Plan& plan);

}  // namespace morula::study
