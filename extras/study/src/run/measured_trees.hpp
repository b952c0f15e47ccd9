// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Figures of the trees of one body, each measured once.
#pragma once

#include <cstdint>
#include <morula/study/cell.hpp>
#include <tuple>
#include <vector>

#include "run/made_once.hpp"

namespace morula::study {

/// Measures on demand, on any threads. Figures of levels depend on the posed mesh, the tree and what is measured alone.
/// So one tree in one pose has the same figures in all cells: at rest for each motion, and for `rebuilt` and `exact` as
/// long as nothing is rebuilt. The key: hash of the posed mesh, hash of the tree, and what is measured.
class MeasuredTrees : public MadeOnce<std::tuple<std::uint64_t, std::uint64_t, unsigned>, std::vector<LevelFigures>> {
 public:
  using Key = std::tuple<std::uint64_t, std::uint64_t, unsigned>;
  using Levels = std::vector<LevelFigures>;
};

}  // namespace morula::study
