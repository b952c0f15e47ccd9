// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// How far the corners that a node owns can stray from its centre when a mode moves them: settled once per body.
#pragma once

#include <array>
#include <morula/geometry/vector.hpp>
#include <span>
#include <vector>

namespace morula {

/// Of one node and one mode. For every owned corner, u its displacement per unit of the coordinate: |u - shift| <=
/// stray.
struct ModeRow {
  Vec3 shift;
  double stray = 0;
};

/// With y the corner's place about the node's centre at rest: |u - gradient y - shift| <= stray.
struct LinearModeRow {
  std::array<Vec3, 3> gradient{};  ///< its columns
  Vec3 shift;
  double stray = 0;
};

/// |v|, where squares of its components may leave the range of double.
double safe_length(const Vec3& v);

/// displacements: of the owned corners, at least one, finite. The shift is the middle of the smallest sphere about
/// them, which makes the stray least; [james2004] takes a weighted mean.
ModeRow mode_row(std::span<const Vec3> displacements);

/// Finds the linear field nearest to the displacements of a node's corners, in least squares.
class LinearFit {
 public:
  /// places: of the owned corners about the node's centre at rest. extent: the largest |component| of what they are
  /// differences of.
  LinearFit(std::vector<Vec3> places, double extent);
  /// `displacements` are used up. Where the corners do not span space, the gradient is zero across what they span.
  LinearModeRow row(std::span<Vec3> displacements) const;

 private:
  std::array<Vec3, 3> gradient(std::span<const Vec3> displacements) const;

  std::vector<Vec3> places_;
  Vec3 mean_;
  double extent_;
  double largest_ = 0;                        // |component| of a place
  std::array<Vec3, 3> covariance_inverse_{};  // of the places over largest_
};

/// The image of v under the matrix with these columns.
inline Vec3 times(const std::array<Vec3, 3>& columns, const Vec3& v) {
  return columns[0] * v.x + columns[1] * v.y + columns[2] * v.z;
}

/// At least the largest |F v| over unit vectors v, and at most 3 % more, for finite columns of F; exact to rounding for
/// rotations.
double largest_stretch(const std::array<Vec3, 3>& columns);

}  // namespace morula
