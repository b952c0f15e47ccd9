// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/patch_depth.hpp"

#include <algorithm>
#include <cmath>

#include "parallel/interruption.hpp"

namespace morula::detail {

void ProjectedRegion::read(const PatchRegions& regions, std::size_t which, std::uint32_t patch,
                           const PatchFrame& frame) {
  const SurfaceRegion& s = regions.side[which];
  parts.clear();
  sides.clear();
  points.clear();
  if (stamp_.size() < regions.points.size()) stamp_.resize(regions.points.size(), now_);
  if (++now_ == 0) {
    std::fill(stamp_.begin(), stamp_.end(), 0);
    now_ = 1;
  }
  for (const FacetPart& part : parts_of(s, patch)) {
    const Triangle t = s.body->triangle(part.facet);
    const Triangle placed{frame(t[0] - regions.origin()), frame(t[1] - regions.origin()),
                          frame(t[2] - regions.origin())};
    Part read{part.facet, static_cast<std::uint32_t>(sides.size()), 0, {}, area_vector(placed), placed[0], 0, 0};
    for (std::uint32_t i = part.begin; i < part.end; ++i) {
      const BoundaryPiece& piece = s.pieces[i];
      const bool follows = i > part.begin && s.pieces[i - 1].to == piece.from;
      const Vec3 from = follows ? sides.back().to : frame(regions.points[piece.from]);
      // Both facets of an edge have its parts, in opposite directions; a segment is in one facet.
      sides.push_back({from, frame(regions.points[piece.to]), piece.weight, !piece.is_loop && piece.from > piece.to});
      if (stamp_[piece.from] != now_) {
        stamp_[piece.from] = now_;
        points.push_back(from);
      }
      const double z = sides.back().from.z, w = sides.back().to.z;
      if (i == part.begin) read.lower = read.upper = z;
      read.lower = std::min({read.lower, z, w});
      read.upper = std::max({read.upper, z, w});
      read.middle += sides.back().from;
    }
    read.end = static_cast<std::uint32_t>(sides.size());
    read.middle = read.middle / static_cast<double>(part.end - part.begin);
    parts.push_back(read);
  }
}

bool ProjectedRegion::meets(const Part& part, const Vec3& x, double& height) const {
  if (part.area_vector.z == 0) return false;
  int turns = 0;
  for (std::uint32_t i = part.begin; i < part.end; ++i) {
    const Side& side = sides[i];
    const bool from_below = side.from.y <= x.y, to_below = side.to.y <= x.y;
    if (from_below == to_below) continue;
    // Both facets of a side compute the same bits, so a point on it, or near it, is in one of them.
    const Vec3 &low = from_below ? side.from : side.to, &high = from_below ? side.to : side.from;
    const double turn = (high.x - low.x) * (x.y - low.y) - (high.y - low.y) * (x.x - low.x);
    if (turn > 0) turns += from_below ? side.weight : -side.weight;
  }
  if (turns == 0) return false;
  const Vec3& n = part.area_vector;
  height = part.point.z - (n.x * (x.x - part.point.x) + n.y * (x.y - part.point.y)) / n.z;
  // A part that is nearly parallel to the normal has heights between those of its points.
  height = std::clamp(height, part.lower, part.upper);
  return true;
}

// The height of b's region above a's is linear where neither has an edge, in the projection along the normal. So it is
// largest at a projected point of one region, over a part of the other, or where two projected sides cross.
double PatchDepth::of(ProjectedRegion& a, ProjectedRegion& b) {
  best_ = 0;
  std::sort(b.parts.begin(), b.parts.end(), [](const auto& p, const auto& q) { return p.upper > q.upper; });
  std::sort(a.parts.begin(), a.parts.end(), [](const auto& p, const auto& q) { return p.lower < q.lower; });
  std::sort(a.points.begin(), a.points.end(), [](const Vec3& p, const Vec3& q) { return p.z < q.z; });
  std::sort(b.points.begin(), b.points.end(), [](const Vec3& p, const Vec3& q) { return p.z > q.z; });
  try_points(a.points, b, 1);
  try_points(b.points, a, -1);
  try_sides(a, b);
  return best_;
}

// Depths that exceed the best by rounding alone are not searched for.
void PatchDepth::try_points(const std::vector<Vec3>& points, const ProjectedRegion& other, double sign) {
  constexpr double enough = 1 + 1e-13;
  for (const Vec3& x : points) {
    for (const ProjectedRegion::Part& part : other.parts) {
      const double most = sign > 0 ? part.upper - x.z : x.z - part.lower;
      if (!(most > best_ * enough)) break;
      double height;
      if (other.meets(part, x, height)) best_ = std::max(best_, sign * (height - x.z));
    }
  }
}

void PatchDepth::try_sides(const ProjectedRegion& a, const ProjectedRegion& b) {
  constexpr double enough = 1 + 1e-13;
  const auto lower = [](const ProjectedRegion::Side& s) { return std::min(s.from.z, s.to.z); };
  const auto upper = [](const ProjectedRegion::Side& s) { return std::max(s.from.z, s.to.z); };
  const auto list = [](const ProjectedRegion& region, std::vector<std::uint32_t>& order) {
    order.clear();
    for (std::uint32_t i = 0; i < region.sides.size(); ++i)
      if (!region.sides[i].is_twin) order.push_back(i);
  };
  list(a, order_a_);
  list(b, order_b_);
  std::sort(order_a_.begin(), order_a_.end(),
            [&](std::uint32_t p, std::uint32_t q) { return lower(a.sides[p]) < lower(a.sides[q]); });
  std::sort(order_b_.begin(), order_b_.end(),
            [&](std::uint32_t p, std::uint32_t q) { return upper(b.sides[p]) > upper(b.sides[q]); });
  InterruptPoller poll_interrupt(64);
  for (const std::uint32_t i : order_a_) {
    poll_interrupt();
    const ProjectedRegion::Side& s = a.sides[i];
    const Vec3 d = s.to - s.from;
    const double left = std::min(s.from.x, s.to.x), right = std::max(s.from.x, s.to.x);
    for (const std::uint32_t j : order_b_) {
      const ProjectedRegion::Side& r = b.sides[j];
      if (!(upper(r) - lower(s) > best_ * enough)) break;
      if (std::max(r.from.x, r.to.x) < left || std::min(r.from.x, r.to.x) > right) continue;
      const Vec3 e = r.to - r.from, w = r.from - s.from;
      const double turn = d.x * e.y - d.y * e.x;
      if (turn == 0) continue;
      const double t = (w.x * e.y - w.y * e.x) / turn, u = (w.x * d.y - w.y * d.x) / turn;
      if (t >= 0 && t <= 1 && u >= 0 && u <= 1) best_ = std::max(best_, (r.from.z + u * e.z) - (s.from.z + t * d.z));
    }
  }
}

}  // namespace morula::detail
