// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Triangles that meet: exactly on a lattice; elsewhere "clearly", by more than any rounding.
#pragma once

#include <cstdint>
#include <optional>
#include <point.hpp>

namespace oracle {

/// Coordinates are whole numbers of at most 2^20.
using LatticePoint = Vector<std::int64_t>;
using LatticeTriangle = std::array<LatticePoint, 3>;
inline constexpr std::int64_t largest_lattice_coordinate = std::int64_t(1) << 20;

/// Have they a point in common? Touching and coplanar triangles count, segments and points are triangles, too.
bool meet_exactly(const LatticeTriangle& a, const LatticeTriangle& b);

/// A plane lies between them, more than `margin` wide.
bool clearly_apart(const Triangle& a, const Triangle& b, Real margin);

/// A point where an edge of one goes through the inside of the other, its ends and the triangle's border more than
/// `margin` away from it.
///
/// When every vertex is off by e and no vertices are more than L apart, the plane of such a triangle turns by at
/// most 2 e / margin, so its distance from the ends of the edge changes by e + 2 e L / margin: with margin = 4
/// sqrt(e L) + 8 e the triangles cross whatever the vertices' errors.
std::optional<Point> clearly_crossing(const Triangle& a, const Triangle& b, Real margin);

}  // namespace oracle
