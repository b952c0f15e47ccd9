// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trees of the poses of one motion, each built once.
#pragma once

#include <map>
#include <memory>
#include <morula/generators/build.hpp>
#include <mutex>
#include <optional>
#include <tuple>

namespace morula::study {

/// Builds on demand, on any threads. A tree depends on the posed mesh and the options alone, so cells that rebuild in
/// the same pose with the same options have the same tree, whichever tree they began with.
class PoseTrees {
 public:
  CoveredTree build(const MeshView& posed, const BuildOptions& options);

 private:
  struct Entry {
    std::mutex mutex;  // held while the tree is built, so that others wait for it
    std::optional<CoveredTree> tree;
  };
  using Key = std::tuple<std::uint64_t, Method, Quality, int, std::optional<int>, std::uint64_t>;

  std::mutex mutex_;  // of the map
  std::map<Key, std::shared_ptr<Entry>> entries_;
};

}  // namespace morula::study
