// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "run/pose_trees.hpp"

namespace morula::study {

CoveredTree PoseTrees::build(const MeshView& posed, const BuildOptions& options) {
  const Key key{mesh_hash(posed), options.method, options.quality, options.branching, options.depth, options.seed};
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<Entry>& kept = entries_[key];
    if (!kept) kept = std::make_shared<Entry>();
    entry = kept;
  }
  const std::lock_guard lock(entry->mutex);
  if (!entry->tree) entry->tree = morula::build(posed, options, serial_workers());
  return *entry->tree;
}

}  // namespace morula::study
