// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "query/oriented_boxes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace morula::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::array<std::array<float, 3>, 3> coordinates{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

Vec3 row(const std::array<float, 3>& axis) {
  return {static_cast<double>(axis[0]), static_cast<double>(axis[1]), static_cast<double>(axis[2])};
}

Vec3 longest_side(const Triangle& t) {
  Vec3 longest;
  for (int k = 0; k < 3; ++k)
    if (const Vec3 side = t[(k + 1) % 3] - t[k]; squared_length(side) > squared_length(longest)) longest = side;
  return longest;
}

// The coordinate along which a vector is shortest.
Vec3 least_axis(const Vec3& v) {
  const Vec3 a{std::abs(v.x), std::abs(v.y), std::abs(v.z)};
  if (a.x <= a.y && a.x <= a.z) return {1, 0, 0};
  return a.y <= a.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
}

}  // namespace

Units::Units(const Box& box)
    : origin(box.center()), largest_coordinate(std::max(max_norm(box.lower), max_norm(box.upper))) {
  constexpr int most = 200;  // a smaller mesh counts as a point in all queries
  const double size = max_norm(box.extent());
  if (size > 0) scale = std::ldexp(1.0, std::clamp(-1 - std::ilogb(size), -most, most));
}

// The error of a coordinate is a share of its distance from the center: heights are off by 2^-21.9 of the reach, ends
// of a box by 2^-24 as they are rounded, together less than 2^-21. Computed closest points are off by less than 2^-48
// of their coordinates. For meshes that are almost a point, the pad exceeds the range of float, and the box then holds
// all points.
BoxMaker::BoxMaker(const Units& units, const Box& all) : units_(units) {
  const Vec3 lower = units.of(all.lower), upper = units.of(all.upper), middle = (lower + upper) * 0.5;
  // The number is the same in both types, of 23 digits: GCC 12 may remove a conversion from double to float and back.
  for (int c = 0; c < 3; ++c) {
    center_[c] = static_cast<double>(static_cast<int>(std::clamp(middle[c], -1.0, 1.0) * 0x1p23)) * 0x1p-23;
    boxes_.center[c] = static_cast<float>(center_[c]);
  }
  boxes_.far_share = 1;
  constexpr double everything = 0x1p60;
  // mutant box-pad-of-reach: `0x1p-21` -> `0`
  pad_ = 0x1p-21 * length(max(center_ - lower, upper - center_)) +
         // mutant box-pad-of-coordinates: `0x1p-44` -> `0`
         std::min(0x1p-44 * units.largest_coordinate * units.scale, everything);
}

void BoxMaker::set(int k, const Box& box) {
  set(k, coordinates, {units_.of(box.lower) - center_, units_.of(box.upper) - center_});
}

void BoxMaker::set(int k, std::span<const Triangle> patch, const Vec3& area_vector) {
  const Axes axes = axes_along(patch, area_vector);
  set(k, axes, along(axes, patch));
}

FacetBoxes BoxMaker::facets_of(int k, std::span<const Triangle> patch) const {
  Axes axes{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t c = 0; c < 3; ++c) axes[a][c] = boxes_.axis[a][c][k];
  FacetBoxes facets{};
  for (std::size_t f = 0; f < patch.size(); ++f) {
    const Box box = along(axes, patch.subspan(f, 1));
    for (int a = 0; a < 3; ++a) {
      facets.lower[a][f] = static_cast<float>(box.lower[a] - pad_);
      facets.upper[a][f] = static_cast<float>(box.upper[a] + pad_);
    }
  }
  return facets;
}

