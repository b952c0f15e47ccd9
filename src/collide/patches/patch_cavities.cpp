// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cavities of overlaps: which patch a surface inside a patch belongs to.
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/box.hpp>
#include <numbers>

#include "collide/patches/patch_regions.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

/// A piece with a point of its facet's part, as a triangle; their winding number is that of the surface.
struct PieceTriangle {
  std::uint32_t part, corner, from, to;
  int weight;
};

template <class Visit>
void each_triangle(PatchRegions& regions, const Visit& visit) {
  std::uint32_t parts = 0;
  for (const SurfaceRegion& s : regions.side)
    for (const FacetPart& part : s.parts) {
      ++parts;
      for (std::uint32_t i = part.begin; i < part.end; ++i) {
        const BoundaryPiece& piece = s.pieces[i];
        visit(regions.patch_at(piece),
              PieceTriangle{parts, s.pieces[part.begin].from, piece.from, piece.to, piece.weight});
      }
    }
}

/// The surface of a patch.
struct PatchSurface {
  double volume, rounding;               // rounding: the largest error of the volume
  std::vector<PieceTriangle> triangles;  // ascending by part
  Box box;

  void add(const PieceTriangle& t, const std::vector<Vec3>& points) {
    triangles.push_back(t);
    box.add(points[t.from]);
    box.add(points[t.to]);
  }
  double winding(const Vec3& point, const std::vector<Vec3>& points) const {
    double angle = 0;
    for (const PieceTriangle& t : triangles)
      angle += t.weight * solid_angle({points[t.corner], points[t.from], points[t.to]}, point);
    return angle / (4 * std::numbers::pi);
  }
  /// A point in front of the largest part, by a small share of that part's size.
  Vec3 point_before(const std::vector<Vec3>& points) const {
    Vec3 result;
    double largest = 0;
    for (std::size_t i = 0; i < triangles.size();) {
      Vec3 area, middle;
      double count = 0;
      for (const std::uint32_t part = triangles[i].part; i < triangles.size() && triangles[i].part == part; ++i) {
        const PieceTriangle& t = triangles[i];
        const Vec3& c = points[t.corner];
        area += cross(points[t.from] - c, points[t.to] - c) * (0.5 * t.weight);
        middle += points[t.from];
        ++count;
      }
      const double size = length(area);
      if (size > largest) largest = size, result = middle / count + area * (0x1p-10 / std::sqrt(size));
    }
    return result;
  }
};

/// The smallest patch around the cavity; the cavity itself if there is none.
std::uint32_t patch_around(std::uint32_t cavity, const std::vector<PatchSurface>& patches,
                           const std::vector<Vec3>& points) {
  const Vec3 point = patches[cavity].point_before(points);
  const bool is_certain = patches[cavity].volume < -patches[cavity].rounding;
  std::vector<std::uint32_t> near, all;
  for (std::uint32_t p = 0; p < patches.size(); ++p) {
    if (!(patches[p].volume > 0)) continue;
    all.push_back(p);
    if (squared_distance(patches[p].box, point) == 0) near.push_back(p);
  }
  if (is_certain && near.size() == 1) return near[0];
  std::uint32_t around = cavity, likely = cavity;
  double most = -std::numeric_limits<double>::infinity();
  for (const std::uint32_t p : near.empty() && is_certain ? all : near) {
    check_interrupt();
    const double winding = patches[p].winding(point, points);
    if (winding > most) most = winding, likely = p;
    if (winding > 0.5 && (around == cavity || patches[p].volume < patches[around].volume)) around = p;
  }
  return around == cavity && is_certain ? likely : around;
}

}  // namespace

// A set of negative volume bounds a cavity of the overlap: a component that no loop crosses, a cavity of one body that
// overlaps one of the other, or a hole whose rim join_holes() could not place. It belongs to the smallest patch around
// it; by rounding there may be none, then to the one whose winding number is largest. So no decision that is made in
// double changes the sum of all volumes. A volume that is negative by rounding alone is no cavity: surfaces that touch.
void PatchRegions::join_cavities() {
  if (patch_count <= 1) return;
  // The chain of a patch in one facet is closed, so its area vector does not depend on the point it is summed about.
  volumes_.assign(patch_count, {0, 0});
  each_triangle(*this, [&](std::uint32_t patch, const PieceTriangle& t) {
    const Vec3 &c = points[t.corner], p = points[t.from] - c, q = points[t.to] - c;
    volumes_[patch].first += t.weight / 6.0 * dot(c, cross(p, q));
    // Six products of three coordinates, each with a few errors of 2^-53, and a factor of 10 to spare.
    volumes_[patch].second += 0x1p-44 * std::abs(t.weight) * max_norm(c) * max_norm(p) * max_norm(q);
  });
  if (std::none_of(volumes_.begin(), volumes_.end(), [](const auto& volume) { return volume.first < 0; })) return;
  std::vector<PatchSurface> patches;
  for (const auto& [volume, rounding] : volumes_) patches.push_back({volume, rounding, {}, {}});
  each_triangle(*this, [&](std::uint32_t patch, const PieceTriangle& t) { patches[patch].add(t, points); });
  std::vector<std::uint32_t> target(patch_count);
  for (std::uint32_t patch = 0; patch < patch_count; ++patch) {
    target[patch] = patch;
    if (!(patches[patch].volume < 0)) continue;
    check_interrupt();
    target[patch] = patch_around(patch, patches, points);
    if (target[patch] != patch) crossing_counts[target[patch]] += crossing_counts[patch];
  }
  for (std::uint32_t& p : patch_of_)
    if (p != 0xffffffffu) p = target[p];
}

}  // namespace morula::detail
