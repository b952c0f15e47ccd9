// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A tree's spheres at one moment, judged: every level set over the surface, every node over what it owns.
#pragma once

#include <morula/tree/cover.hpp>
#include <string>
#include <vector>

#include "record.hpp"
#include "shapes.hpp"

namespace morula::properties {

/// Positions as plain numbers, summed up in the judge's arithmetic where a motion is a sum.
std::vector<oracle::Point> points_of(std::span<const Vec3> positions);

/// Spheres as they are read: one per node.
std::vector<oracle::Ball> balls_of(std::span<const Sphere> spheres);

struct Moment {
  const Mesh& mesh;  ///< for its facets
  const SphereTree& tree;
  const Cover& cover;
  std::span<const oracle::Point> positions;
  std::span<const oracle::Ball> balls;
  std::span<const std::uint8_t> promised;  ///< per node: must it contain what it owns?
};

/// Both forms of the promise. `what`: of which frame, for messages; kinds are "uncovered" + suffix.
void judge(const Moment& moment, Dice& dice, Record& record, const oracle::Effort& effort = {},
           const std::string& suffix = "");

/// Nodes of level set j, found by walking parents: nodes of the level, and leaves above it.
std::vector<std::vector<std::uint32_t>> level_sets(const SphereTree& tree);

}  // namespace morula::properties
