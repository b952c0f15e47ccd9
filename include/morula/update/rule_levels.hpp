// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rules by level: which one a level follows, in words, and the certificate of the levels that are meant to carry one.
#pragma once

#include <morula/tree/nesting.hpp>
#include <morula/update/body.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula {

/// The rule of a level: the last one serves all deeper levels.
Rule rule_of_level(std::span<const Rule> rules, std::size_t level);
/// "exact", or "exact on levels 0-1, approach2 on levels 2-3" when levels differ.
std::string describe_rules(std::span<const Rule> rules, std::size_t level_count);

/// True when some level promises cover.
bool any_promises_cover(const Body& body);

/// certify() of the body's current spheres at these positions, over the levels whose rules promise cover.
Certificate certify_promised_levels(const Body& body, const std::vector<Vec3>& positions,
                                    Workers& workers = serial_workers());

/// True when the nodes of some inner level promise to contain their children's spheres: those of the rule `wrapped`.
bool any_promises_nesting(const Body& body);

/// certify_nesting() of the body's current spheres below the nodes that promise to contain their children's, both about
/// its origin and in mesh coordinates.
Nesting certify_promised_nesting(const Body& body);

}  // namespace morula
