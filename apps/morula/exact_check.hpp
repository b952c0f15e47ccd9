// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The certificate during a motion, for the levels that are meant to carry one.
#pragma once

#include <morula/update/body.hpp>
#include <vector>

namespace morula::cli {

/// True when the rule `exact` serves some level.
bool any_exact(const Body& body);

/// certify() of the body's current spheres at these positions, over the levels that the rule `exact` serves. The others
/// promise nothing: morula measure says what they leave bare.
Certificate certify_exact_levels(const Body& body, const std::vector<Vec3>& positions, Workers& workers);

}  // namespace morula::cli
