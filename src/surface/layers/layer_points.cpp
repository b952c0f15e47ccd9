// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/layers/layer_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <numbers>

namespace morula::detail {
namespace {

/// The vector b for which the sum of y x (b x y) over all points is `moment`. Points on one line allow only moments
/// across it, and one point none: the rest is left out.
Vec3 spin_for(std::span<const Vec3> arms, const Vec3& moment) {
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0, longest = 0;
  Vec3 line;
  for (const Vec3& y : arms) {
    xx += y.y * y.y + y.z * y.z, yy += y.z * y.z + y.x * y.x, zz += y.x * y.x + y.y * y.y;
    xy -= y.x * y.y, yz -= y.y * y.z, zx -= y.z * y.x;
    if (squared_length(y) > longest) longest = squared_length(y), line = y;
  }
  const double size = xx + yy + zz;  // twice the sum of squares
  if (!(size > 0)) return {};
  const Vec3 r0{xx, xy, zx}, r1{xy, yy, yz}, r2{zx, yz, zz};
  const double determinant = dot(r0, cross(r1, r2));
  if (!(determinant > 1e-12 * size * size * size)) {
    line = normalized(line);
    return (moment - line * dot(line, moment)) / (0.5 * size);
  }
  return (cross(r1, r2) * moment.x + cross(r2, r0) * moment.y + cross(r0, r1) * moment.z) / determinant;
}

SurfacePoint nearest_point(const LayerPoints::Side& side, const Vec3& point, const Vec3& origin) {
  SurfacePoint best{};
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t facet : side.facets) {
    const Triangle t = side.mesh->triangle(facet);
    const Vec3 gap = max(max(min(t[0], min(t[1], t[2])) - point, point - max(t[0], max(t[1], t[2]))), Vec3{});
    if (squared_length(gap) >= least) continue;
    const TrianglePoint found = closest_point(t, point);
    if (found.squared_distance < least)
      least = found.squared_distance, best = {facet, found.barycentric, origin + found.point};
  }
  return best;
}

}  // namespace

// x, y: from the center, across the normal.
void LayerPoints::find_shares(double x, double y, double radius) {
  const std::size_t count = rays_.size();
  const double squared = x * x + y * y, even = 1.0 / static_cast<double>(count);
  share_.assign(count, even);
  if (count == 1 || !(squared > 0)) return;
  const double outwards = squared < radius * radius ? squared / (radius * radius) : 1;
  for (double& share : share_) share *= 1 - outwards;
  if (count == 2) {
    const double along = 0.5 * x / std::sqrt(squared);
    share_[0] += outwards * (0.5 + along), share_[1] += outwards * (0.5 - along);
    return;
  }
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t next = (k + 1) % count;
    const double from = rays_[k].x * y - rays_[k].y * x, to = x * rays_[next].y - y * rays_[next].x;
    if (!(from >= 0 && to > 0)) continue;
    share_[k] += outwards * to / (from + to), share_[next] += outwards * from / (from + to);
    return;
  }
  share_[0] += outwards;  // on a ray, by rounding on neither side of it
}

void LayerPoints::add(std::span<const LayerSample> samples, double area, const Vec3& normal, const Vec3& first,
                      std::uint32_t count, const Side& a, const Side& b, const Vec3& origin,
                      std::vector<LayerPoint>& points) {
  sectors_.assign(count, {});
  rays_.clear();
  arms_.clear();
  for (std::uint32_t k = 0; k < count; ++k) {
    const SinCos angle = sin_cos(2 * std::numbers::pi * k / count);
    rays_.push_back({angle.cos, angle.sin, 0});
  }
  const Vec3 second = cross(normal, first);
  Vec3 center, force, moment;
  for (const LayerSample& sample : samples) center += sample.middle * sample.area;
  center = center / area;
  double squares = 0;
  for (const LayerSample& sample : samples) {
    const Vec3 arm = sample.middle - center;
    squares += std::max(0.0, sample.area) * (squared_length(arm) - dot(arm, normal) * dot(arm, normal));
  }
  const double radius = std::sqrt(std::max(0.0, squares / area));
  for (const LayerSample& sample : samples) {
    const Vec3 arm = sample.middle - center;
    force += sample.pressure;
    moment += cross(arm, sample.pressure);
    find_shares(dot(arm, first), dot(arm, second), radius);
    for (std::size_t k = 0; k < count; ++k) {
      sectors_[k].weighted += arm * (share_[k] * sample.area);
      sectors_[k].force += sample.pressure * share_[k];
      sectors_[k].area += share_[k] * sample.area;
      sectors_[k].volume += share_[k] * sample.volume;
    }
  }
  const std::size_t begin = points.size();
  Vec3 middle;
  double volume = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    const Sector& sector = sectors_[k];
    if (!(sector.area > 1e-9 * area)) {
      volume += sector.volume;
      continue;
    }
    const Vec3 arm = sector.weighted / sector.area, at = center + arm;
    points.push_back({k, origin + at, sector.force, sector.volume, 2 * sector.volume / sector.area,
                      nearest_point(a, at, origin), nearest_point(b, at, origin)});
    arms_.push_back(arm);
    middle += arm;
    force -= sector.force;
    moment -= cross(arm, sector.force);
  }
  if (arms_.empty()) return;
  // The rest of force and torque goes to all points as the least change: of sectors without a point, and of samples
  // that are not at their sector's point.
  const double share = 1.0 / static_cast<double>(arms_.size());
  middle *= share;
  moment -= cross(middle, force);
  for (Vec3& arm : arms_) arm -= middle;
  const Vec3 spin = spin_for(arms_, moment);
  for (std::size_t k = 0; k < arms_.size(); ++k) {
    points[begin + k].force += force * share + cross(spin, arms_[k]);
    points[begin + k].volume += volume * share;
  }
}

}  // namespace morula::detail
