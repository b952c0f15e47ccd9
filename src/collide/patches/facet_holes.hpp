// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Holes in a facet's part. A part may consist of several polygons. One that runs clockwise about the normal is a hole,
// and belongs to the smallest polygon around it that runs counter-clockwise.
#pragma once

#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <span>
#include <utility>
#include <vector>

#include "geometry/disjoint_sets.hpp"

namespace morula::detail {

/// A directed piece of the boundary of a facet's part.
struct BoundaryPiece {
  std::uint32_t from, to;  ///< elements
  int weight;
  bool is_loop;  ///< true for a segment, false for a part of an edge
};

class FacetHoles {
 public:
  /// Pairs of an element of a hole and one of the polygon around it. pieces: of the part; normal: of the facet, of any
  /// length. Cost: O(n log n) for n pieces, and that of the polygons whose boxes contain a point of a hole.
  std::span<const std::pair<std::uint32_t, std::uint32_t>> find(std::span<const BoundaryPiece> pieces,
                                                                std::span<const Vec3> points, const Vec3& normal);

 private:
  struct Polygon {
    double area = 0, lower[2], upper[2];  // in the plane of two axes
    std::uint32_t element, begin, end;    // range of order_
  };
  void read(std::span<const BoundaryPiece> pieces, std::span<const Vec3> points);
  bool holds(const Polygon& polygon, const Vec3& x, std::span<const BoundaryPiece> pieces,
             std::span<const Vec3> points) const;

  int axes_[2];
  double outward_;
  std::vector<std::uint32_t> ends_, order_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> by_polygon_, found_;  // root and piece; hole and polygon
  DisjointSets sets_{0};
  std::vector<Polygon> polygons_, holes_;
  std::vector<const Polygon*> open_;
};

}  // namespace morula::detail
