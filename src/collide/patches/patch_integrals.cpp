// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/patch_integrals.hpp"

#include <algorithm>
#include <cmath>

namespace morula::detail {

std::span<const FacetPart> parts_of(const SurfaceRegion& region, std::uint32_t patch) {
  const auto by_patch = [](const FacetPart& p, const FacetPart& q) { return p.patch < q.patch; };
  const auto [begin, end] =
      std::equal_range(region.parts.begin(), region.parts.end(), FacetPart{patch, 0, 0, 0}, by_patch);
  return {begin, end};
}

namespace {
/// Between the length and twice the length.
double size_of(const Vec3& v) {
  return std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
}
}  // namespace

Vec3 centroid_of(const PatchIntegrals& sums) {
  // mutant patches-centroid-of-rounding: `1024 * sums.volume_rounding` -> `0`
  const double certain = 1024 * sums.volume_rounding;
  const double share = sums.volume > certain ? 1 : sums.volume > 0 ? sums.volume / certain : 0;
  Vec3 result;
  if (share > 0) result += sums.first_moment * (share / sums.volume);
  if (share < 1 && sums.surface > 0) result += sums.surface_moment * ((1 - share) / sums.surface);
  return min(max(result, sums.box.lower), sums.box.upper);
}

PatchIntegrals PatchIntegrator::integrate(const PatchRegions& regions, std::uint32_t patch,
                                          std::array<SideResult, 2>& results) {
  PatchIntegrals sums;
  ++now_;
  for (std::size_t which = 0; which < 2; ++which) {
    const SurfaceRegion& s = regions.side[which];
    const auto parts = parts_of(s, patch);
    if (which == 0 || parts_of(regions.side[0], patch).empty())
      if (!parts.empty()) sums.reference = regions.points[s.pieces[parts.front().begin].from];
    stamp_[which].resize(s.body->vertex_count());
    place_[which].resize(s.body->vertex_count());
    SideResult& result = results[which];
    const std::size_t first = result.gradients.size();
    result.facets_begin.push_back(result.facets.size());
    result.gradients_begin.push_back(first);
    for (const FacetPart& part : parts) add(regions, which, part, sums, result);
    std::sort(result.gradients.begin() + static_cast<std::ptrdiff_t>(first), result.gradients.end(),
              [](const VertexGradient& p, const VertexGradient& q) { return p.vertex < q.vertex; });
  }
  return sums;
}

void PatchIntegrator::add(const PatchRegions& regions, std::size_t which, const FacetPart& part, PatchIntegrals& sums,
                          SideResult& result) {
  const SurfaceRegion& s = regions.side[which];
  const Facet& corners = s.body->mesh_facets()[part.facet];
  const Triangle t = s.body->triangle(part.facet);
  const Vec3 corner = t[0] - regions.origin();
  const Vec3 u = t[1] - t[0], v = t[2] - t[0], normal = cross(u, v);
  const double square = squared_length(normal);
  const Vec3 unit = square > 0 ? normal / std::sqrt(square) : Vec3{};
  // Barycentric coordinates of x are 1/3 each for a facet whose normal vanishes, and so does its area.
  const Vec3 first = square > 0 ? cross(v, normal) / square : Vec3{},
             second = square > 0 ? cross(normal, u) / square : Vec3{};

  const std::uint32_t anchor = s.pieces[part.begin].from;
  const Vec3 c = regions.points[anchor], arm = c - sums.reference;
  const double far = size_of(arm) + size_of(c);
  Vec3 area_vector;
  std::array<Vec3, 3> gradient{};
  for (std::uint32_t i = part.begin; i < part.end; ++i) {
    const BoundaryPiece& piece = s.pieces[i];
    sums.box.add(regions.points[piece.from] - sums.reference);
    if (piece.from == anchor || piece.to == anchor) continue;  // a triangle without area
    const Vec3 p = regions.points[piece.from] - c, q = regions.points[piece.to] - c;
    const Vec3 area = cross(p, q) * (0.5 * piece.weight), middle = (p + q) / 3.0;
    area_vector += area;
    sums.moment[which] += cross(arm + middle, area);
    sums.first_moment += (arm * 3.0 + p + q) * (dot(arm, area) / 12.0);
    sums.surface_moment += (arm + middle) * size_of(area);
    sums.surface += size_of(area);
    sums.volume_rounding += 0x1p-50 * size_of(area) * far;
    const Vec3 from_corner = c + middle - corner;
    // u is mapped to (1, 0), v to (0, 1).
    const double b1 = square > 0 ? dot(first, from_corner) : 1.0 / 3,
                 b2 = square > 0 ? dot(second, from_corner) : 1.0 / 3;
    gradient[1] += area * b1;
    gradient[2] += area * b2;
  }
  gradient[0] = area_vector - gradient[1] - gradient[2];
  sums.volume += dot(arm, area_vector) / 3.0;
  sums.area_vector[which] += area_vector;
  sums.area[which] += length(area_vector);
  // Each piece adds the product of two lengths below the size, of which each has an error of a few times 2^-53 of it.
  sums.wound_area[which] += dot(area_vector, unit);
  const double size = squared_length(corner) + squared_length(u) + squared_length(v);
  sums.rounding[which] += 0x1p-40 * static_cast<double>(part.end - part.begin) * size;
  result.facets.push_back({part.facet, area_vector});
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = corners[k];
    if (stamp_[which][vertex] != now_) {
      stamp_[which][vertex] = now_;
      place_[which][vertex] = result.gradients.size();
      result.gradients.push_back({vertex, {}});
    }
    result.gradients[place_[which][vertex]].gradient += gradient[k];
  }
}

}  // namespace morula::detail
