// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page of a robot: its links and spheres, which the reader moves joint by joint.
#pragma once

#include <morula/page/page.hpp>
#include <morula/robot/self_collision.hpp>

namespace morula::cli {

/// Levels: one sphere around all, one around each link's, and the spheres themselves. A second scene has the inner
/// spheres, where there are some.
PageContent robot_page(const robot::Robot& robot, const robot::RobotSpheres& spheres,
                       const robot::SelfCollision& self_collision);

}  // namespace morula::cli
