// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// CSV files: cells with commas, quotes and line breaks.
#pragma once

#include <string>
#include <string_view>

namespace morula::toolbox {

/// A cell of a CSV file, quoted when it must be.
std::string csv_cell(std::string_view text);

}  // namespace morula::toolbox
