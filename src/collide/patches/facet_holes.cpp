// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/facet_holes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace morula::detail {

// Splits the pieces into polygons and holes: connected sets of pieces of positive and of negative area.
void FacetHoles::read(std::span<const BoundaryPiece> pieces, std::span<const Vec3> points) {
  ends_.clear();
  for (const BoundaryPiece& piece : pieces) ends_.insert(ends_.end(), {piece.from, piece.to});
  std::sort(ends_.begin(), ends_.end());
  ends_.erase(std::unique(ends_.begin(), ends_.end()), ends_.end());
  const auto place = [&](std::uint32_t e) {
    return static_cast<std::uint32_t>(std::lower_bound(ends_.begin(), ends_.end(), e) - ends_.begin());
  };
  sets_.clear();
  for (std::size_t k = 0; k < ends_.size(); ++k) sets_.add();
  for (const BoundaryPiece& piece : pieces) sets_.join(place(piece.from), place(piece.to));
  by_polygon_.clear();
  for (std::uint32_t i = 0; i < pieces.size(); ++i) by_polygon_.emplace_back(sets_.root(place(pieces[i].from)), i);
  std::sort(by_polygon_.begin(), by_polygon_.end());

  polygons_.clear();
  holes_.clear();
  for (std::uint32_t i = 0; i < by_polygon_.size();) {
    const std::uint32_t root = by_polygon_[i].first;
    constexpr double far = std::numeric_limits<double>::infinity();
    Polygon polygon{0, {far, far}, {-far, -far}, ends_[root], i, i};
    const Vec3& c = points[ends_[root]];
    for (; i < by_polygon_.size() && by_polygon_[i].first == root; ++i) {
      const BoundaryPiece& piece = pieces[by_polygon_[i].second];
      const Vec3 p = points[piece.from] - c, q = points[piece.to] - c;
      polygon.area += outward_ * piece.weight * (p[axes_[0]] * q[axes_[1]] - p[axes_[1]] * q[axes_[0]]);
      for (const std::uint32_t end : {piece.from, piece.to})
        for (int k = 0; k < 2; ++k) {
          polygon.lower[k] = std::min(polygon.lower[k], points[end][axes_[k]]);
          polygon.upper[k] = std::max(polygon.upper[k], points[end][axes_[k]]);
        }
    }
    polygon.end = i;
    if (polygon.area < 0) holes_.push_back(polygon);
    if (polygon.area > 0) polygons_.push_back(polygon);
  }
}

bool FacetHoles::holds(const Polygon& polygon, const Vec3& x, std::span<const BoundaryPiece> pieces,
                       std::span<const Vec3> points) const {
  const auto [first, second] = axes_;
  bool inside = false;
  for (std::uint32_t i = polygon.begin; i < polygon.end; ++i) {
    const BoundaryPiece& piece = pieces[by_polygon_[i].second];
    const Vec3 &p = points[piece.from], &q = points[piece.to];
    if ((p[second] <= x[second]) == (q[second] <= x[second])) continue;
    const double at = p[first] + (q[first] - p[first]) * ((x[second] - p[second]) / (q[second] - p[second]));
    if (at > x[first]) inside = !inside;
  }
  return inside;
}

// A sweep along the longer axis: polygons are open while their boxes contain the hole's coordinate.
std::span<const std::pair<std::uint32_t, std::uint32_t>> FacetHoles::find(std::span<const BoundaryPiece> pieces,
                                                                          std::span<const Vec3> points,
                                                                          const Vec3& normal) {
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  const int axis = x > y && x > z ? 0 : y > z ? 1 : 2;
  axes_[0] = (axis + 1) % 3, axes_[1] = (axis + 2) % 3;
  outward_ = normal[axis] < 0 ? -1 : 1;
  read(pieces, points);
  found_.clear();
  if (holes_.empty()) return found_;

  double extent[2];
  for (int k = 0; k < 2; ++k) {
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    for (const Polygon& hole : holes_) lower = std::min(lower, hole.lower[k]), upper = std::max(upper, hole.upper[k]);
    extent[k] = upper - lower;
  }
  const int along = extent[0] > extent[1] ? 0 : 1, across = 1 - along;
  const auto start = [&](const Polygon& hole) { return points[hole.element][axes_[along]]; };
  std::sort(polygons_.begin(), polygons_.end(),
            [&](const Polygon& p, const Polygon& q) { return p.lower[along] < q.lower[along]; });
  std::sort(holes_.begin(), holes_.end(), [&](const Polygon& p, const Polygon& q) { return start(p) < start(q); });
  open_.clear();
  auto next = polygons_.begin();
  for (const Polygon& hole : holes_) {
    const Vec3& point = points[hole.element];
    for (; next != polygons_.end() && next->lower[along] <= start(hole); ++next) open_.push_back(&*next);
    std::erase_if(open_, [&](const Polygon* p) { return p->upper[along] < start(hole); });
    const Polygon* around = nullptr;
    for (const Polygon* p : open_)
      if (p->lower[across] <= point[axes_[across]] && point[axes_[across]] <= p->upper[across] &&
          (!around || p->area < around->area) && holds(*p, point, pieces, points))
        around = p;
    if (around) found_.emplace_back(hole.element, around->element);
  }
  return found_;
}

}  // namespace morula::detail
