// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres inside a link's shapes.
#pragma once

#include <morula/robot/fit.hpp>

namespace morula::robot {

/// At most `count` spheres, each inside one of the shapes and on the kept side of all planes, ordered by the volume
/// that they add. A mesh is taken component by component, repaired if vertices coincide or components face inwards;
/// components that are not closed have no inside, and the space in closed components that face the other way is
/// outside. Empty if no component is closed.
///
/// Numbers are decimals as in files. Each sphere, both by these numbers and by their floats, is proven to be inside by
/// the distance of its center from the surface and by the winding number; other spheres are left out. Throws FileError
/// for meshes that cannot be read.
std::vector<Sphere> inner_spheres(const std::filesystem::path& robot_file, std::span<const Shape> shapes,
                                  std::span<const ClipPlane> planes, std::size_t count, std::uint64_t seed,
                                  const StopToken& stop);

}  // namespace morula::robot
