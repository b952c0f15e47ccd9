// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pictures of the study: Fig. 1, and figures as plots.
#pragma once

#include <morula/study/study.hpp>
#include <toolbox/svg_plot.hpp>

namespace morula::study {

/// Fig. 1 of the paper on the first body: the poses, and Approach 2 on the last two levels.
std::vector<Picture> make_pictures(const Plan& plan, const Result& result);

/// A figure and its companions, one panel each.
toolbox::Plot plot_of(std::span<const Figure> group);

}  // namespace morula::study