// The box in Units, from the center. Heights are summed up in mesh coordinates, off by less than 2^-50 of the largest.
Box BoxMaker::along(const Axes& axes, std::span<const Triangle> patch) const {
  const Vec3 rows[3] = {row(axes[0]), row(axes[1]), row(axes[2])};
  Vec3 lower{infinity, infinity, infinity}, upper = -lower;
  for (const Triangle& t : patch)
    for (const Vec3& corner : t) {
      const Vec3 heights{dot(rows[0], corner), dot(rows[1], corner), dot(rows[2], corner)};
      lower = min(lower, heights);
      upper = max(upper, heights);
    }
  const Vec3 center = center_ + units_.origin * units_.scale;
  const Vec3 start{dot(rows[0], center), dot(rows[1], center), dot(rows[2], center)};
  return {lower * units_.scale - start, upper * units_.scale - start};
}

void BoxMaker::set(int k, const Axes& axes, const Box& box) {
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t c = 0; c < 3; ++c) boxes_.axis[a][c][k] = axes[a][c];
    boxes_.lower[a][k] = static_cast<float>(box.lower[static_cast<int>(a)] - pad_);
    boxes_.upper[a][k] = static_cast<float>(box.upper[static_cast<int>(a)] + pad_);
  }
  // mutant box-far-share-of-own-axes: `if (axes != coordinates) boxes_.far_share = 1 - 0x1p-20f` -> ``
  if (axes != coordinates) boxes_.far_share = 1 - 0x1p-20f;
}

// Rows that are unit and at right angles up to 2^-22: before they are rounded to floats, up to 2^-30, since no terms
// nearly cancel; after that three coordinates of two rows are off by 2^-25 each.
BoxMaker::Axes BoxMaker::axes_along(std::span<const Triangle> patch, const Vec3& area_vector) const {
  constexpr double least_size = 1e-140;  // below, squares lose digits
  const double size = length(area_vector);
  if (!(size > least_size)) return coordinates;
  const Vec3 normal = area_vector / size;
  // Patches are cut along the coordinates, and the boxes of adjacent patches overlap least along these.
  const Vec3 way = patch.size() == 1 ? longest_side(patch[0]) : least_axis(normal);
  const Vec3 in_plane = way - normal * dot(way, normal);
  const double extent = length(in_plane);
  // mutant box-direction-along-the-facet: `extent > 0x1p-20 * length(way)` -> `true`
  if (!(extent > least_size && extent > 0x1p-20 * length(way))) return coordinates;
  const Vec3 along = in_plane / extent, across = cross(normal, along);
  const Vec3 rows[3] = {along, across, normal};
  Axes axes{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t c = 0; c < 3; ++c) axes[a][c] = static_cast<float>(rows[a][static_cast<int>(c)]);
  return axes;
}

// Heights are off by 2^-50 |q|, and |q| is hardly more than the distance. Own axes of a box lengthen by 1.5 * 2^-22,
// the axes of the coordinates not at all.
template <class Boxes>
double FarDistances::squared(const OrientedBoxes& axes, int k, const Boxes& boxes, int which) const {
  // mutant box-far-share: `(1 - 0x1p-44) * static_cast` -> `static_cast`
  const double sure = (1 - 0x1p-44) * static_cast<double>(axes.far_share);
  const Vec3 q = p_ - Vec3{static_cast<double>(axes.center[0]), static_cast<double>(axes.center[1]),
                           static_cast<double>(axes.center[2])};
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    double height = 0;
    for (int c = 0; c < 3; ++c) height += q[c] * static_cast<double>(axes.axis[a][c][k]);
    const double gap = std::max({static_cast<double>(boxes.lower[a][which]) - height,
                                 height - static_cast<double>(boxes.upper[a][which]), 0.0});
    sum += gap * gap;
  }
  return sum * sure;
}

void FarDistances::operator()(const OrientedBoxes& boxes, double* result) const {
  for (int k = 0; k < OrientedBoxes::count; ++k) result[k] = squared(boxes, k, boxes, k);
}

void FarDistances::operator()(const OrientedBoxes& boxes, int k, const FacetBoxes& facets, double* result) const {
  for (int f = 0; f < OrientedBoxes::count; ++f) result[f] = squared(boxes, k, facets, f);
}

}  // namespace morula::detail
