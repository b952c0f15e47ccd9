// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <morula/geometry/mesh.hpp>

namespace morula::test {

/// Is a point inside a closed mesh, by the parity of crossings along a ray? No distance is asked. The direction is odd,
/// so that the ray meets no edge of the meshes that tests have.
bool parity_inside(const Mesh& mesh, const Vec3& point);

}  // namespace morula::test
