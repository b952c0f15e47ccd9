// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres inside a link's shapes.
#pragma once

#include <morula/robot/fit.hpp>

namespace morula::robot {

/// At most `count` spheres, each inside one of the shapes and on the kept side of all planes, those first that add most
/// volume. A mesh is taken piece by piece, mended where vertices coincide or pieces face inwards; pieces that are not
/// closed have no inside, and what closed pieces enclose that face the other way is outside. None: nothing is closed.
///
/// In decimals that files hold. Of these numbers, and of what they become as floats, each is proven to be inside by the
/// distance of its center from the surface and by how often this winds round it; what is not is left out.
/// Throws FileError for meshes that cannot be read.
std::vector<Sphere> inner_spheres(const std::filesystem::path& robot_file, std::span<const Shape> shapes,
                                  std::span<const ClipPlane> planes, std::size_t count, std::uint64_t seed,
                                  const std::stop_token& stop);

}  // namespace morula::robot
