// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies on which guarantees break first: few facets, corners on lattices, cuts that fall on edges and on each other.
#pragma once

#include <support/meshes.hpp>

namespace morula::test {

/// Cubes, octahedra, prisms, plates, subdivided and doubled facets, facets without area; samples at the lowest
/// resolutions. At most some 300 facets each; all pass require_usable.
const std::vector<NamedMesh>& aligned_bodies();

}  // namespace morula::test
