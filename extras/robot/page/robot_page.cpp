// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/robot/robot_tree.hpp>
#include <string_view>
#include <toolbox/shell_word.hpp>
#include <utility>

#include "platform/path_text.hpp"

namespace morula::robot {
namespace {

std::string_view reason_text(IgnoreReason reason) {
  switch (reason) {
    case IgnoreReason::given:
      return "listed in a file that was given";
    case IgnoreReason::adjacent:
      return "neighbors";
    case IgnoreReason::rest:
      return "surfaces touch at rest";
    case IgnoreReason::apart:
      return "proven apart in all configurations";
    case IgnoreReason::never:
      return "apart in all sampled configurations";
  }
  return {};
}

std::string certifying_command(const Robot& robot, const RobotSpheres& spheres) {
  return fmt::format("morula robot {}{} -o edited --keep spheres.json --all-formats --page",
                     toolbox::shell_word(platform::text_of(robot.file.filename())),
                     spheres.visual ? " --geometry visual" : "");
}

PageJoints page_joints(const Robot& robot, const RobotSpheres& spheres, const RobotMesh& all,
                       const std::vector<double>& rest, const SelfCollision& self_collision) {
  PageJoints joints;
  for (const Link& link : robot.links) joints.parts.push_back({.name = link.name});
  for (std::size_t k = 0; k < all.links.size(); ++k) {
    PageJoints::Part& part = joints.parts[all.links[k]];
    part.vertex_begin = all.vertex_begin[k];
    part.vertex_end = all.vertex_begin[k + 1];
    part.protrusion = spheres.links[k].figures.protrusion_max;
    part.spheres = spheres.links[k].spheres;
    part.balls = spheres.links[k].surface.spheres;
  }
  std::vector<std::size_t> place(robot.joints.size());  // of each joint in the page's order
  for (std::size_t i = 0; i < robot.order.size(); ++i) place[robot.order[i]] = i;
  for (const std::size_t i : robot.order) {
    const Joint& joint = robot.joints[i];
    using Kind = PageJoints::Joint::Kind;
    PageJoints::Joint to{.name = joint.name, .parent = joint.parent, .child = joint.child, .origin = joint.origin};
    if (joint.moves()) {
      to.kind = joint.kind == Joint::Kind::prismatic ? Kind::slides : Kind::turns;
      to.axis = joint.axis;
      to.lower = joint.lower;
      to.upper = joint.upper;
      if (joint.mimic) {
        to.leader = place[joint.mimic->joint];
        to.factor = joint.mimic->multiplier;
        to.offset = joint.mimic->offset;
      }
    }
    joints.joints.push_back(std::move(to));
  }
  for (std::size_t k = 0; k < robot.independent_joints.size(); ++k)
    joints.joints[place[robot.independent_joints[k]]].rest = rest[k];
  for (const IgnoredPair& pair : self_collision.ignored) {
    joints.ignored.push_back({pair.a, pair.b});
    joints.reasons.emplace_back(reason_text(pair.reason));
  }
  joints.command = certifying_command(robot, spheres);
  return joints;
}

PageScene page_scene(const RobotSpheres& spheres, const std::vector<RigidTransform>& poses, const std::string& name) {
  PageScene scene{
      .motion = 0, .tree = name, .rule = "joints", .rest = {}, .frames = {}, .measured = {}, .empty_share = {}};
  std::vector<Sphere> around, leaves;
  std::vector<std::uint32_t> counts;
  for (const LinkSpheres& link : spheres.links) {
    std::vector<Sphere> placed;
    for (const Sphere& s : link.spheres) placed.push_back({poses[link.link](s.center), s.radius});
    around.push_back(enclosing_sphere_of_spheres(placed));
    counts.push_back(static_cast<std::uint32_t>(placed.size()));
    leaves.insert(leaves.end(), placed.begin(), placed.end());
    scene.parts.push_back(static_cast<std::uint32_t>(link.link));
  }
  const auto link_count = static_cast<std::uint32_t>(around.size());
  scene.rest.branching = std::max<std::uint32_t>(link_count, *std::max_element(counts.begin(), counts.end()));
  const std::array<Sphere, 1> root{enclosing_sphere_of_spheres(around)};
  scene.rest.append_level({}, root);
  scene.rest.append_level(std::array<std::uint32_t, 1>{link_count}, around);
  scene.rest.append_level(counts, leaves);
  scene.frames.push_back(scene.rest.spheres);
  return scene;
}

}  // namespace

PageContent robot_page(const Robot& robot, const RobotSpheres& spheres, const SelfCollision& self_collision) {
  const std::vector<double> rest = rest_values(robot);
  const std::vector<RigidTransform> poses = link_poses(robot, rest);
  RobotMesh all = mesh_of(robot, spheres, rest, RoundShapes::inside);
  PageContent content;
  content.title = robot.name;
  content.scenes.push_back(page_scene(spheres, poses, "spheres that cover"));
  if (spheres.inner_count() > 0) {
    content.scenes.push_back(page_scene(spheres.with_inner_spheres(), poses, "inner spheres"));
    content.scenes.back().inside = true;
  }
  PageJoints joints = page_joints(robot, spheres, all, rest, self_collision);
  content.motions.push_back({.body = robot.name,
                             .name = "joints",
                             .facets = std::move(all.mesh.facets),
                             .frame_names = {"rest"},
                             .frames = {std::move(all.mesh.positions)},
                             .joints = std::move(joints)});
  return content;
}

}  // namespace morula::robot
