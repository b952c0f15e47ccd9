// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Notices of what others wrote and the extra `robot` compiles in.
#pragma once

#include <string_view>
#include <vector>

namespace morula::cli {

std::vector<std::string_view> robot_notices();

}  // namespace morula::cli
