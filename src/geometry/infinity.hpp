// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

namespace morula::detail {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace morula::detail
