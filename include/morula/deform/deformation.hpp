// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Parametric deformations of positions [barr1984]. They know nothing of trees.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace morula {

/// The axis a deformation works along; automatic is the longest side of the rest box, the first of equals.
enum class Axis { x, y, z, automatic };

/// Lengthens by `factor` about the centre; the cross-section shrinks by factor^−shrink (½ keeps the volume, 0 nothing).
struct Stretch {
  double factor = 2.0;  ///< > 0
  double shrink = 0.5;
  Axis axis = Axis::automatic;
};
/// Turns cross-sections by 0 at one end to `degrees` at the other.
struct Twist {
  double degrees = 180.0;
  Axis axis = Axis::automatic;
};
/// Rolls the axis into an arc of `degrees` about the middle of the body.
struct Bend {
  double degrees = 90.0;
  Axis axis = Axis::automatic;
};
/// Pushes a dent: points near `center` move by `push`, fading smoothly to nothing at distance `radius`.
/// Lengths are shares of the rest box's diagonal; center is relative to the box, 0…1 on each axis.
struct Poke {
  Vec3 center{0.5, 0.5, 1.0};
  Vec3 push{0.0, 0.0, -0.2};
  double radius = 0.25;
};
/// Smooth random displacement: a few seeded waves, at most `amplitude` × diagonal.
struct Noise {
  double amplitude = 0.05;
  double wavelength = 0.25;  ///< shortest, as a share of the diagonal
  std::uint64_t seed = 1;
};
/// Rigid rotation about the box centre.
struct Rotate {
  double degrees = 90.0;
  Axis axis = Axis::automatic;
};

using Deformation = std::variant<Stretch, Twist, Bend, Poke, Noise, Rotate>;

/// Applied one after the other, each to what the one before left; boxes and axes are those of the rest mesh.
using Deformations = std::vector<Deformation>;

/// Positions at parameter t in [0, 1], where 1 is the full amount. t = 0 returns the rest positions bit for bit.
///
/// Formulas and parameters: docs/deform.md. Unused vertices move too.
/// Throws std::invalid_argument for parameters out of range and for a bend so tight that the body would fold over itself.
std::vector<Vec3> deform(const Mesh& rest, const Deformations& deformations, double t);

/// t of each frame: out from 0 to 1 and back to 0 (first and last frame at rest, bit for bit), or only out.
std::vector<double> frame_parameters(std::size_t frame_count, bool and_back = true);

/// One word per deformation, such as "stretch 2" or "bend 90": for tables and file names.
std::string describe(const Deformation& deformation);

}  // namespace morula
