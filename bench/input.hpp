// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The meshes that scenarios run on.
#pragma once

#include <string>
#include <vector>

#include "scenario.hpp"

namespace morula::bench {

/// wanted: files, or sample bodies as NAME or NAME:RESOLUTION. Empty: limb and blob, and bunny00 where the corpus is.
/// Throws FileError or std::invalid_argument, before any work, for what cannot be had.
std::vector<Input> inputs(const std::vector<std::string>& wanted);

}  // namespace morula::bench
