// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/mode_rows.hpp"

#include <algorithm>
#include <limits>
#include <morula/geometry/enclosing_sphere.hpp>

namespace morula::detail {
namespace {

// The center of the smallest sphere about the points; one of them if they are so large or so near each other that the
// search leaves the range of double.
Vec3 middle_of(std::span<const Vec3> points) {
  const Vec3 middle = enclosing_sphere(points).center;
  return is_finite(middle) ? middle : points.front();
}

double largest_of(std::span<const Vec3> points) {
  double largest = 0;
  for (const Vec3& p : points) largest = std::max(largest, max_norm(p));
  return largest;
}

// Largest distance from the middle, with the rounding of that distance. extent: of the values that the points were
// computed from.
double reach_about(const Vec3& middle, std::span<const Vec3> points, double extent) {
  double farthest = 0;
  for (const Vec3& p : points) farthest = std::max(farthest, safe_length(p - middle));
  return rounded_up_radius(farthest, extent + max_norm(middle));
}

// Inverse of a symmetric matrix that is positive definite.
std::array<Vec3, 3> inverse(const std::array<Vec3, 3>& m) {
  const Vec3 a = cross(m[1], m[2]), b = cross(m[2], m[0]), c = cross(m[0], m[1]);
  const double determinant = dot(m[0], a);
  return {a / determinant, b / determinant, c / determinant};
}

using Matrix = std::array<Vec3, 3>;  // columns of the matrix

// The inverse of m with `ridge` added to its diagonal.
Matrix ridged_inverse(Matrix m, double ridge) {
  for (int k = 0; k < 3; ++k) m[k][k] += ridge;
  return inverse(m);
}

Matrix product_of(const Matrix& a, const Matrix& b) {
  return {times(a, b[0]), times(a, b[1]), times(a, b[2])};
}

Matrix minus_transposed(const Matrix& m) {
  return {-Vec3{m[0].x, m[1].x, m[2].x}, -Vec3{m[0].y, m[1].y, m[2].y}, -Vec3{m[0].z, m[1].z, m[2].z}};
}

Vec3 mean_of(std::span<const Vec3> points) {
  Vec3 mean;
  for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
  return mean;
}

}  // namespace

double safe_length(const Vec3& v) {
  const double largest = max_norm(v);
  return largest > 0 ? largest * length(v / largest) : 0;
}

ModeRow mode_row(std::span<const Vec3> displacements) {
  const Vec3 shift = middle_of(displacements);
  return {shift, reach_about(shift, displacements, largest_of(displacements))};
}

LinearFit::LinearFit(std::vector<Vec3> places, double extent)
    : places_(std::move(places)), extent_(extent), scale_(largest_of(places_)) {
  if (scale_ == 0) return;  // all corners at the center: no gradient
  const Vec3 mean = mean_of(places_);
  for (const Vec3& y : places_) scaled_.push_back((y - mean) / scale_);
  const double share = 1 / static_cast<double>(places_.size());
  for (const Vec3& z : scaled_)
    for (int k = 0; k < 3; ++k) covariance_[k] += z * (z[k] * share);
}

// Ridge that damps directions in which the corners hardly spread. The fit of a field that is linear on the corners is
// exact in all directions, up to rounding; the fit of another field along a patch's slight thickness is meaningless.
double LinearFit::ridge(const Matrix& product, std::span<const Vec3> displacements, const Vec3& mean) const {
  constexpr double rounding = 1e-9, largest = 1e-2, distrust = 1e3;
  const Matrix plain = product_of(product, ridged_inverse(covariance_, rounding));
  double misfit = 0, variance = 0;
  for (std::size_t i = 0; i < scaled_.size(); ++i) {
    const Vec3 u = displacements[i] - mean;
    misfit += squared_length(u - times(plain, scaled_[i]));
    variance += squared_length(u);
  }
  const double spread = covariance_[0].x + covariance_[1].y + covariance_[2].z;
  return variance > 0 ? std::min(rounding + distrust * spread * (misfit / variance), largest) : rounding;
}

Matrix LinearFit::gradient(std::span<const Vec3> displacements) const {
  if (scaled_.empty()) return {};
  const double share = 1 / static_cast<double>(scaled_.size());
  const Vec3 mean = mean_of(displacements);
  Matrix product{};
  for (std::size_t i = 0; i < scaled_.size(); ++i)
    for (int k = 0; k < 3; ++k) product[k] += (displacements[i] - mean) * (scaled_[i][k] * share);

  // The ridge draws the field not to zero but to its own rotation, -G^T: so rotations are found completely, step by
  // step.
  constexpr int steps = 8;
  const double weight = ridge(product, displacements, mean);
  const Matrix solve = ridged_inverse(covariance_, weight);
  const Matrix drawn_to_zero = product_of(product, solve);
  Matrix columns = drawn_to_zero;
  for (int step = 0; step < steps; ++step) {
    const Matrix turn = product_of(minus_transposed(columns), solve);
    for (int k = 0; k < 3; ++k) columns[k] = drawn_to_zero[k] + weight * turn[k];
  }
  for (Vec3& column : columns) column = column / scale_;
  return is_finite(columns[0]) && is_finite(columns[1]) && is_finite(columns[2]) ? columns : Matrix{};
}

LinearModeRow LinearFit::row(std::span<Vec3> displacements) const {
  LinearModeRow row;
  row.gradient = gradient(displacements);
  // A cut corner's place is off by the rounding of the whole coordinate, which the gradient magnifies.
  const double extent = largest_of(displacements) + 3 * extent_ * largest_of(row.gradient);
  for (std::size_t i = 0; i < places_.size(); ++i) displacements[i] -= times(row.gradient, places_[i]);
  row.shift = middle_of(displacements);
  row.stray = reach_about(row.shift, displacements, extent);
  return row;
}

// The root of the largest eigenvalue of G = F^T F, which is m + 2 p f with m the mean eigenvalue, H = G - m,
// p^2 = |H|^2 / 6 and f in 1/2…1 the largest root of 4 f^3 - 3 f = det(H) / (2 p^3). That cubic is convex from 1/2 on,
// so Newton's steps from above come down to the root and never pass it: every one of them is a bound. As a function of
// the right side the root is concave, so the lowest of its tangents, at four values of f, is a bound to start from.
// Cubes of squares leave the range of double early, so very large and very small columns are scaled first.
double largest_stretch(const std::array<Vec3, 3>& columns) {
  std::array<Vec3, 3> h;
  for (int k = 0; k < 3; ++k)
    h[k] = {dot(columns[0], columns[k]), dot(columns[1], columns[k]), dot(columns[2], columns[k])};
  const double mean = (h[0].x + h[1].y + h[2].z) / 3;
  // mutant stretch-unscaled: `!(mean >= 0x1p-200 && mean <= 0x1p200)` -> `false`
  if (!(mean >= 0x1p-200 && mean <= 0x1p200)) {
    for (const Vec3& column : columns)
      if (!is_finite(column)) return std::numeric_limits<double>::infinity();
    const double largest = largest_of(columns);
    if (largest == 0) return 0;
    return largest * largest_stretch({columns[0] / largest, columns[1] / largest, columns[2] / largest});
  }
  for (int k = 0; k < 3; ++k) h[k][k] -= mean;
  const double p = std::sqrt((squared_length(h[0]) + squared_length(h[1]) + squared_length(h[2])) / 6);
  const double cube = p * p * p;
  double f = 1;
  if (cube > 0) {
    const double right = std::clamp(dot(h[0], cross(h[1], h[2])) / (2 * cube), -1.0, 1.0);
    const auto tangent = [&](double at) {
      return at + (right - (4 * at * at * at - 3 * at)) * (1 / (12 * at * at - 3));
    };
    f = std::min({tangent(1), tangent(0.85), tangent(0.7), tangent(0.56)});
    f -= (4 * f * f * f - 3 * f - right) / (12 * f * f - 3);
  }
  // The factor is far above the rounding: about fifty units in the last place.
  // mutant modal-stretch: `(mean + 2 * p * f) * (1 + 0x1p-40)` -> `(mean + 2 * p * f)`
  return std::sqrt(mean + 2 * p * f) * (1 + 0x1p-40);
}

}  // namespace morula::detail
