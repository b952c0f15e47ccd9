// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Figures of the trees of one body, each measured once.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <morula/study/cell.hpp>
#include <mutex>
#include <optional>
#include <tuple>
#include <vector>

namespace morula::study {

/// Measures on demand, on any threads. Figures of levels depend on the posed mesh, the tree and what is measured alone.
/// So one tree in one pose has the same figures in all cells: at rest for each motion, and for `rebuilt` and `exact` as
/// long as nothing is rebuilt.
class MeasuredTrees {
 public:
  /// Hash of the posed mesh, hash of the tree, and what is measured.
  using Key = std::tuple<std::uint64_t, std::uint64_t, unsigned>;
  using Levels = std::vector<LevelFigures>;

  /// The figures for the key; `measure` makes them the first time.
  Levels find(const Key& key, const std::function<Levels()>& measure);

 private:
  struct Entry {
    std::mutex mutex;  // held while the tree is measured, so that others wait for it
    std::optional<Levels> levels;
  };

  std::mutex mutex_;  // of the map
  std::map<Key, std::shared_ptr<Entry>> entries_;
};

}  // namespace morula::study
