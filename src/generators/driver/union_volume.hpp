// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Union volume: how much space a set of spheres takes in outside the object, overlaps once.
#pragma once

#include <span>

#include "generators/fit/object_lines.hpp"

namespace morula::detail {

/// Along lines of all three axes, on which the chords of all spheres are merged: exact along each line. Mesh units
/// cubed. Cost: O(lines × spheres over each).
double union_outside(const ObjectLines& lines, std::span<const Sphere> spheres);

}  // namespace morula::detail
