// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Generated closed meshes for first experiments, without files.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <span>
#include <string_view>

namespace morula {

/// The names that sample_body accepts, in the order below.
std::span<const std::string_view> sample_body_names();

/// A closed, oriented, manifold mesh (`two` has two components), deterministic to the bit.
///
///   bar      box, 4 × 1 × 1
///   capsule  tube with round ends, 3 long, 1 thick
///   limb     an arm: bent, tapered, with muscles and round ends, about 5 long
///   torus    ring of radius 1, its tube of radius 0.35
///   blob     a ball with six smooth lobes
///   plate    thin box, 4 × 0.1 × 2
///   two      two links of a chain that do not touch: two components
///   tool     a probe: a handle, a thin shaft and a narrow round tip, 3 long
///   hand     a palm, four fingers and a thumb, 4 long
///   vessel   a blood vessel: slender, in an S, with a bulge
/// Bodies lie along x, about the origin.
/// resolution: edges around or along the body, 3…4096; 48 gives 2,700 to 5,800 facets, and their number grows with its
/// square.
/// Throws std::invalid_argument for an unknown name (listing the known names) or a resolution out of range.
Mesh sample_body(std::string_view name, int resolution = 48);

}  // namespace morula
