// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Random points and transforms.
#pragma once

#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/rigid_transform.hpp>

namespace morula::test {

/// Within a cube of edge 2 reach around the origin.
Vec3 random_point(Random& random, double reach);
/// The same in whole numbers.
Vec3 random_whole(Random& random, double reach);
/// Any rotation, and a random_point() from `about`.
RigidTransform random_transform(Random& random, double reach, const Vec3& about = {});

}  // namespace morula::test
