// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A robot's spheres in motion, and what they meet.
#include <memory>
#include <morula/morula.hpp>
#include <morula/robot/sphere_robot.hpp>
#include <mutex>
#include <string>
#include <vector>

#include "holders.hpp"
#include "records.hpp"
#include "robots.hpp"

namespace morula::python {

namespace {

struct HeldRobot {
  robot::SphereRobot robot;
  std::size_t own_count;
  std::mutex mutex;

  /// Locks the robot without the GIL: a thread that holds the robot may wait for the GIL.
  template <class F>
  auto locked(const F& f) {
    return without_gil([&] {
      const std::scoped_lock lock(mutex);
      return f();
    });
  }
};

std::shared_ptr<Posed> posed_of(nb::handle given) {
  if (nb::isinstance<PosedBody>(given)) return nb::cast<std::shared_ptr<PosedBody>>(given);
  if (nb::isinstance<PosedRebuilt>(given)) return nb::cast<std::shared_ptr<PosedRebuilt>>(given);
  if (nb::isinstance<PosedRows>(given)) return nb::cast<std::shared_ptr<PosedRows>>(given);
  return nullptr;
}

}  // namespace

void bind_sphere_robot(nb::module_& m) {
  using robot::ObstacleBox;
  Record<ObstacleBox> box(m, "ObstacleBox", doc::ObstacleBox, MadeBy::calls);
  box.field("pose", &ObstacleBox::pose).field("half", &ObstacleBox::half, doc::ObstacleBox_half);
  box.python().def(
      "__init__",
      [](ObstacleBox* self, Vec3 half, TransformGiven pose) {
        new (self) ObstacleBox{transform_of(pose), half};
      },
      nb::arg("half"), nb::arg("pose") = RigidTransform{});
  nb::class_<HeldRobot>(m, "SphereRobot", doc::SphereRobot)
      .def(
          "__init__",
          [](HeldRobot* self, const robot::Robot& robot, const robot::RobotSpheres& spheres,
             const robot::SelfCollision* ignored) {
            robot::SphereRobot made = without_gil(
                [&] { return robot::SphereRobot(robot, spheres, ignored ? *ignored : robot::SelfCollision{}); });
            new (self) HeldRobot{std::move(made), robot.independent_joints.size(), {}};
          },
          nb::arg("robot"), nb::arg("spheres"), nb::arg("self_collision") = nb::none(), doc::SphereRobot_SphereRobot)
      .def(
          "set_joint_values",
          [](HeldRobot& self, ArrayGiven given) {
            const std::vector<double> values = values_of(given);
            self.locked([&] { self.robot.set_joint_values(values); });
          },
          nb::arg("values"), doc::SphereRobot_set_joint_values)
      .def(
          "set_link_poses",
          [](HeldRobot& self, nb::handle given) {
            const std::vector<RigidTransform> poses = poses_of(given, "link_poses");
            self.locked([&] { self.robot.set_link_poses(poses); });
          },
          nb::arg("link_poses"),
          nb::sig("def set_link_poses(self, link_poses: collections.abc.Sequence[morula._morula.RigidTransform] | "
                  "morula.typing.FloatArray) -> None"),
          doc::SphereRobot_set_link_poses)
      .def_prop_ro(
          "links",
          [](const HeldRobot& self) {
            return std::vector<std::size_t>(self.robot.links().begin(), self.robot.links().end());
          },
          doc::SphereRobot_links)
      .def_prop_ro("sphere_count",
                   [](HeldRobot& self) { return self.locked([&] { return self.robot.sphere_count(); }); })
      .def(
          "spheres", [](HeldRobot& self) { return own_spheres(self.locked([&] { return self.robot.spheres(); })); },
          (std::string("(n, 4) float64. ") + doc::SphereRobot_spheres).c_str())
      .def(
          "self_collision", [](HeldRobot& self) { return self.locked([&] { return self.robot.self_collision(); }); },
          doc::SphereRobot_self_collision)
      .def(
          "self_collisions",
          [](HeldRobot& self, ArrayGiven given) {
            std::vector<std::size_t> shape;
            const std::vector<double> all =
                numbers_of(given.object, "values", {-1, static_cast<std::int64_t>(self.own_count)}, shape);
            auto [found, owner] = kept(self.locked([&] {
              SignalCheck check;
              std::vector<std::uint8_t> collides(shape[0]);
              for (std::size_t i = 0; i < shape[0]; ++i) {
                self.robot.set_joint_values(std::span(all).subspan(i * shape[1], shape[1]));
                collides[i] = self.robot.self_collision().has_value();
                if (i % 64 == 63) check();
              }
              return collides;
            }));
            return Copy<bool, -1>(reinterpret_cast<bool*>(found->data()), {found->size()}, owner);
          },
          nb::arg("values"),
          "set_joint_values() and self_collision() for many configurations, (n, coordinates), in one call: (n,) bool. "
          "The robot "
          "stays in the last one.")
      .def(
          "collides",
          [](HeldRobot& self, nb::handle obstacle, TransformGiven transform_given) {
            const RigidTransform transform = transform_of(transform_given);
            if (const std::shared_ptr<Posed> posed = posed_of(obstacle)) {
              return self.locked([&] {
                const std::shared_lock reading(posed->mutex);
                return self.robot.collides(posed->sphere_state(), transform);
              });
            }
            if (nb::isinstance<ObstacleBox>(obstacle)) {
              const auto& box = nb::cast<const ObstacleBox&>(obstacle);
              const ObstacleBox placed{relative_to(inverse(transform), box.pose), box.half};
              const bool moved = !(transform == RigidTransform{});
              return self.locked([&] { return self.robot.collides(moved ? placed : box); });
            }
            Sphere sphere;
            if (!nb::try_cast(obstacle, sphere))
              throw nb::type_error(("obstacle: " + describe(obstacle) +
                                    ", but a sphere (x, y, z, radius), an ObstacleBox, a Body, a RebuiltBody or "
                                    "PosedSpheres is needed")
                                       .c_str());
            sphere.center = transform(sphere.center);
            return self.locked([&] { return self.robot.collides(sphere); });
          },
          nb::arg("obstacle"), nb::arg("transform") = RigidTransform{},
          nb::sig("def collides(self, obstacle: morula.typing.Vector | ObstacleBox | morula._morula.Body | "
                  "morula._morula.RebuiltBody | morula._morula.PosedSpheres, "
                  "transform: morula.typing.Transform = ...) -> bool"),
          (std::string("True if a sphere of the robot overlaps the obstacle. ") + doc::SphereRobot_collides_2).c_str())
      .def_prop_ro(
          "sphere_tests", [](const HeldRobot& self) { return self.robot.sphere_tests(); },
          doc::SphereRobot_sphere_tests)
      .def("__repr__", [](const HeldRobot& self) {
        return "<morula.robot.SphereRobot: " + std::to_string(self.robot.sphere_count()) + " spheres on " +
               std::to_string(self.robot.links().size()) + " links>";
      });
}

}  // namespace morula::python
