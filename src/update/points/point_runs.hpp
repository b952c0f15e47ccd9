// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The points of one leaf, for kernels: consecutive points are not looked up one by one.
#pragma once

#include <span>
#include <vector>

#include "update/points/kernels.hpp"

namespace morula::detail {

/// Appends points, ascending: whole groups of consecutive ones as runs, the rest to a list.
inline void append_runs(std::span<const std::uint32_t> owned, std::vector<PointRun>& runs,
                        std::vector<std::uint32_t>& points) {
  for (std::size_t i = 0; i < owned.size();) {
    std::size_t end = i + 1;
    while (end < owned.size() && owned[end] == owned[end - 1] + 1) ++end;
    const std::size_t in_run = (end - i) / points_per_group * points_per_group;
    if (in_run > 0) runs.push_back({owned[i], owned[i] + static_cast<std::uint32_t>(in_run)});
    const auto rest = owned.subspan(i + in_run, end - i - in_run);
    points.insert(points.end(), rest.begin(), rest.end());
    i = end;
  }
}

/// Appends the points that a leaf owns, with a list padded to whole groups.
inline void append_in_runs(std::span<const std::uint32_t> owned, std::vector<PointRun>& runs,
                           std::vector<std::uint32_t>& points) {
  append_runs(owned, runs, points);
  while (points.size() % points_per_group != 0) points.push_back(owned.back());
}

}  // namespace morula::detail
