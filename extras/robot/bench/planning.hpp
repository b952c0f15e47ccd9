// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What scenarios of planners plan with.
#pragma once

#include <morula/geometry/reproducible.hpp>
#include <morula/robot/robot.hpp>
#include <morula/robot/sphere_robot.hpp>
#include <vector>

#include "scenario.hpp"

namespace morula::bench {

/// Seven joints where a panda has them, and links of about its size.
robot::Robot arm();
/// Random boxes around it.
std::vector<robot::ObstacleBox> boxes_around(Random& random, std::size_t count);
/// A bumpy ball of about seven thousand facets beside it.
Mesh rock();
/// Clearances of so many configurations among boxes and the rock, against a plain loop.
Result run_clearance(std::size_t configurations, const Settings& settings);

}  // namespace morula::bench
