// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The certificate during a motion, for the levels that are meant to carry one.
#pragma once

#include <morula/update/body.hpp>
#include <vector>

namespace morula::cli {

/// True when some level promises cover.
bool any_promises_cover(const Body& body);

/// certify() of the body's current spheres at these positions, over the levels whose rules promise cover.
Certificate certify_promised_levels(const Body& body, const std::vector<Vec3>& positions, Workers& workers);

}  // namespace morula::cli
