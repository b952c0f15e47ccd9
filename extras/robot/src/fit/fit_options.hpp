// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <morula/robot/fit.hpp>

namespace morula::robot {

/// Throws std::invalid_argument for options out of range and for names of links that the robot lacks.
void require_fit_options(const Robot& robot, const FitOptions& options);

}  // namespace morula::robot
