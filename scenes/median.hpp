// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The median of measurements.
#pragma once

#include <morula/parallel/stopwatch.hpp>

namespace morula::scenes {

using morula::median;

}  // namespace morula::scenes
