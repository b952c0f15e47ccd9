// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Measured frames of a motion, as a table and as JSON.
#pragma once

#include <morula/accuracy/measure.hpp>
#include <string>
#include <toolbox/svg_plot.hpp>
#include <vector>

#include "shared/report.hpp"

namespace morula::cli {

struct MeasuredFrame {
  std::string name;  ///< name of the positions
  std::string tree;
  std::vector<LevelMeasure> levels;
};

/// The worst of each figure over the frames, per level. Frames may have trees of different depth.
std::vector<LevelMeasure> worst_of(const std::vector<MeasuredFrame>& frames);
/// A row per frame and level; of several frames also the worst.
std::string measure_table(const std::vector<MeasuredFrame>& frames, const std::vector<LevelMeasure>& worst,
                          bool with_protrusion);
/// A row per frame and level that has them: cuRobo's figures.
std::string sampled_table(const std::vector<MeasuredFrame>& frames);
/// Looseness, and uncovered area where there is any: over the frames, or of one frame over the levels.
toolbox::Plot measure_plot(const std::string& title, const std::vector<MeasuredFrame>& frames);
/// A line with the uncovered surface: the levels with it, and its amount.
std::string cover_sentence(const std::vector<LevelMeasure>& worst);
Json frames_json(const std::vector<MeasuredFrame>& frames);

}  // namespace morula::cli
