// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Source texts that compute spheres and boxes of clusters from the rest data of `morula bounds`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace morula::cli {

/// "c", "glsl", "wgsl".
std::vector<std::string> evaluator_names();
/// The text for one of these names.
std::string_view evaluator_text(std::string_view name);

}  // namespace morula::cli
