// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Mode rows: bounds of how far a node's corners can stray from its center when a mode moves them. They are computed
// once per body.
#pragma once

#include <array>
#include <morula/geometry/vector.hpp>
#include <span>
#include <vector>

namespace morula::detail {

/// Row of one node and one mode. For every owned corner, u its displacement per unit of the coordinate: |u - shift| <=
/// stray.
struct ModeRow {
  Vec3 shift;
  double stray = 0;
};

/// With y the corner's place about the node's center at rest: |u - gradient y - shift| <= stray.
struct LinearModeRow {
  std::array<Vec3, 3> gradient{};  ///< columns of the gradient
  Vec3 shift;
  double stray = 0;
};

/// |v|, also for squares of components that leave the range of double.
double safe_length(const Vec3& v);

/// displacements: of the owned corners, at least one, finite. The shift is the center of the smallest sphere about
/// them, which makes the stray least; [james2004] takes a weighted mean.
ModeRow mode_row(std::span<const Vec3> displacements);

/// Finds linear fields near the displacements of a node's corners: by least squares. If the corners hardly determine a
/// direction, as across a patch that is nearly flat, the determined part is completed to a rotation.
class LinearFit {
 public:
  /// places: positions of the owned corners about the node's center at rest. extent: the largest |component| of the
  /// vectors whose differences they are.
  LinearFit(std::vector<Vec3> places, double extent);
  /// The call overwrites the displacements.
  LinearModeRow row(std::span<Vec3> displacements) const;

 private:
  std::array<Vec3, 3> gradient(std::span<const Vec3> displacements) const;
  double ridge(const std::array<Vec3, 3>& product, std::span<const Vec3> displacements, const Vec3& mean) const;

  std::vector<Vec3> places_;
  double extent_;
  std::vector<Vec3> scaled_;  // places about their mean, over the largest |component|; empty when all places are zero
  double scale_ = 0;          // the largest |component|
  std::array<Vec3, 3> covariance_{};  // covariance of the scaled places
};

/// The image of v under the matrix with these columns.
inline Vec3 times(const std::array<Vec3, 3>& columns, const Vec3& v) {
  return columns[0] * v.x + columns[1] * v.y + columns[2] * v.z;
}

/// At least the largest |F v| over unit vectors v, and at most 3 % more, for finite columns of F of any size; exact to
/// rounding for rotations. Infinite for other columns.
double largest_stretch(const std::array<Vec3, 3>& columns);

}  // namespace morula::detail
