// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies with hand-made trees and covers, so that updates are tested apart from builders; and ways to move them.
#pragma once

#include <functional>
#include <morula/tree/cover.hpp>
#include <morula/update/body.hpp>
#include <morula/update/modes.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula::test {

/// What a hand-made tree is like.
struct HandMade {
  int depth = 2;
  int branching = 8;
  std::size_t smallest_leaf = 2;  ///< nodes with no more patches are leaves, whatever their level
  bool cut_facets = false;        ///< some facets fall into two at an edge, some into three about a point inside
  double center_shift = 0.2;      ///< centers lie off the middle of their region by up to this share of its size
  std::uint64_t seed = 1;
};
/// Patches halved by their middles along the longest side until there are enough children; spheres contain their
/// regions.
CoveredTree hand_made_tree(const Mesh& mesh, const HandMade& how = {});

/// A tree of given spheres whose cover is not asked for: a root over leaves, whole facets dealt out in turn.
CoveredTree root_with_leaves(const Mesh& mesh, const Sphere& root, std::span<const Sphere> leaves);

struct Specimen {
  std::string name;
  Mesh mesh;
  CoveredTree model;
};
/// Ball, flat plate, bumpy ball with cut facets, soup of facets with unused vertices and facets without area, one
/// facet.
const std::vector<Specimen>& specimens();

/// The current ones, in mesh coordinates.
std::vector<Sphere> spheres_of(const Body& body);

struct Motion {
  std::string name;
  std::function<std::vector<Vec3>(const std::vector<Vec3>&)> apply;
};
/// Translation, rotations, stretch, shear, twist, bend, collapse to a plane, random noise of every vertex.
const std::vector<Motion>& motions();

/// Sine waves through the body, along axes and with wave numbers that differ from mode to mode. Vertices that no facet
/// uses get displacements like any other.
Modes smooth_modes(const Mesh& mesh, std::size_t mode_count);
/// Every vertex displaced by up to 1 on every axis, without rhyme or reason.
Modes rough_modes(const Mesh& mesh, std::size_t mode_count);
/// Nine modes; the coordinates M - 1, row after row, map every position by the matrix M.
Modes linear_modes(const Mesh& mesh);

std::vector<Vec3> translated(std::vector<Vec3> positions, const Vec3& offset);
std::vector<Vec3> scaled(std::vector<Vec3> positions, double factor);
/// About an axis through the origin, right-handed.
std::vector<Vec3> rotated(std::vector<Vec3> positions, const Vec3& axis, double degrees);
/// Every coordinate moved by up to `amplitude`.
std::vector<Vec3> noisy(std::vector<Vec3> positions, double amplitude, std::uint64_t seed);

}  // namespace morula::test
