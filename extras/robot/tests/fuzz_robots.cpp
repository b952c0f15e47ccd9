// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Robots' files: URDF, MJCF or SDF as the first element says, or after a first byte of 'd' a COLLADA scene. A robot
// that is read is a tree, its links have poses, and the URDF that is written of it is the same robot.
#include <cmath>
#include <fstream>
#include <morula/io/mesh_file.hpp>
#include <morula/robot/output.hpp>
#include <support/scratch_folder.hpp>

#include "fuzz.hpp"
#include "specimens.hpp"

namespace morula::fuzz {
namespace {

std::filesystem::path written(const std::string& name, std::string_view bytes) {
  static const test::ScratchFolder folder;
  return folder.file("a/b/" + name, bytes);
}

bool is_ordinary(const robot::Robot& robot) {
  // Characters that XML changes on its way, and numbers whose products are none.
  for (const robot::Link& link : robot.links) {
    for (const char c : link.name) {
      if (static_cast<unsigned char>(c) < ' ') return false;
    }
  }
  for (const robot::Joint& joint : robot.joints) {
    for (const char c : joint.name) {
      if (static_cast<unsigned char>(c) < ' ') return false;
    }
    const double sum = max_norm(joint.origin.translation) + std::abs(joint.lower) + std::abs(joint.upper) +
                       (joint.mimic ? std::abs(joint.mimic->multiplier) + std::abs(joint.mimic->offset) : 0);
    if (!(sum < 1e100) || !(deviation_from_rigid(joint.origin) < 1e-6)) return false;
  }
  return true;
}

void require_tree(const robot::Robot& robot) {
  require(robot.order.size() == robot.joints.size() && robot.links.size() == robot.joints.size() + 1,
          "a robot is no tree");
  std::vector<bool> placed(robot.links.size());
  placed[robot.root] = true;
  for (const std::size_t i : robot.order) {
    const robot::Joint& joint = robot.joints[i];
    require(placed[joint.parent] && !placed[joint.child], "joints are not in order");
    require(robot.links[joint.child].joint == i, "a link does not know its joint");
    placed[joint.child] = true;
  }
  require(robot::link_poses(robot, robot::rest_values(robot)).size() == robot.links.size(), "a link has no pose");
}

void try_robot(std::string_view bytes) {
  const std::filesystem::path path = written("robot.xml", bytes);
  robot::Robot robot;
  const MemoryMeter memory;
  try {
    robot = robot::read_robot(path, {.visual = true});
    for (const robot::Link& link : robot.links) robot::surface_of(path, link.visual);
  } catch (const FileError& error) {
    memory.require_modest(bytes.size());
    require_good_message(error.what(), path.string());
    return;
  }
  require_tree(robot);
  if (!is_ordinary(robot) || robot.format == robot::Robot::Format::urdf) return;
  const robot::OutputOptions options{.folder = path.parent_path()};
  const auto files = robot::output_format("urdf")->write({robot, {}, {}, options});
  const robot::Robot again = robot::read_robot(written("again.urdf", files.front().bytes));
  require(again.links.size() == robot.links.size() && again.own.size() == robot.independent_joints.size(),
          "a robot that was written reads back as another one");
}

void try_scene(std::string_view bytes) {
  const std::filesystem::path path = written("scene.dae", bytes);
  const MemoryMeter memory;
  try {
    const Mesh mesh = robot::read_collada(path);
    for (const Facet& f : mesh.facets) {
      for (const std::uint32_t v : f) require(v < mesh.positions.size(), "a corner is no vertex");
    }
  } catch (const FileError& error) {
    memory.require_modest(bytes.size());
    require_good_message(error.what(), path.string());
  }
}

}  // namespace
}  // namespace morula::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (bytes.starts_with('d')) {
    morula::fuzz::try_scene(bytes.substr(1));
  } else {
    morula::fuzz::try_robot(bytes);
  }
  return 0;
}
