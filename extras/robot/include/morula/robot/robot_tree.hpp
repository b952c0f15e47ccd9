// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// One tree over all links of a robot, for queries that take it as one body.
#pragma once

#include <morula/robot/fit.hpp>
#include <morula/tree/cover.hpp>

namespace morula::robot {

/// The surfaces of all links with spheres as one mesh; of balls polyhedra.
struct RobotMesh {
  Mesh mesh;
  std::vector<std::size_t> links;         ///< those with spheres, as indices of robot.links
  std::vector<std::size_t> vertex_begin;  ///< vertices of links[k]: [vertex_begin[k], vertex_begin[k + 1])
};
/// With the links at the poses of these values. balls: which polyhedra stand for them. Throws std::invalid_argument for
/// another number of values.
RobotMesh mesh_of(const Robot& robot, const RobotSpheres& spheres, std::span<const double> values,
                  RoundShapes balls = RoundShapes::around);

struct RobotTree {
  Mesh mesh;                              ///< all links' surfaces where they stand; of balls polyhedra around them
  CoveredTree model;                      ///< its leaves are the links' spheres, grown where a polyhedron asks for it
  std::vector<std::size_t> links;         ///< those with spheres, as indices of robot.links
  std::vector<std::size_t> vertex_begin;  ///< vertices of links[k]: [vertex_begin[k], vertex_begin[k + 1])
};

/// With the links at the poses of these values: one per joint of robot.independent_joints. The tree is nested and
/// covers the mesh, proven; a Body that is given the vertices of moved links (vertex_begin) covers them, too. Throws
/// std::invalid_argument for another number of values, and for a robot without spheres.
RobotTree tree_of(const Robot& robot, const RobotSpheres& spheres, std::span<const double> values,
                  Workers& workers = serial_workers());

}  // namespace morula::robot
