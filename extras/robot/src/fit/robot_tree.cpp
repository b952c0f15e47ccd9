// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/robot/robot_tree.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <stdexcept>
#include <utility>

#include "fit/clip.hpp"

namespace morula::robot {

namespace {

void add_moved(Mesh& to, Mesh mesh, const RigidTransform& at) {
  for (Vec3& p : mesh.positions) p = at(p);
  append_mesh(to, mesh);
}

}  // namespace

RobotMesh mesh_of(const Robot& robot, const RobotSpheres& spheres, std::span<const double> values, RoundShapes balls) {
  const std::vector<RigidTransform> poses = link_poses(robot, values);
  RobotMesh result;
  for (const LinkSpheres& link : spheres.links) {
    const RigidTransform& at = poses[link.link];
    result.links.push_back(link.link);
    result.vertex_begin.push_back(result.mesh.positions.size());
    add_moved(result.mesh, link.surface.mesh, at);
    for (const Sphere& s : link.surface.spheres) add_moved(result.mesh, ball_mesh_of(s, balls), at);
  }
  result.vertex_begin.push_back(result.mesh.positions.size());
  return result;
}

RobotTree tree_of(const Robot& robot, const RobotSpheres& spheres, std::span<const double> values, WorkersOrAll given) {
  Workers& workers = given;
  const std::vector<RigidTransform> poses = link_poses(robot, values);
  if (spheres.links.empty()) throw std::invalid_argument("tree_of: the robot has no spheres");
  RobotMesh all = mesh_of(robot, spheres, values);
  RobotTree result{.mesh = std::move(all.mesh),
                   .model = {},
                   .links = std::move(all.links),
                   .vertex_begin = std::move(all.vertex_begin)};
  std::vector<Sphere> leaves;
  for (const LinkSpheres& link : spheres.links) {
    for (const Sphere& s : link.spheres) leaves.push_back({poses[link.link](s.center), s.radius});
  }
  result.model = cover(result.mesh, tree_from_spheres(leaves), {.nested = true}, workers);
  result.model.report.method = "robot";
  return result;
}

}  // namespace morula::robot
