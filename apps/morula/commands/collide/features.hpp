// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// `morula collide --self` and `--within`: facets of a body that cross each other, features that are near, frame by
// frame.
#pragma once

#include <optional>
#include <string>

#include "commands/collide/bodies.hpp"

namespace morula::cli {

struct FeatureRun {
  SideFiles a, b;  ///< b without a mesh: there is one body
  bool with_self = false;
  std::optional<double> within;  ///< none: facets that cross
  std::string output;
  unsigned threads = 0;
  bool json = false;
};

/// Returns the exit code. Throws UsageError before anything is written.
int collide_features(const FeatureRun& run);

}  // namespace morula::cli
