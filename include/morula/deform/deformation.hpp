// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Parametric deformations of positions [barr1984], independent of trees.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace morula {

/// The axis of a deformation; automatic is the longest side of the rest box, the first of equals.
enum class Axis { x, y, z, automatic };

/// Stretches by `factor` about the center; the cross-section shrinks by factor^−shrink.
struct Stretch {
  double factor = 2.0;  ///< factor of the length, 0.001 … 1000
  double shrink = 0.5;  ///< exponent, −1 … 2: ½ keeps the volume, 0 the cross-section, −1 the proportions
  Axis axis = Axis::automatic;
};
/// Twists cross-sections about the middle line, by 0 at the lower end to `degrees` at the upper end.
struct Twist {
  double degrees = 180.0;  ///< angle, −36000 … 36000
  Axis axis = Axis::automatic;
};
/// Bends the axis into an arc of `degrees` about the middle of the body, toward the next axis (x → y → z → x).
struct Bend {
  double degrees = 90.0;  ///< angle, −360 … 360
  Axis axis = Axis::automatic;
};
/// Pushes a dent: points near `center` move by `push`, which fades smoothly to 0 at distance `radius`. Space does not
/// fold over while |push| < 0.58 radius. Lengths are shares of the rest box's diagonal; center is relative to the box,
/// 0…1 on each axis.
struct Poke {
  Vec3 center{0.5, 0.5, 1.0};  ///< relative to the box, each −10 … 10
  Vec3 push{0.0, 0.0, -0.15};  ///< shares of the diagonal, each −10 … 10
  double radius = 0.3;         ///< share of the diagonal, 0.001 … 10
};
/// Smooth random displacement: a few seeded waves, at most `amplitude` × diagonal. Space does not fold over while
/// amplitude < 0.35 wavelength.
struct Noise {
  double amplitude = 0.05;   ///< share of the diagonal, 0 … 1
  double wavelength = 0.25;  ///< length of the shortest wave, share of the diagonal, 0.01 … 10
  std::uint64_t seed = 1;
};
/// Rigid rotation about the box center.
struct Rotate {
  double degrees = 90.0;  ///< angle, −36000 … 36000
  Axis axis = Axis::automatic;
};

using Deformation = std::variant<Stretch, Twist, Bend, Poke, Noise, Rotate>;

/// Deformations in sequence: each is applied to the result of the previous one; boxes and axes are those of the rest
/// mesh.
using Deformations = std::vector<Deformation>;

/// Positions at parameter t in [0, 1], with the full amount at 1. t = 0 returns the rest positions bit for bit.
///
/// The same input gives the same bits on every machine. Unused vertices move too, except those that are not finite.
/// Formulas: docs/reference/cli.md#deform.
///
/// Throws std::invalid_argument for parameters out of range, for a twist or bend along an axis on which the mesh has no
/// extent, and for a bend so tight that the body would fold over itself (naming the largest valid angle). It throws at
/// any t if t = 1 would fail.
std::vector<Vec3> deform(const MeshView& rest, const Deformations& deformations, double t);

/// Parameter t of each frame: from 0 to 1 and back to 0, or only to 1. The first frame is exactly 0, and so is the last
/// one on the way back, with the same bits as on the way out. The middle frame is exactly 1; with an even number both
/// middle frames are, and one or two frames are all at rest.
std::vector<double> frame_parameters(std::size_t frame_count, bool and_back = true);

/// Name and amount of a deformation, such as "stretch 2", "bend 90" or "bend 90 z", for tables and file names.
std::string describe(const Deformation& deformation);

}  // namespace morula
