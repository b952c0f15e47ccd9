// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trees of the poses of one motion, each built once.
#pragma once

#include <cstdint>
#include <morula/generators/build.hpp>
#include <optional>
#include <tuple>

#include "run/made_once.hpp"

namespace morula::study {

/// Builds on demand, on any threads. A tree depends on the posed mesh and the options alone, so cells that rebuild in
/// the same pose with the same options have the same tree, whichever tree they began with.
class PoseTrees {
 public:
  CoveredTree build(const MeshView& posed, const BuildOptions& options);

 private:
  MadeOnce<std::tuple<std::uint64_t, Method, Quality, int, std::optional<int>, std::uint64_t>, CoveredTree> trees_;
};

}  // namespace morula::study
