// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Modes, skins and transforms of bones, as arguments and results.
#pragma once

#include <morula/update/modes.hpp>
#include <morula/update/skin.hpp>

#include "arrays.hpp"

namespace morula::python {

/// Modes, or an array (modes, vertices, 3).
Modes modes_of(nb::handle given, const char* name);
/// A Skin, or an array of weights (vertices, bones).
Skin skin_of(nb::handle given, const char* name);
/// (bones, 3, 4) or (bones, 4, 4): matrices that act on columns.
std::vector<AffineTransform> transforms_of(nb::handle given, const char* name);
/// (frames, bone_count, 3, 4) or (frames, bone_count, 4, 4): the transforms of frame after frame.
std::vector<AffineTransform> frames_of_transforms(nb::handle given, const char* name, std::size_t bone_count);
/// The transform of three rows of four numbers.
AffineTransform transform_of(const double* rows);
Copy<double, -1, 3, 4> own_transforms(std::span<const AffineTransform> transforms);

}  // namespace morula::python
