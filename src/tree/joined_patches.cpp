// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "tree/joined_patches.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "geometry/exact_predicates.hpp"

namespace morula::detail {
namespace {

// Areas are doubled, so that a facet has 1. If a cut ends at another, its end is off that one by a rounding of its
// coordinates, and the areas of patches are rounded sums: both far below this share, which is far below the precision
// that users of areas need.
// mutant joined-patches-area: `48` -> `20`
constexpr double rounding_of_area = 0x1p-48;
// Patches that touch have boxes that touch, up to the same rounding.
constexpr double rounding_of_corner = 0x1p-50;

// b1 and b2 are coordinates of the facet's plane: b0 is the remainder to 1.
constexpr Projection without_b0{1, 2};

Vec3 as_vector(const Barycentric& b) {
  return {b[0], b[1], b[2]};
}

// On a common edge of the facet points are on one line whatever the rounding of the other two coordinates.
bool turns_left(const Barycentric& a, const Barycentric& b, const Barycentric& c) {
  for (std::size_t k = 0; k < 3; ++k)
    // mutant joined-patches-edge: `if (a[k] == 0 && b[k] == 0 && c[k] == 0) return false` -> ``
    if (a[k] == 0 && b[k] == 0 && c[k] == 0) return false;
  // mutant joined-patches-lose-corners: `0;` -> `0 && b[1] > 0x1p-10;`
  return orient2d(as_vector(a), as_vector(b), as_vector(c), without_b0) > 0;
}

double twice_area(const Barycentric& a, const Barycentric& b, const Barycentric& c) {
  return (b[1] - a[1]) * (c[2] - a[2]) - (c[1] - a[1]) * (b[2] - a[2]);
}

double area_of(std::span<const Barycentric> all, std::span<const std::uint32_t> corners) {
  double area = 0;
  for (std::size_t k = 2; k < corners.size(); ++k)
    area += twice_area(all[corners[0]], all[corners[k - 1]], all[corners[k]]);
  return area;
}

bool boxes_touch(const PatchJoiner::Polygon& a, const PatchJoiner::Polygon& b) {
  const auto touch = [](double lowest_a, double highest_a, double lowest_b, double highest_b) {
    return lowest_a <= highest_b + rounding_of_corner && lowest_b <= highest_a + rounding_of_corner;
  };
  return touch(a.lowest_b1, a.highest_b1, b.lowest_b1, b.highest_b1) &&
         touch(a.lowest_b2, a.highest_b2, b.lowest_b2, b.highest_b2);
}

}  // namespace

void PatchJoiner::clear() {
  corners_.clear();
  polygons_.clear();
}

void PatchJoiner::add(std::span<const Barycentric> corners) {
  std::vector<std::uint32_t> numbers;
  for (const Barycentric& b : corners) {
    numbers.push_back(static_cast<std::uint32_t>(corners_.size()));
    corners_.push_back(b);
  }
  const double area = area_of(corners_, numbers);
  polygons_.push_back(polygon_of(std::move(numbers), area));
}

std::span<const PatchJoiner::Polygon> PatchJoiner::join() {
  if (polygons_.size() < 2 || join_all()) return polygons_;
  // A polygon that has grown is tried again with all others.
  for (bool again = true; again;) {
    again = false;
    for (std::size_t first = 0; first < polygons_.size(); ++first)
      for (std::size_t second = first + 1; second < polygons_.size(); ++second)
        if (join_two(first, second)) again = true, second = first;
  }
  return polygons_;
}

bool PatchJoiner::join_all() {
  points_.clear();
  double area = 0;
  for (const Polygon& polygon : polygons_) {
    take_corners(polygon);
    area += polygon.area;
  }
  const double hull = take_hull();
  if (hull - area > rounding_of_area) return false;
  Polygon all = polygon_of(hull_, hull);
  polygons_.clear();
  polygons_.push_back(std::move(all));
  return true;
}

bool PatchJoiner::join_two(std::size_t first, std::size_t second) {
  const Polygon &a = polygons_[first], &b = polygons_[second];
  if (!boxes_touch(a, b)) return false;
  points_.clear();
  take_corners(a);
  take_corners(b);
  const double hull = take_hull();
  if (hull - (a.area + b.area) > rounding_of_area) return false;
  polygons_[first] = polygon_of(hull_, hull);
  polygons_.erase(polygons_.begin() + static_cast<std::ptrdiff_t>(second));
  return true;
}

void PatchJoiner::take_corners(const Polygon& polygon) {
  points_.insert(points_.end(), polygon.corners.begin(), polygon.corners.end());
}

// The convex hull of points_, counter-clockwise from the least (b1, b2), with the point added first among equals: a
// chain below and one above [andrew1979]. Signs are exact, so no point is left outside. Returns twice its area;
// infinity if all points are on one line, which is no polygon.
double PatchJoiner::take_hull() {
  const auto coordinates = [&](std::uint32_t i) { return std::pair(corners_[i][1], corners_[i][2]); };
  std::sort(points_.begin(), points_.end(), [&](std::uint32_t i, std::uint32_t j) {
    return std::pair(coordinates(i), i) < std::pair(coordinates(j), j);
  });
  const auto are_equal = [&](std::uint32_t i, std::uint32_t j) { return coordinates(i) == coordinates(j); };
  points_.erase(std::unique(points_.begin(), points_.end(), are_equal), points_.end());
  hull_.clear();
  const auto add = [&](std::uint32_t point, std::size_t chain_begin) {
    while (hull_.size() >= chain_begin + 2 &&
           !turns_left(corners_[hull_[hull_.size() - 2]], corners_[hull_.back()], corners_[point]))
      hull_.pop_back();
    hull_.push_back(point);
  };
  for (const std::uint32_t point : points_) add(point, 0);
  const std::size_t below = hull_.size();
  for (std::size_t k = points_.size() - 1; k-- > 0;) add(points_[k], below - 1);
  if (hull_.size() > 1) hull_.pop_back();
  // mutant joined-patches-on-a-line: `hull_.size() < 3 ? std::numeric_limits<double>::infinity() : area_of` -> `area_of`
  return hull_.size() < 3 ? std::numeric_limits<double>::infinity() : area_of(corners_, hull_);
}

PatchJoiner::Polygon PatchJoiner::polygon_of(std::vector<std::uint32_t> corners, double area) const {
  Polygon polygon{std::move(corners), area, 1, 0, 1, 0};
  for (const std::uint32_t corner : polygon.corners) {
    const Barycentric& b = corners_[corner];
    polygon.lowest_b1 = std::min(polygon.lowest_b1, b[1]);
    polygon.highest_b1 = std::max(polygon.highest_b1, b[1]);
    polygon.lowest_b2 = std::min(polygon.lowest_b2, b[2]);
    polygon.highest_b2 = std::max(polygon.highest_b2, b[2]);
  }
  return polygon;
}

}  // namespace morula::detail
