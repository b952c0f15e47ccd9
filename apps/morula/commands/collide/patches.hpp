// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// `morula collide --patches`: the connected parts of the overlap of two closed bodies, or of one with itself, frame by
// frame.
#pragma once

#include <string>

#include "commands/collide/bodies.hpp"

namespace morula::cli {

struct PatchRun {
  SideFiles a, b;  // no mesh of b: a with itself
  std::string rule, sph_origin;
  std::string output;
  std::string page;
  unsigned threads = 0;
  bool json = false;
};

/// Returns the exit code. Throws UsageError before anything is written.
int collide_patches(const PatchRun& run);

}  // namespace morula::cli
