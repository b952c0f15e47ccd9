// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page of a robot.
#include <morula/robot/self_collision.hpp>

#include "holders.hpp"
#include "robot_page.hpp"
#include "robots.hpp"

namespace morula::python {

void bind_robot_page(nb::module_& m) {
  m.def(
      "page_html",
      [](const robot::Robot& robot, const robot::RobotSpheres& spheres, const robot::SelfCollision* ignored) {
        return without_gil([&] {
          const robot::SelfCollision none;
          return make_page(robot::robot_page(robot, spheres, ignored ? *ignored : none));
        });
      },
      nb::arg("robot"), nb::arg("spheres"), nb::arg("self_collision") = nb::none(),
      "The text of the page of a robot: its links and spheres, whose joints the reader can move.");
}

}  // namespace morula::python
