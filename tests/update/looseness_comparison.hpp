// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Estimates of looseness held against voxels.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <string>

namespace morula::test {

/// Builds a tree and expects every level's estimate within 15 % of the voxel count, up to a looseness of 1.5, at rest
/// and in six deformed poses. The mesh must tell inside from outside.
void expect_estimates_near_voxels(const std::string& name, const Mesh& mesh);

}  // namespace morula::test
