// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The depth of trees that replace or accompany another one.
#pragma once

#include <algorithm>
#include <morula/tree/cover.hpp>

namespace morula::detail {

/// The depth of the home tree. A tree that is one sphere, because at rest no part of the body is smaller, counts with
/// the depth in its report: in other poses the parts pay.
inline int depth_of_rebuilds(const CoveredTree& home) {
  const int depth = static_cast<int>(home.tree.level_count()) - 1;
  return depth > 0 ? depth : std::min(static_cast<int>(home.report.depth), max_depth);
}

}  // namespace morula::detail
