// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "run/pose_trees.hpp"

namespace morula::study {

CoveredTree PoseTrees::build(const MeshView& posed, const BuildOptions& options) {
  return trees_.find(
      {mesh_hash(posed), options.method, options.quality, options.branching, options.depth, options.seed},
      [&] { return morula::build(posed, options, serial_workers()); });
}

}  // namespace morula::study
