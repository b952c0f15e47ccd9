// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/patch_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/box.hpp>
#include <morula/geometry/reproducible.hpp>
#include <numbers>

namespace morula::detail {
namespace {

double turn_of(const Vec3& d, const Vec3& x) {
  return d.x * x.y - d.y * x.x;
}

/// Coordinates in which the arms of points are well scaled: `along` the longest arm, `across` the part of an arm that
/// is farthest from it, `upright` across both; length and width are those arms' sizes.
struct ArmFrame {
  Vec3 along, across, upright;
  double length = 0, width = 0;

  explicit ArmFrame(const std::vector<Vec3>& arms) {
    for (const Vec3& y : arms)
      if (const double size = morula::length(y); size > length) length = size, along = y;
    if (!(length > 0)) return;
    along = along / length;
    for (const Vec3& y : arms)
      if (const Vec3 off = cross(along, y); morula::length(off) > width) width = morula::length(off), upright = off;
    // Arms on one line, up to rounding, allow no torque about it.
    if (!(width > 0x1p-45 * length)) {
      width = 0;
      return;
    }
    upright = upright / width;
    across = cross(upright, along);
  }
};

/// The vector b for which the sum of y x (b x y) over all points is `moment`; for points on one line, that for the part
/// of the moment across the line. In coordinates divided by length and width all entries of the matrix are at most the
/// number of points, and its determinant does not depend on the ratio of both; so the solution is as exact for a patch
/// of any shape.
Vec3 spin_for(const ArmFrame& frame, const std::vector<Vec3>& arms, const Vec3& moment) {
  if (!(frame.length > 0)) return {};
  if (frame.width == 0) {
    double square = 0;
    for (const Vec3& y : arms) square += squared_length(y);
    return (moment - frame.along * dot(frame.along, moment)) / square;
  }
  double uu = 0, vv = 0, ww = 0, uv = 0, vw = 0, wu = 0;
  for (const Vec3& y : arms) {
    const double u = dot(frame.along, y) / frame.length, v = dot(frame.across, y) / frame.width,
                 w = dot(frame.upright, y) / frame.width;
    uu += u * u, vv += v * v, ww += w * w, uv += u * v, vw += v * w, wu += w * u;
  }
  const double thin = (frame.width / frame.length) * (frame.width / frame.length);
  const Vec3 r0{vv + ww, -uv, -wu}, r1{-uv, uu + thin * ww, -thin * vw}, r2{-wu, -thin * vw, uu + thin * vv};
  const Vec3 m{dot(frame.along, moment) / frame.width, dot(frame.across, moment) / frame.length,
               dot(frame.upright, moment) / frame.length};
  const double determinant = dot(r0, cross(r1, r2));
  if (!(determinant > 0)) return {};
  const Vec3 b = (cross(r1, r2) * m.x + cross(r2, r0) * m.y + cross(r0, r1) * m.z) / determinant;
  return frame.along * (b.x / frame.width) + frame.across * (b.y / frame.length) + frame.upright * (b.z / frame.length);
}

/// The point of a region on the line through x along the normal, on the side of the other body; else a part's middle.
SurfacePoint surface_point(const ProjectedRegion& region, const Vec3& x, bool is_a, const PatchFrame& frame,
                           const Collider& body, const Vec3& origin) {
  const ProjectedRegion::Part* best = nullptr;
  double best_height = 0, height = 0;
  for (const ProjectedRegion::Part& part : region.parts)
    if (region.meets(part, x, height) && (!best || (is_a ? height < best_height : height > best_height)))
      best = &part, best_height = height;
  Vec3 at{x.x, x.y, best_height};
  if (!best) {
    double least = std::numeric_limits<double>::infinity();
    for (const ProjectedRegion::Part& part : region.parts) {
      const double squared = squared_distance(part.middle, x);
      if (squared < least) least = squared, best = &part, at = part.middle;
    }
  }
  if (!best) return {};
  const Vec3 local = frame.center + frame.first * at.x + frame.second * at.y + frame.normal * at.z;
  const TrianglePoint nearest = closest_point(body.triangle(best->facet), origin + local);
  return {best->facet, nearest.barycentric, nearest.point};
}

}  // namespace

std::size_t PatchPoints::sector_of(const Vec3& x) const {
  const std::size_t count = rays_.size();
  if (count == 1) return 0;
  if (count == 2) return turn_of(rays_[0], x) >= 0 ? 0 : 1;
  for (std::size_t k = 0; k < count; ++k)
    if (turn_of(rays_[k], x) >= 0 && turn_of(rays_[(k + 1) % count], x) < 0) return k;
  return 0;
}

// The triangle (c, p, q), all of it in one sector.
void PatchPoints::add_piece(const Vec3& c, const Vec3& p, const Vec3& q, double weight, bool is_a, bool is_below) {
  const Vec3 middle = (c + p + q) / 3.0, area = cross(p - c, q - c) * (0.5 * weight);
  Sector& sector = sectors_[sector_of((p + q) * 0.5)];
  sector.volume += middle.z * area.z;
  if (is_below) sector.below -= area.z;
  if (!is_a) return;
  sector.area -= area.z;
  sector.weighted -= middle * area.z;
}

void PatchPoints::collect(const ProjectedRegion& region, bool is_a) {
  for (const ProjectedRegion::Part& part : region.parts) {
    const Vec3& n = part.area_vector;
    const double size = length(n), rise = dot(n, part.point);
    // A facet nearly along the normal is not cut: its area across the normal is negligible.
    const bool steep = !(std::abs(n.z) > 1e-4 * size);
    const Vec3 c = steep ? region.sides[part.begin].from : Vec3{0, 0, rise / n.z};
    for (std::uint32_t i = part.begin; i < part.end; ++i) {
      const ProjectedRegion::Side& side = region.sides[i];
      cuts_.assign(1, 0.0);
      for (const Vec3& ray : rays_) {
        const double from = turn_of(ray, side.from), to = turn_of(ray, side.to);
        if (steep || rays_.size() == 1 || (from >= 0) == (to >= 0)) continue;
        const double t = from / (from - to);
        if (dot(ray, side.from + (side.to - side.from) * t) > 0 || rays_.size() == 2) cuts_.push_back(t);
      }
      cuts_.push_back(1.0);
      std::sort(cuts_.begin(), cuts_.end());
      Vec3 p = side.from;
      for (std::size_t k = 1; k < cuts_.size(); ++k) {
        const Vec3 q = k + 1 == cuts_.size() ? side.to : side.from + (side.to - side.from) * cuts_[k];
        add_piece(c, p, q, side.weight, is_a, n.z < 0);
        p = q;
      }
    }
  }
}

void PatchPoints::add(const ProjectedRegion& a, const ProjectedRegion& b, const PatchFrame& frame, std::uint32_t count,
                      const Wrench& wrench, const std::array<const Collider*, 2>& bodies, const Vec3& origin,
                      std::vector<PatchPoint>& points) {
  sectors_.assign(count, {});
  rays_.clear();
  for (std::uint32_t k = 0; k < count; ++k) {
    const SinCos angle = sin_cos(2 * std::numbers::pi * k / count);
    rays_.push_back({angle.cos, angle.sin, 0});
  }
  const auto middle_ray = [&](std::uint32_t k) { return normalized(rays_[k] + rays_[(k + 1) % count]); };
  collect(a, true);
  collect(b, false);

  double all = 0;
  for (const Sector& sector : sectors_) all += sector.area;
  const auto world = [&](const Vec3& v) { return frame.first * v.x + frame.second * v.y + frame.normal * v.z; };
  const std::size_t begin = points.size();
  std::vector<Vec3>& arms = arms_;
  arms.clear();
  Vec3 force = wrench.force, middle;
  double volume = 0;
  // Three points are to carry any torque: then sectors without area also get one, a quarter of its size away.
  const auto has_area = [&](const Sector& sector) { return sector.area > 1e-9 * all; };
  const bool fills = count >= 3 && std::count_if(sectors_.begin(), sectors_.end(), has_area) < 3;
  Box box;
  for (const Vec3& x : a.points) box.add(x);
  for (std::uint32_t k = 0; k < count; ++k) {
    Sector sector = sectors_[k];
    if (!has_area(sector)) {
      volume += sector.volume;
      if (!fills) continue;
      sector.area = sector.below = sector.volume = 0;
    }
    // Where facets of a face along the normal, too, the mean of positions with areas of both signs may be far away.
    const Vec3 mean = sector.area > 0 ? sector.weighted / sector.area : middle_ray(k) * (0.25 * box.diagonal());
    const Vec3 at = min(max(mean, box.lower), box.upper);
    const SurfacePoint on_a = surface_point(a, at, true, frame, *bodies[0], origin);
    const SurfacePoint on_b = surface_point(b, at, false, frame, *bodies[1], origin);
    points.push_back({k, origin + frame.center + world(at), frame.normal * sector.area, sector.volume,
                      sector.below > 0 ? sector.volume / sector.below : 0.0, on_a, on_b});
    arms.push_back(world(at));
    middle += arms.back();
  }
  if (arms.empty()) return;
  // Each force is along the normal, as the sector's area across it. The rest of force and torque, which comes from
  // sectors without a point and from parts of the region along the normal, goes to all points as the least change.
  const double share = 1.0 / static_cast<double>(arms.size());
  middle *= share;
  for (std::size_t k = 0; k < arms.size(); ++k) {
    PatchPoint& point = points[begin + k];
    point.volume += volume * share;
    arms[k] -= middle;
  }
  const ArmFrame scaled(arms);
  // Later rounds correct the rounding errors of the first.
  for (int round = 0; round < 3; ++round) {
    force = wrench.force;
    for (std::size_t k = 0; k < arms.size(); ++k) force -= points[begin + k].force;
    for (std::size_t k = 0; k < arms.size(); ++k) points[begin + k].force += force * share;
    Vec3 moment = wrench.moment - cross(middle, wrench.force);
    for (std::size_t k = 0; k < arms.size(); ++k) moment -= cross(arms[k], points[begin + k].force);
    const Vec3 spin = spin_for(scaled, arms, moment);
    for (std::size_t k = 0; k < arms.size(); ++k) points[begin + k].force += cross(spin, arms[k]);
  }
}

}  // namespace morula::detail
