// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "run/measured_trees.hpp"

namespace morula::study {

MeasuredTrees::Levels MeasuredTrees::find(const Key& key, const std::function<Levels()>& measure) {
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<Entry>& kept = entries_[key];
    if (!kept) kept = std::make_shared<Entry>();
    entry = kept;
  }
  const std::lock_guard lock(entry->mutex);
  if (!entry->levels) entry->levels = measure();
  return *entry->levels;
}

}  // namespace morula::study
