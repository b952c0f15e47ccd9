// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "page.hpp"

#include <fmt/format.h>

#include <morula/page/page.hpp>

#include "robot_page.hpp"
#include "shared/command.hpp"

namespace morula::cli {

bool has_robot_page() {
  return true;
}

void require_robot_page() {
  if (!has_page()) throw UsageError(fmt::format("this morula was built without its page: {}", why_no_page()));
}

std::string robot_page_text(const robot::Robot& robot, const robot::RobotSpheres& spheres,
                            const robot::SelfCollision& self_collision) {
  return make_page(robot::robot_page(robot, spheres, self_collision));
}

}  // namespace morula::cli
