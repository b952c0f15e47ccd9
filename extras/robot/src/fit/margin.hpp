// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A cover that stays on the kept side of clip planes: the surface within a margin of a plane need not be covered.
#pragma once

#include <morula/robot/fit.hpp>
#include <string>

namespace morula::robot {

/// The radius that a sphere of a fit gets in files, before it is rounded outward.
inline double padded_radius(double radius, const FitOptions& options) {
  return std::max(radius + options.padding, options.min_radius);
}

/// Throws std::invalid_argument if a part of the mesh is so near to a plane that every sphere around it reaches beyond
/// the plane. link: its name. mesh: what the margin leaves of it.
void require_margin(const std::string& link, const Mesh& mesh, std::span<const ClipPlane> planes,
                    const FitOptions& options);

/// Divides spheres of a fitted tree over the mesh until none reaches beyond a plane, as far as it can.
void keep_from_planes(const Mesh& mesh, std::span<const ClipPlane> planes, const FitOptions& options,
                      CoveredTree& model);

/// Whether the spheres of the leaves stay on the kept side when they are reduced, padded and rounded.
bool stays_from_planes(const Mesh& mesh, std::span<const Sphere> leaves, std::span<const ClipPlane> planes,
                       const FitOptions& options);

}  // namespace morula::robot
