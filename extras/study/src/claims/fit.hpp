// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Fit of a curve that grows.
#pragma once

#include <span>

namespace morula::study {

/// e(t) = c + a·exp(b t) over t in [0, 1], by least squares: b > 0 grows ever faster, b < 0 ever slower.
struct ExponentialFit {
  double a = 0, b = 0, c = 0;
  double r2 = 0;       // share of the variance that the exponential explains
  double r2_line = 0;  // and a straight line
  double r2_parabola = 0;
};
ExponentialFit fit_exponential(std::span<const double> t, std::span<const double> e);

}  // namespace morula::study
