// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The pictures of the study: Fig. 1, and figures as plots.
#pragma once

#include "study/files.hpp"
#include "svg/plot.hpp"

namespace morula::cli {

/// Fig. 1 of the paper on the first body: the poses, and Approach 2 on the last two levels.
std::vector<StudyPicture> make_pictures(const StudyPlan& plan, const StudyResult& result);

/// A figure and its companions, one panel each.
Plot plot_of(const std::vector<const StudyFigure*>& group);

}  // namespace morula::cli
