// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres that cover within a tolerance, made larger where that costs nothing.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <vector>

namespace morula::robot {

/// Increases the radii of spheres that stay inside the mesh thereby, up to the largest radius: their
/// outside volume does not grow, also when files round them outward. Other spheres stay unchanged, and all of them if
/// the mesh is not closed and oriented, because then it has no inside.
void grow_inside(const Mesh& mesh, std::vector<Sphere>& spheres, double most_radius);

}  // namespace morula::robot
