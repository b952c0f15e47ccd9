// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// The facets that nearest_facet may leave out. Let M be the largest |coordinate|, about the leaf's center, of its
// corners and of the point; A the same in the body's own coordinates. Coordinates in float are off by less than 2^-24 M
// + 2^-53 A, so a gap from a box, taken in float, is off by 2^-21 M + 2^-51 A and 2^-22 of itself. The result of
// closest_point() is a sum of corners with shares of at least 0 and together at most 1, whatever the facet's shape, so
// it is in the facet's box up to rounding, below 2^-50 A. nearest_facet leaves out the facets whose gap, less 2^-18 of
// itself, exceeds the least distance by 2^-18 M + 2^-48 A. It leaves out none where squares of floats may overflow or
// underflow.
#include "collide/facets/contact_surface.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "collide/facets/corner_reader.hpp"

namespace morula::detail {
namespace {

struct Nearest {
  TrianglePoint point{{}, {}, std::numeric_limits<double>::infinity()};
  std::uint32_t facet = 0xffffffffu;

  void look_at(const CornerReader& corners, std::uint32_t candidate, const Vec3& p) {
    const TrianglePoint found = closest_point(corners(candidate), p);
    const bool nearer = found.squared_distance < point.squared_distance ||
                        (found.squared_distance == point.squared_distance && candidate < facet);
    if (nearer) point = found, facet = candidate;
  }
};

Vec3 in_coordinates_of(const Collider& collider, const Vec3& point) {
  return collider.transform().inverse_rotate(point - collider.transform().translation);
}
SurfacePoint placed(const Collider& collider, const Nearest& nearest) {
  return {nearest.facet, nearest.point.barycentric, collider.transform()(nearest.point.point)};
}

void search(LeafSurfaces& surfaces, const LeafSurfaces::Leaf& leaf, const Vec3& p, std::vector<float>& gaps,
            Nearest& nearest) {
  const CornerReader corners(*surfaces.collider());
  const Vec3f local(p - leaf.center);
  const float away = std::max(leaf.extent, max_norm(local));
  if (!(away <= 0x1p50f && leaf.extent >= 0x1p-50f)) {
    for (std::size_t i = 0; i < leaf.size; ++i) nearest.look_at(corners, surfaces.facet(leaf, i), p);
    return;
  }
  const FacetKernels& kernels = facet_kernels();
  const FacetColumns columns = surfaces.columns(leaf);
  if (gaps.size() < columns.count) gaps.resize(columns.count);
  const float least = kernels.squared_gaps(columns, local, gaps.data());
  // mutant nearest-facet-pad: `0x1p` -> `0 * 0x1p`
  const double pad = 0x1p-18 * static_cast<double>(away) +
                     0x1p-48 * (max_norm(leaf.center) + static_cast<double>(leaf.extent) + max_norm(p));
  // The squared gap up to which facets have to be examined.
  const auto reach = [&] {
    const double farthest = (std::sqrt(nearest.point.squared_distance) + pad) * (1 + 0x1p-17);
    return static_cast<float>(std::min(farthest * farthest, static_cast<double>(std::numeric_limits<float>::max())));
  };
  if (least > reach()) return;
  // Calls f(i) for the facets within `reach_of_all`, 16 tested at a time; the filling repeats the last facet.
  const auto each_within = [&](float reach_of_all, const auto& f) {
    for (std::size_t begin = 0; begin < leaf.size; begin += facet_columns_step)
      for (unsigned near = kernels.at_most(gaps.data() + begin, reach_of_all); near != 0; near &= near - 1)
        if (const std::size_t i = begin + static_cast<std::size_t>(std::countr_zero(near)); i < leaf.size) f(i);
  };
  std::size_t first = leaf.size;
  each_within(least, [&](std::size_t i) { first = std::min(first, i); });
  nearest.look_at(corners, surfaces.facet(leaf, first), p);
  each_within(reach(), [&](std::size_t i) {
    if (i != first && gaps[i] <= reach()) nearest.look_at(corners, surfaces.facet(leaf, i), p);
  });
}

// The error of placed points, for the reasons in placed_spheres.hpp: a transform is not quite rigid, and it rounds.
double transform_pad(const Collider& collider, const Vec3& center, double radius) {
  const double reach = max_norm(center) + radius + max_norm(collider.transform().translation);
  return radius * 0x1p-28 + reach * 0x1p-48;
}
double sphere_reach(const Collider& collider, std::uint32_t node, const Vec3& direction) {
  const Sphere s = collider.sphere_state().sphere(node);
  return dot(collider.transform()(s.center), direction) + s.radius + transform_pad(collider, s.center, s.radius);
}
/// The reach of the corners of the facets of which the node owns a part.
double facet_reach(const Collider& collider, std::uint32_t node, const Vec3& direction, SurfaceScratch& scratch) {
  const Vec3 turned = collider.transform().inverse_rotate(direction);
  const Vec3f narrow(turned);
  LeafSurfaces& surfaces = scratch.of(collider);
  double reach = -std::numeric_limits<double>::infinity();
  surfaces.for_leaves(node, [&](const LeafSurfaces::Leaf& leaf) {
    const double beyond = static_cast<double>(facet_kernels().reach(surfaces.columns(leaf), narrow));
    const auto extent = static_cast<double>(leaf.extent);
    const double pad = 0x1p-20 * extent + transform_pad(collider, leaf.center, 2 * extent);
    reach = std::max(reach, dot(leaf.center, turned) + beyond + pad);
  });
  return reach + dot(collider.transform().translation, direction);
}

/// The protrusion of the sphere in front of its facets, as a share of its radius: next to 0 where it lies below the
/// surface and bulges with it, next to 1 where its center is in the surface. mean: mean_normal of the node.
double standing_off(const Collider& collider, std::uint32_t node, const Vec3& mean, SurfaceScratch& scratch) {
  // The value of a leaf is stored, because a leaf is in many contacts.
  std::optional<double> of_no_leaf;
  std::optional<double>& known =
      collider.tree().is_leaf(node) ? scratch.of(collider).read(node).standing_off : of_no_leaf;
  if (known) return *known;
  const Vec3 direction = normalized(mean);
  const double excess = sphere_reach(collider, node, direction) - facet_reach(collider, node, direction, scratch);
  const double radius = collider.sphere_state().sphere(node).radius;
  known = radius > 0 ? std::clamp(excess / radius, 0.0, 1.0) : 1.0;
  return *known;
}

}  // namespace

void SurfaceScratch::start(const Collider& a, const Collider& b) {
  sides_[0].start(a);
  sides_[1].start(b);
}

SurfacePoint nearest_facet(const Collider& collider, std::uint32_t node, const Vec3& point, SurfaceScratch& scratch) {
  LeafSurfaces& surfaces = scratch.of(collider);
  const Vec3 p = in_coordinates_of(collider, point);
  Nearest nearest;
  surfaces.for_leaves(node, [&](const LeafSurfaces::Leaf& leaf) { search(surfaces, leaf, p, scratch.gaps, nearest); });
  return placed(collider, nearest);
}

Vec3 mean_normal(const Collider& collider, std::uint32_t node, SurfaceScratch& scratch) {
  Vec3 area_vector;
  double area = 0;
  scratch.of(collider).for_leaves(node, [&](const LeafSurfaces::Leaf& leaf) {
    area_vector += leaf.area_vector;
    area += leaf.area;
  });
  return area > 0 ? collider.transform().rotate(area_vector / area) : Vec3{};
}

double region_reach(const Collider& collider, std::uint32_t node, const Vec3& direction, SurfaceScratch& scratch) {
  return std::min(sphere_reach(collider, node, direction), facet_reach(collider, node, direction, scratch));
}

ContactSurface contact_surface(const Collider& a, std::uint32_t node_a, const Collider& b, std::uint32_t node_b,
                               const Vec3& point, const Vec3& sphere_normal, double depth, SurfaceScratch& scratch) {
  const auto overlap = [&](const Vec3& n) {
    return region_reach(a, node_a, -n, scratch) + region_reach(b, node_b, n, scratch);
  };
  const Vec3 mean_a = mean_normal(a, node_a, scratch), mean_b = mean_normal(b, node_b, scratch);
  const Vec3 difference = mean_b - mean_a;
  double trust = 0;                         // weight of the mean normals
  constexpr double least_difference = 0.5;  // least length of the difference of two unit normals of regions that face
                                            // each other
  if (length(difference) > least_difference)
    trust = std::max(standing_off(a, node_a, mean_a, scratch), standing_off(b, node_b, mean_b, scratch));
  const Vec3 normal = normalized(sphere_normal * (1 - trust) + normalized(difference) * trust, sphere_normal);
  double least = std::min(depth, overlap(sphere_normal));
  if (trust > 0) least = std::min(least, overlap(normal));
  return {nearest_facet(a, node_a, point, scratch), nearest_facet(b, node_b, point, scratch), normal,
          std::max(0.0, least)};
}

}  // namespace morula::detail
