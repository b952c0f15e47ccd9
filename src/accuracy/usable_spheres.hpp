// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// First step of every measure: it checks the spheres, and puts a box around them.
#pragma once

#include <cmath>
#include <morula/geometry/box.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <stdexcept>
#include <string>

namespace morula::detail {

/// Throws std::invalid_argument, naming the first offender, unless all centers and radii are finite and of usable scale
/// and no radius is negative.
inline void require_usable(std::span<const Sphere> spheres, const char* measure) {
  for (std::size_t i = 0; i < spheres.size(); ++i)
    if (!is_finite(spheres[i].center) || !std::isfinite(spheres[i].radius) || spheres[i].radius < 0)
      throw std::invalid_argument(std::string(measure) + ": sphere " + std::to_string(i) +
                                  " is not finite or has a negative radius");
  for (std::size_t i = 0; i < spheres.size(); ++i)
    if (!has_usable_scale(spheres[i]))
      throw std::invalid_argument(std::string(measure) + ": sphere " + std::to_string(i) +
                                  " has a number beyond 1e30: scale mesh and spheres down");
}

/// Like require_usable(), and there must be at least one sphere.
inline void require_some_usable(std::span<const Sphere> spheres, const char* measure) {
  if (spheres.empty()) throw std::invalid_argument(std::string(measure) + ": there are no spheres");
  require_usable(spheres, measure);
}

inline Box box_of(std::span<const Sphere> spheres) {
  Box box;
  for (const Sphere& s : spheres) {
    box.add(s.center - Vec3{s.radius, s.radius, s.radius});
    box.add(s.center + Vec3{s.radius, s.radius, s.radius});
  }
  return box;
}

}  // namespace morula::detail
