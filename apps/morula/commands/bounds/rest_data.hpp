// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rest data of SkinBounds as JSON.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <morula/io/skin_bounds_file.hpp>
#include <morula/update/skin_bounds.hpp>
#include <span>
#include <string>

namespace morula::cli {

/// One JSON object; docs/reference/bounds.md describes it. parts: of a glTF file, else empty.
std::string bounds_text(const SkinBoundsData& data, const Mesh& mesh, std::span<const std::uint32_t> cluster_of_facet,
                        const GltfParts& parts);

}  // namespace morula::cli
