// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Figures of a link's spheres: the surface that they cover, proven, and how far they stick out.
#pragma once

#include <morula/robot/fit.hpp>

namespace morula::robot {

/// Sets LinkSpheres::figures of a link with a surface and spheres, except the mass. planes: the planes that cut it.
/// tolerance: the one that the spheres were fitted with; a bound of the uncovered distance that exceeds it by less than
/// it is loose by gives way to a proof for this length.
void measure_link(LinkSpheres& link, std::span<const ClipPlane> planes, double tolerance);

}  // namespace morula::robot
