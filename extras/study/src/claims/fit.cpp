// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "claims/fit.hpp"

#include <cmath>
#include <vector>

namespace morula::study {
namespace {

struct LineFit {
  double offset = 0, slope = 0, residual = 0;
};

LineFit fit_line(std::span<const double> x, std::span<const double> y) {
  const auto n = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < x.size(); ++i) mean_x += x[i] / n, mean_y += y[i] / n;
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  LineFit fit;
  fit.slope = xx > 0 ? xy / xx : 0;
  fit.offset = mean_y - fit.slope * mean_x;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double off = y[i] - fit.offset - fit.slope * x[i];
    fit.residual += off * off;
  }
  return fit;
}

/// For a given b the rest is a straight line in (exp(b t) − 1) / b, which is t itself for b = 0.
LineFit fit_with(double b, std::span<const double> t, std::span<const double> e, std::vector<double>& x) {
  for (std::size_t i = 0; i < t.size(); ++i) x[i] = b == 0 ? t[i] : std::expm1(b * t[i]) / b;
  return fit_line(x, e);
}

/// The residual of e after a fit by a parabola in t: after a line, and after the part that t² adds to it.
double parabola_residual(std::span<const double> t, std::span<const double> e) {
  std::vector<double> square(t.size()), bend(t.size()), rest(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) square[i] = t[i] * t[i];
  const LineFit of_square = fit_line(t, square);
  const LineFit of_e = fit_line(t, e);
  double bb = 0, be = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    bend[i] = square[i] - of_square.offset - of_square.slope * t[i];
    rest[i] = e[i] - of_e.offset - of_e.slope * t[i];
    bb += bend[i] * bend[i];
    be += bend[i] * rest[i];
  }
  return bb > 0 ? of_e.residual - be * be / bb : of_e.residual;
}

}  // namespace

ExponentialFit fit_exponential(std::span<const double> t, std::span<const double> e) {
  std::vector<double> x(t.size());
  const LineFit line = fit_with(0, t, e, x);
  // The search is on a grid, because the residual need not have a single minimum.
  constexpr int steps = 2000;
  constexpr double widest = 10;
  LineFit best = line;
  double best_b = 0;
  for (int i = -steps; i <= steps; ++i) {
    const double b = widest * i / steps;
    const LineFit fit = fit_with(b, t, e, x);
    if (fit.residual < best.residual) best = fit, best_b = b;
  }
  double mean = 0, variance = 0;
  for (const double value : e) mean += value / static_cast<double>(e.size());
  for (const double value : e) variance += (value - mean) * (value - mean);
  ExponentialFit fit;
  fit.b = best_b;
  fit.a = best_b == 0 ? best.slope : best.slope / best_b;
  fit.c = best_b == 0 ? best.offset : best.offset - fit.a;
  fit.r2 = variance > 0 ? 1 - best.residual / variance : 1;
  fit.r2_line = variance > 0 ? 1 - line.residual / variance : 1;
  fit.r2_parabola = variance > 0 ? 1 - parabola_residual(t, e) / variance : 1;
  return fit;
}

}  // namespace morula::study
