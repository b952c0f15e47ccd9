// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// One tree over all links of a robot, for queries that treat it as one body.
#pragma once

#include <morula/robot/fit.hpp>
#include <morula/tree/cover.hpp>

namespace morula::robot {

/// The surfaces of all links with spheres as one mesh, with polyhedra for balls.
struct RobotMesh {
  Mesh mesh;
  std::vector<std::size_t> links;         ///< links with spheres, as indices of robot.links
  std::vector<std::size_t> vertex_begin;  ///< vertices of links[k]: [vertex_begin[k], vertex_begin[k + 1])
};
/// The mesh of all links at the poses of these values. balls: the polyhedra for balls. Throws std::invalid_argument for
/// another number of values.
RobotMesh mesh_of(const Robot& robot, const RobotSpheres& spheres, std::span<const double> values,
                  RoundShapes balls = RoundShapes::around);

struct RobotTree {
  Mesh mesh;                              ///< all links' surfaces at their poses, with polyhedra around balls
  CoveredTree model;                      ///< tree with the links' spheres as leaves, grown to contain polyhedra
  std::vector<std::size_t> links;         ///< links with spheres, as indices of robot.links
  std::vector<std::size_t> vertex_begin;  ///< vertices of links[k]: [vertex_begin[k], vertex_begin[k + 1])
};

/// The tree of all links at the poses of these values, one per joint of robot.independent_joints. The tree is nested
/// and proven to cover the mesh; a Body that is updated with the vertices of moved links (vertex_begin) covers them
/// too. Throws std::invalid_argument for another number of values, and for a robot without spheres.
RobotTree tree_of(const Robot& robot, const RobotSpheres& spheres, std::span<const double> values,
                  WorkersOrAll workers = {});

}  // namespace morula::robot
