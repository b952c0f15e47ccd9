// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Balls inside a mesh, few of them, that fill most of it.
#pragma once

#include <morula/grains/clump.hpp>
#include <morula/query/signed_distance.hpp>

namespace morula::detail {

/// At most options.spheres balls, each inside the object by `allowance`, the one that adds most volume first.
std::vector<Sphere> inner_balls(const Mesh& mesh, const SignedDistance& object, const ClumpOptions& options,
                                double allowance, Workers& workers);

}  // namespace morula::detail
