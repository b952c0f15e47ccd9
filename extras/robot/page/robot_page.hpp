// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page of a robot: its links and spheres, which the reader moves joint by joint.
#pragma once

#include <morula/page/page.hpp>
#include <morula/robot/self_collision.hpp>

namespace morula::robot {

/// Levels: one sphere around all, one around each link's, and the spheres themselves. A second scene has the inner
/// spheres, where there are some.
PageContent robot_page(const Robot& robot, const RobotSpheres& spheres, const SelfCollision& self_collision);

}  // namespace morula::robot
