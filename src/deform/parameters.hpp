// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Parameters of deformations: their ranges, and how numbers look in messages and names.
#pragma once

#include <morula/deform/deformation.hpp>
#include <string>

namespace morula::detail {

/// Throws std::invalid_argument naming the deformation, the parameter, its value and the range.
void require_in_range(const Deformation& deformation);

/// At most six digits, the same in every locale: "90", "0.05", "1e-06".
std::string format_number(double value);

/// "x", "y" or "z".
std::string axis_name(int axis);

}  // namespace morula::detail
