// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The look of a curve: one for each rule and each generator, in all figures and in the page.
#pragma once

#include <morula/study/figures.hpp>
#include <toolbox/svg_plot.hpp>

namespace morula::study {

/// A line without points. A figure that compares generators has their colors and markers, with the dashes of the rule.
/// Other names get a look by their letters.
toolbox::PlotLine style_of(const Series& series);

}  // namespace morula::study
