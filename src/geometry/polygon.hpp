// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Polygons in space cut into facets between their own corners.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <span>
#include <vector>

#include "geometry/exact_predicates.hpp"

namespace morula::detail {

/// The way in which a polygon was cut. Every way gives two facets fewer than corners, and uses every side of the
/// polygon once.
enum class PolygonCut {
  fan,       ///< facets about the first corner, from which the whole polygon is visible: convex ones, and some others
  ears,      ///< ears, one after the other, for concave polygons
  crossing,  ///< the polygon crosses itself, or is too intricate; facets about the first corner nevertheless
};

struct PolygonShape {
  PolygonCut cut = PolygonCut::fan;
  bool bent = false;  ///< true if no plane fits: along their normal, corners are more than a tenth of its diagonal
                      ///< apart
};

/// Cuts polygons in the projection along the axis that is nearest to their normal. Decisions are exact, so that the
/// facets of a polygon without crossings neither overlap nor leave a gap there, for any first corner and either
/// orientation. A polygon may touch itself: holes that two opposite sides join to the outline are cut out.
///
/// Throws nothing but std::bad_alloc and what ends the call. Cost: a few comparisons for each corner if facets about
/// the first corner are right; otherwise the square of the corners, up to a bound that grows with the corners that were
/// given so far.
class PolygonCutter {
 public:
  /// corners: three or more indices of points, which are finite. facets: corners.size() - 2 facets, which are replaced.
  PolygonShape cut(std::span<const Vec3> points, std::span<const std::uint32_t> corners, std::span<Facet> facets);

 private:
  enum class Corner : std::uint8_t { reflex, flat, spike, convex };
  struct View {
    Projection projection;
    int likely_turn;  // orientation of the projected polygon; rounding may have decided it
    bool bent;
  };

  View view() const;
  bool is_fan(Projection projection) const;
  bool cut_ears(Projection projection, int turn, std::span<const std::uint32_t> corners, std::span<Facet> facets);

  int orient(std::size_t a, std::size_t b, std::size_t c) const {
    return turn_ * orient2d(points_[a], points_[b], points_[c], projection_);
  }
  Corner classify(std::size_t corner) const;
  bool lies_between(std::size_t p, std::size_t a, std::size_t b) const;
  bool same_place(std::size_t a, std::size_t b) const;
  bool is_ear(std::size_t corner) const;
  std::size_t next_ear(std::size_t from, std::size_t left);
  bool may_test(std::uint64_t tests);

  std::vector<Vec3> points_;  // points of the present polygon, corner by corner
  std::vector<std::size_t> next_, previous_, spikes_;
  std::vector<Corner> kind_;
  Projection projection_{0, 1};
  int turn_ = 1;
  std::uint64_t tests_left_ = std::uint64_t{1} << 26, tests_since_look_ = 0;
};

}  // namespace morula::detail
