// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Motions of vertices from frame to frame, gentle and violent.
#pragma once

#include <dice.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/positions.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula::properties {

using oracle::Dice;
using Positions = std::vector<Vec3>;

struct Pose {
  std::string name;
  Positions positions;
};

/// A pose of the mesh, from its rest positions: one motion, sometimes two. Unused vertices stay.
Pose random_pose(const Mesh& rest, Dice& dice);

/// From one pose to another that differs only in some ranges of vertices, which are given.
Pose partial_pose(const Mesh& rest, const Positions& before, Dice& dice, std::vector<VertexRange>& moved);

// The motions that meshes are spoiled by, too. `used`: which vertices count; the others may hold anything.
void collapse(Positions& positions, const std::vector<bool>& used, Dice& dice);  ///< to a plane, a line or a point
void scale(Positions& positions, double factor);
void shift(Positions& positions, const Vec3& by);
void turn(Positions& positions, Dice& dice);
void turn_part(Positions& positions, const std::vector<bool>& used, Dice& dice);
void jitter(Positions& positions, const std::vector<bool>& used, Dice& dice, double share_of_size);
void snap(Positions& positions, const std::vector<bool>& used, Dice& dice);

}  // namespace morula::properties
