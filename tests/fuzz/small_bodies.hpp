// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Small meshes out of bytes, and whether spheres contain them, judged with arithmetic of its own.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/tree/cover.hpp>
#include <string>

#include "fuzz.hpp"

namespace morula::fuzz {

/// At most 32 vertices and 48 facets, of any kind: coordinates on a lattice, so that much is flat, equal or in line; or
/// any numbers at all. Indices may be out of range, facets may be segments or points.
Mesh mesh_of(Bytes& in);
/// Coordinates so large or so small that their squares leave the range of double.
bool is_extreme(const std::vector<Vec3>& positions);
/// Bytes of which mesh_of makes this mesh, but for coordinates rounded to eighths, each at most 15.875.
std::string bytes_of(const Mesh& mesh);

/// A finding when a point of the facets (corners and a lattice between them) is in no sphere of a level, by more than
/// rounding explains. positions: where the mesh is now; spheres: one per node.
void require_cover(const Mesh& mesh, const std::vector<Vec3>& positions, const SphereTree& tree,
                   std::span<const Sphere> spheres);

}  // namespace morula::fuzz
