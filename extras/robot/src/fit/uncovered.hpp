// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The fit of a robot that leaves a share of its surface uncovered.
#pragma once

#include <morula/robot/fit.hpp>

namespace morula::robot {

/// fit_spheres() with FitOptions::max_uncovered set.
RobotSpheres fit_uncovered(const Robot& robot, const FitOptions& options, Workers& workers);

}  // namespace morula::robot
