// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Obstacles of planners' queries.
#include <limits>
#include <morula/morula.hpp>
#include <morula/robot/world.hpp>
#include <string>
#include <tuple>

#include "planning.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

std::size_t add_obstacle(GuardedWorld& self, nb::handle obstacle) {
  if (nb::isinstance<robot::ObstacleBox>(obstacle))
    return self.change([&, box = nb::cast<robot::ObstacleBox>(obstacle)](robot::World& w) { return w.add(box); });
  if (nb::isinstance<Capsule>(obstacle))
    return self.change([&, rod = nb::cast<Capsule>(obstacle)](robot::World& w) { return w.add(rod); });
  Sphere sphere;
  if (!nb::try_cast(obstacle, sphere))
    throw nb::type_error(("obstacle: " + describe(obstacle) +
                          ", but a sphere (x, y, z, radius), an ObstacleBox or a Capsule is needed; for others use "
                          "add_mesh, add_points, add_spheres or add_height_field")
                             .c_str());
  return self.change([&](robot::World& w) { return w.add(sphere); });
}

}  // namespace

void bind_robot_world(nb::module_& m) {
  using robot::World;
  nb::class_<GuardedWorld> type(m, "World", doc::World);
  bind_copies(type, "World");
  type.def(nb::init<>())
      .def("__repr__",
           [](const GuardedWorld& self) { return "World(obstacles=<" + std::to_string(self.copy().size()) + ">)"; })
      .def("add", add_obstacle, nb::arg("obstacle"),
           "Adds a sphere (x, y, z, radius), an ObstacleBox or a Capsule, and returns its number.")
      .def(
          "add_mesh",
          [](GuardedWorld& self, MeshGiven given, TransformGiven pose) {
            const BorrowedMesh mesh = mesh_of(given);
            const RigidTransform at = transform_of(pose, "pose");
            return self.change([&](World& w) { return w.add(*mesh, at); });
          },
          nb::arg("mesh"), nb::arg("pose") = RigidTransform{},
          "Adds a mesh at a pose, and returns its number. It is solid if it is closed and oriented, otherwise its "
          "surface alone. Cost: that of a SignedDistance, and of at most 33**3 of its distances, in a grid around the "
          "mesh that makes queries faster; add a mesh once, not for each query.")
      .def(
          "add_height_field",
          [](GuardedWorld& self, ArrayGiven given, double spacing, TransformGiven pose) {
            std::vector<std::size_t> shape;
            const std::vector<double> heights = numbers_of(given.object, "heights", {-1, -1}, shape);
            const RigidTransform at = transform_of(pose, "pose");
            return self.change([&](World& w) {
              return w.add(robot::HeightField{heights, shape[1], shape[0], spacing, at});
            });
          },
          nb::arg("heights"), nb::arg("spacing"), nb::arg("pose") = RigidTransform{},
          "Adds a terrain, and returns its number. heights: (rows, columns); the height in row k and column i is over "
          "(i * spacing, k * spacing). The solid is everything below.")
      .def(
          "add_points",
          [](GuardedWorld& self, ArrayGiven points_given, double radius) {
            const std::vector<Vec3> points = points_of(points_given.object, "points");
            return self.change([&](World& w) { return w.add_points(points, radius); });
          },
          nb::arg("points"), nb::arg("radius"), doc::World_add_points)
      .def(
          "add_spheres",
          [](GuardedWorld& self, ArrayGiven spheres_given) {
            const std::vector<Sphere> spheres = spheres_of(spheres_given.object, "spheres");
            return self.change([&](World& w) { return w.add_spheres(spheres); });
          },
          nb::arg("spheres"), doc::World_add_spheres)
      .def("__len__", [](const GuardedWorld& self) { return self.copy().size(); })
      .def(
          "nearest",
          [](GuardedWorld& self, Vec3 p, double within) {
            const robot::NearestObstacle found = self.copy().nearest(p, within);
            return std::tuple{found.distance, found.direction, index_or_none(found.obstacle)};
          },
          nb::arg("p"), nb::arg("within") = std::numeric_limits<double>::infinity(),
          "The nearest obstacle of a point: its signed distance, the direction in which the distance grows, and its "
          "number, or None if all are farther away than `within`.");
}

}  // namespace morula::python
