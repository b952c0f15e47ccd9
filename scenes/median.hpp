// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The median of measurements.
#pragma once

#include <toolbox/stopwatch.hpp>

namespace morula::scenes {

using toolbox::median;

}  // namespace morula::scenes
