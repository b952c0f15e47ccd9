// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The evaluators of `morula bounds`, each compiled from its own text, with one signature.
#pragma once

#include <array>
#include <morula/update/skin_bounds.hpp>
#include <vector>

namespace morula::test {

/// Bounds in float. bones: the 3 x 4 matrices, rows first. morphs: one per target of the rest data; if empty, the
/// function without morph targets is called.
struct Evaluated {
  Spheref sphere;
  Boxf box;
};
using Evaluator = Evaluated (*)(const SkinBoundsData& data, std::uint32_t cluster, const std::vector<float>& bones,
                                const std::vector<float>& morphs);
Evaluated evaluated_in_c(const SkinBoundsData& data, std::uint32_t cluster, const std::vector<float>& bones,
                         const std::vector<float>& morphs);
Evaluated evaluated_in_glsl(const SkinBoundsData& data, std::uint32_t cluster, const std::vector<float>& bones,
                            const std::vector<float>& morphs);
Evaluated evaluated_in_wgsl(const SkinBoundsData& data, std::uint32_t cluster, const std::vector<float>& bones,
                            const std::vector<float>& morphs);

}  // namespace morula::test
