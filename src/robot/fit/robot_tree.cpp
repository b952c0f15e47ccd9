// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/robot/robot_tree.hpp>
#include <morula/tree/ball_tree.hpp>
#include <stdexcept>
#include <utility>

namespace morula::robot {

namespace {

void add(Mesh& to, const Mesh& mesh, const RigidTransform& at) {
  const auto base = static_cast<std::uint32_t>(to.positions.size());
  for (const Vec3& p : mesh.positions) to.positions.push_back(at(p));
  for (const Facet& f : mesh.facets) to.facets.push_back({base + f[0], base + f[1], base + f[2]});
}

}  // namespace

RobotMesh mesh_of(const Robot& robot, const RobotSpheres& spheres, std::span<const double> values) {
  const std::vector<RigidTransform> poses = link_poses(robot, values);
  RobotMesh result;
  for (const LinkSpheres& link : spheres.links) {
    const RigidTransform& at = poses[link.link];
    result.links.push_back(link.link);
    result.vertex_begin.push_back(result.mesh.positions.size());
    add(result.mesh, link.surface.mesh, at);
    for (const Sphere& s : link.surface.spheres) {
      Shape ball;
      ball.kind = Shape::Kind::ellipsoid;
      ball.size = 2 * s.radius * Vec3{1, 1, 1};
      ball.origin.translation = s.center;
      add(result.mesh, surface_of(robot.file, std::span(&ball, 1)).mesh, at);
    }
  }
  result.vertex_begin.push_back(result.mesh.positions.size());
  return result;
}

RobotTree tree_of(const Robot& robot, const RobotSpheres& spheres, std::span<const double> values, Workers& workers) {
  const std::vector<RigidTransform> poses = link_poses(robot, values);
  if (spheres.links.empty()) throw std::invalid_argument("tree_of: the robot has no spheres");
  RobotMesh all = mesh_of(robot, spheres, values);
  RobotTree result{.mesh = std::move(all.mesh),
                   .built = {},
                   .links = std::move(all.links),
                   .vertex_begin = std::move(all.vertex_begin)};
  std::vector<Sphere> leaves;
  for (const LinkSpheres& link : spheres.links) {
    for (const Sphere& s : link.spheres) leaves.push_back({poses[link.link](s.center), s.radius});
  }
  result.built = cover(result.mesh, tree_over_balls(leaves), CoverOptions{.nested = true}, workers);
  result.built.report.method = "robot";
  return result;
}

}  // namespace morula::robot
