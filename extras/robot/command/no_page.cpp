// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "page.hpp"

namespace morula::cli {

bool has_robot_page() {
  return false;
}

void require_robot_page() {
  throw std::logic_error("a command without pages has no --page");
}

std::string robot_page_text(const robot::Robot&, const robot::RobotSpheres&, const robot::SelfCollision&) {
  throw std::logic_error("a command without pages has no --page");
}

}  // namespace morula::cli
