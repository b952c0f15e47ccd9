// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// All links of a robot as one mesh, and one tree over them.
#include <memory>
#include <morula/morula.hpp>
#include <morula/robot/robot_tree.hpp>
#include <vector>

#include "holders.hpp"
#include "records.hpp"
#include "robots.hpp"

namespace morula::python {

void bind_robot_trees(nb::module_& m) {
  using robot::RobotSpheres;
  Record<robot::RobotMesh>(m, "RobotMesh", doc::RobotMesh)
      .field("mesh", &robot::RobotMesh::mesh)
      .field("links", &robot::RobotMesh::links, doc::RobotMesh_links)
      .field("vertex_begin", &robot::RobotMesh::vertex_begin, doc::RobotMesh_vertex_begin);
  m.def(
      "mesh_of",
      [](const robot::Robot& robot, const RobotSpheres& spheres, ArrayGiven given, std::string_view balls) {
        const std::vector<double> values = values_of(given);
        const robot::RoundShapes round = round_of(balls, "balls");
        return without_gil([&] { return robot::mesh_of(robot, spheres, values, round); });
      },
      nb::arg("robot"), nb::arg("spheres"), nb::arg("values"), nb::arg("balls") = "around",
      with_arguments(doc::RobotMesh, {{"values", "one per joint of robot.independent_joints"},
                                      {"balls", "around or inside: the polyhedra for round shapes"}})
          .c_str());
  Record<robot::RobotTree>(m, "RobotTree", "One tree over all links of a robot.")
      .property(
          "mesh", [](const robot::RobotTree& t) { return std::make_shared<Mesh>(t.mesh); }, doc::RobotTree_mesh)
      .property(
          "model", [](const robot::RobotTree& t) { return std::make_shared<CoveredTree>(t.model); },
          doc::RobotTree_model)
      .field("links", &robot::RobotTree::links, doc::RobotTree_links)
      .field("vertex_begin", &robot::RobotTree::vertex_begin, doc::RobotTree_vertex_begin);
  m.def(
      "tree_of",
      [](const robot::Robot& robot, const RobotSpheres& spheres, ArrayGiven given, Threads* workers) {
        const std::vector<double> values = values_of(given);
        return without_gil([&] { return robot::tree_of(robot, spheres, values, CallWorkers(workers)); });
      },
      nb::arg("robot"), nb::arg("spheres"), nb::arg("values"), nb::arg("workers") = nb::none(), doc::tree_of);
}

}  // namespace morula::python
