// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// intersect() for loops that already run in the standard floating-point environment.
#pragma once

#include <morula/geometry/triangle.hpp>

namespace morula::detail {

bool triangles_meet(const Triangle& a, const Triangle& b);

}  // namespace morula::detail
