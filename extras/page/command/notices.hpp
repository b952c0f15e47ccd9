// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Notices of the third-party code that the extra `page` compiles in.
#pragma once

#include <string_view>
#include <vector>

namespace morula::cli {

std::vector<std::string_view> page_notices();

}  // namespace morula::cli
