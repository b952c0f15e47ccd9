// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The update rules once more, plain and slow, in double and in mesh coordinates, straight from the paper's equations.
#pragma once

#include <morula/update/body.hpp>
#include <span>
#include <vector>

namespace morula::test {

/// Spheres of all nodes after an update, by rules other than exact. Nodes on exact levels are taken from the body's
/// spheres at rest and now: their centres are not the paper's business.
struct Reference {
  std::vector<Sphere> rest, now;
};
Reference reference_update(const Mesh& mesh, const Built& built, const UpdateOptions& options,
                           const std::vector<Vec3>& positions, std::span<const Sphere> body_rest,
                           std::span<const Sphere> body_now);

/// Radius of the smallest sphere about `center` that contains the node's region.
double owned_reach(const Built& built, std::uint32_t node, const Vec3& center, const std::vector<Vec3>& positions);

}  // namespace morula::test
