// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The connectivity of a closed surface, and winding numbers around vertices of another body.
#pragma once

#include <morula/collide/collider.hpp>
#include <morula/geometry/connectivity.hpp>
#include <utility>
#include <vector>

namespace morula::detail {

/// A body's surface that is closed, oriented and not inside out. It depends on the facets alone.
struct ClosedSurface {
  /// which: "first", "second", or "" for the only body, for the message. Throws std::invalid_argument.
  ClosedSurface(const Collider& body, const char* which);

  Connectivity connectivity;
  Components components;  ///< by vertices; no_facet for facets with a repeated index, which belong to none
  std::vector<std::uint32_t> component_vertex;  ///< a vertex of each component
};

/// Computes winding numbers by half lines.
class ShiftedWinding {
 public:
  /// The winding number of the body's surface around a vertex of the other body, in general position: exact, as in
  /// shifted_predicates.hpp. of_a: true if the point is a vertex of a. Cost: see InsideQuery::locate.
  int around(const Collider& body, const Vec3& point, bool of_a);

 private:
  std::vector<std::pair<std::uint32_t, int>> crossed_;  // facets that the half line passes, and their shares
};

}  // namespace morula::detail
