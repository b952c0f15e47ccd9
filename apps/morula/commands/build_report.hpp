// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Build report: the tree that `morula build` made, level by level.
#pragma once

#include <morula/accuracy/measure.hpp>
#include <morula/generators/build.hpp>
#include <morula/parallel/threads.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shared/report.hpp"

namespace morula::cli {

struct LevelFigures {
  std::size_t spheres = 0;  // number of spheres of the level set
  std::optional<double> looseness;
  std::optional<Protrusion> protrusion;
};
/// The figures of --report: one entry per level; figures are missing if the mesh has no inside. Throws BuildStopped.
std::vector<LevelFigures> measure_levels(const Mesh& mesh, const SphereTree& tree, const StopToken& stop,
                                         Workers& workers);

/// tree: as written. figures: empty, or one entry per level.
std::string build_table(const SphereTree& tree, const BuildReport& report, const std::vector<LevelFigures>& figures);
Json build_levels_json(const SphereTree& tree, const BuildReport& report, const std::vector<LevelFigures>& figures);

}  // namespace morula::cli
