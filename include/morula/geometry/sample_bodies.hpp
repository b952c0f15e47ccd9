// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Closed bodies made by formula, for trying things out: no files needed.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <span>
#include <string_view>

namespace morula {

/// The names that sample_body knows: bar capsule limb torus blob plate two.
std::span<const std::string_view> sample_body_names();

/// A closed, oriented, manifold mesh (`two` has two components), deterministic to the bit.
///
/// name: bar (4:1:1 box), capsule, limb (bent, tapered, organic), torus, blob (smooth lobes), plate (thin box), two.
/// resolution: edges around or along the body, at least 3; 48 gives a few thousand facets.
/// Throws std::invalid_argument for an unknown name (listing the known ones) or a resolution outside 3…4096.
Mesh sample_body(std::string_view name, int resolution = 48);

}  // namespace morula
