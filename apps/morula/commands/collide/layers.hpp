// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// `morula collide --patches --thickness`: the parts where two surfaces, open or closed, are nearer to each other than a
// thickness, or where one is that near to itself, frame by frame.
#pragma once

#include <string>

#include "commands/collide/bodies.hpp"

namespace morula::cli {

struct LayerRun {
  SideFiles a, b;  // no mesh of b: a with itself
  double thickness = 0;
  std::string output;
  unsigned threads = 0;
  bool json = false;
};

/// Returns the exit code. Throws UsageError before anything is written.
int collide_layers(const LayerRun& run);

}  // namespace morula::cli
