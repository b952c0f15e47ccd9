// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Exact signs: on which side of a line or a plane a point lies, for doubles as they are.
//
// A quick evaluation with an error bound decides nearly always; else the determinant is summed without rounding as an
// expansion [shewchuk1997]. Exact as long as no product of coordinates (of three for planes) leaves the range of
// double: between 2^-300 and 2^300, or 0.
#pragma once

#include <morula/geometry/triangle.hpp>

namespace morula {

/// Sign of (b - a) x (p - a) in the plane: 1 when a, b, p turn to the left, -1 to the right, 0 on one line.
int orientation(double ax, double ay, double bx, double by, double px, double py);

/// Sign of p's height over the plane of t: 1 on the side that the normal points to, 0 in the plane or when t has no
/// area.
int orientation(const Triangle& t, const Vec3& p);

/// Sign of a b - c d.
int sign_of_difference(double a, double b, double c, double d);

}  // namespace morula
