// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cavities of overlaps: which patch a surface inside a patch belongs to.
#include <cmath>
#include <limits>
#include <numbers>

#include "collide/patches/patch_regions.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {

// The chain of a patch in one facet is closed, so its area vector does not depend on the point it is summed about.
const std::vector<double>& PatchRegions::volumes_of_patches() {
  volumes_.assign(patch_count, 0.0);
  for (SurfaceRegion& s : side)
    for (const FacetPart& part : s.parts) {
      const Vec3& c = points[s.pieces[part.begin].from];
      for (std::uint32_t i = part.begin; i < part.end; ++i) {
        const BoundaryPiece& piece = s.pieces[i];
        volumes_[patch_at(piece)] += piece.weight / 6.0 * dot(c, cross(points[piece.from] - c, points[piece.to] - c));
      }
    }
  return volumes_;
}

double PatchRegions::winding_of(std::uint32_t patch, const Vec3& point) {
  double angle = 0;
  for (SurfaceRegion& s : side)
    for (const FacetPart& part : s.parts)
      for (std::uint32_t i = part.begin; i < part.end; ++i) {
        const BoundaryPiece& piece = s.pieces[i];
        if (patch_at(piece) != patch) continue;
        angle += piece.weight *
                 solid_angle({points[s.pieces[part.begin].from], points[piece.from], points[piece.to]}, point);
      }
  return angle / (4 * std::numbers::pi);
}

// In front of the largest part of its surface, by a small share of that part's size.
Vec3 PatchRegions::point_of_cavity(std::uint32_t patch) {
  Vec3 result;
  double largest = 0;
  for (SurfaceRegion& s : side)
    for (const FacetPart& part : s.parts) {
      const Vec3& c = points[s.pieces[part.begin].from];
      Vec3 area, middle;
      double count = 0;
      for (std::uint32_t i = part.begin; i < part.end; ++i) {
        const BoundaryPiece& piece = s.pieces[i];
        if (patch_at(piece) != patch) continue;
        area += cross(points[piece.from] - c, points[piece.to] - c) * (0.5 * piece.weight);
        middle += points[piece.from];
        ++count;
      }
      const double size = length(area);
      if (size > largest) largest = size, result = middle / count + area * (0x1p-10 / std::sqrt(size));
    }
  return result;
}

// A set of negative volume bounds a cavity of the overlap: a component that no loop crosses, a cavity of one body that
// overlaps one of the other, or a hole whose rim join_holes() could not place. It belongs to the smallest patch around
// it; by rounding there may be none, then to the one whose winding number is largest. So no decision that is made in
// double changes the sum of all volumes.
void PatchRegions::join_cavities() {
  if (patch_count <= 1) return;
  const std::vector<double>& volumes = volumes_of_patches();
  for (std::uint32_t patch = 0; patch < patch_count; ++patch) {
    if (!(volumes[patch] < 0)) continue;
    check_interrupt();
    const Vec3 point = point_of_cavity(patch);
    std::uint32_t around = patch, likely = patch;
    double most = -std::numeric_limits<double>::infinity();
    for (std::uint32_t p = 0; p < patch_count; ++p) {
      if (!(volumes[p] > 0)) continue;
      const double winding = winding_of(p, point);
      if (winding > most) most = winding, likely = p;
      if (winding > 0.5 && (around == patch || volumes[p] < volumes[around])) around = p;
    }
    if (around == patch) around = likely;
    if (around == patch) continue;
    crossing_counts[around] += crossing_counts[patch];
    for (std::uint32_t& p : patch_of_)
      if (p == patch) p = around;
  }
}

}  // namespace morula::detail
