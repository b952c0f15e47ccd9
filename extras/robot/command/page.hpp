// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page of `morula robot --page`, in commands that were built with the extra `page`.
#pragma once

#include <morula/robot/self_collision.hpp>
#include <string>

namespace morula::cli {

/// False in a command without the extra `page`: it has no --page.
bool has_robot_page();
/// Throws UsageError where the page could not be bundled when the command was built.
void require_robot_page();
/// The file's text.
std::string robot_page_text(const robot::Robot& robot, const robot::RobotSpheres& spheres,
                            const robot::SelfCollision& self_collision);

}  // namespace morula::cli
