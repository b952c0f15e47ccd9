// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/patch_engine.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/triangle_intersection.hpp>

#include "collide/pairs/placed_spheres.hpp"

namespace morula::detail {
namespace {

/// The axis of the body's coordinates that is most nearly across the normal.
int axis_across(const RigidTransform& transform, const Vec3& normal) {
  const Vec3 local = transform.inverse_rotate(normal);
  const double x = std::abs(local.x), y = std::abs(local.y), z = std::abs(local.z);
  return x <= y && x <= z ? 0 : y <= z ? 1 : 2;
}

PatchFrame frame_of(const RigidTransform& transform, int axis, const Vec3& normal, const Vec3& center) {
  Vec3 unit;
  unit[axis] = 1;
  const Vec3 along = transform.rotate(unit);
  const Vec3 first = normalized(along - normal * dot(along, normal));
  return {first, cross(normal, first), normal, center};
}

}  // namespace

void PatchResult::clear() noexcept {
  patches.clear();
  known.clear();
  points.clear();
  points_begin.clear();
  for (SideResult& side : sides) {
    side.facets.clear(), side.gradients.clear();
    side.facets_begin.clear(), side.gradients_begin.clear();
  }
  volume = 0;
}

void PatchResult::link() {
  for (SideResult& side : sides) {
    side.facets_begin.push_back(side.facets.size());
    side.gradients_begin.push_back(side.gradients.size());
  }
  points_begin.push_back(points.size());
  const auto range = [](const auto& values, const std::vector<std::size_t>& begin, std::size_t i) {
    return std::span(values).subspan(begin[i], begin[i + 1] - begin[i]);
  };
  for (std::size_t i = 0; i < patches.size(); ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      PatchSide& side = k == 0 ? patches[i].a : patches[i].b;
      side.facets = range(sides[k].facets, sides[k].facets_begin, i);
      side.gradients = range(sides[k].gradients, sides[k].gradients_begin, i);
    }
    patches[i].points = range(points, points_begin, i);
  }
}

PatchStatus PatchEngine::find(const PatchBodies& bodies, std::span<const NodePair> leaves,
                              const ContactPatchOptions& options, Meter* meter, std::span<const KnownPatch> earlier,
                              std::uint32_t& next_id, PatchResult& result) {
  const Collider &a = *bodies.body[0], &b = *bodies.body[1];
  crossings_.start(a, b);
  for (const NodePair& pair : leaves)
    // mutant patches-within-budget: `return {}` -> `break`
    if (!crossings_.add(pair, meter)) return {};
  crossings_.finish();
  const auto pairs = crossings_.pairs();
  // Without crossings the overlap is a part of either body: near the smaller one.
  const Collider& inner = PlacedSpheres(a)(0).radius < PlacedSpheres(b)(0).radius ? a : b;
  const Vec3 origin = pairs.empty()
                          ? inner.vertex(inner.mesh_facets()[0][0])
                          : intersection(a.triangle(pairs[0].facet_a()), b.triangle(pairs[0].facet_b()))->from;
  if (!loops_.find(a, *bodies.surface[0], b, *bodies.surface[1], pairs, origin, meter)) return {};
  if (const Status status = regions_.PatchRegions::find(a, *bodies.surface[0], b, *bodies.surface[1], loops_, origin);
      !status)
    return {status};
  return find_in_regions(bodies, options, meter, earlier, next_id, result);
}

PatchStatus PatchEngine::find_self(const Collider& body, SelfSurface& surface, const ContactPatchOptions& options,
                                   const SelfRegions::Earlier& sides, std::span<const KnownPatch> earlier,
                                   std::uint32_t& next_id, PatchResult& result) {
  self_loops_.find(body, surface.closed, surface.tree);
  regions_.find(body, surface, self_loops_, sides);
  return find_in_regions({{&body, &body}, {&surface.closed, &surface.closed}, true}, options, nullptr, earlier, next_id,
                         result);
}

PatchStatus PatchEngine::find_in_regions(const PatchBodies& bodies, const ContactPatchOptions& options, Meter* meter,
                                         std::span<const KnownPatch> earlier, std::uint32_t& next_id,
                                         PatchResult& result) {
  const auto out_of_time = [&] { return meter && meter->out_of_time(); };
  result.clear();
  diagonals_.clear();
  for (std::uint32_t patch = 0; patch < regions_.patch_count; ++patch) {
    if (out_of_time()) return {};
    if (const Status status = measure(bodies, patch, result); !status) return {status};
  }
  recognize(bodies, earlier, result);
  for (std::uint32_t patch = 0; patch < regions_.patch_count; ++patch) {
    if (out_of_time()) return {};
    complete(bodies, patch, options, result);
  }
  result.volume = std::max(0.0, result.volume);
  for (std::size_t i = 0; i < result.patches.size(); ++i) {
    if (result.known[i].id == PatchMatching::none) result.known[i].id = next_id++;
    result.patches[i].id = result.known[i].id;
  }
  result.link();
  return {{}, true};
}

Status PatchEngine::measure(const PatchBodies& bodies, std::uint32_t patch, PatchResult& result) {
  const PatchIntegrals sums = integrator_.integrate(regions_, patch, result.sides);
  for (std::uint8_t k = 0; k < 2 && !bodies.is_one; ++k)
    if (sums.wound_area[k] < -sums.rounding[k]) return {Status::Code::inside_out, static_cast<std::uint8_t>(1 - k)};
  // Winding numbers below 0 that no vertex shows: the body whose winding numbers are lower is inside out. The error of
  // areas times the size of the patch bounds that of the volume by rounding of nodes.
  const double error = (sums.rounding[0] + sums.rounding[1]) * sums.box.diagonal() + sums.volume_rounding;
  if (!bodies.is_one && sums.volume < -error) {
    const bool lower_on_a = sums.wound_area[0] * sums.area[1] < sums.wound_area[1] * sums.area[0];
    return {Status::Code::inside_out, static_cast<std::uint8_t>(lower_on_a ? 1 : 0)};
  }
  ContactPatch made;
  made.volume = std::max(0.0, sums.volume);
  const Vec3 arm = centroid_of(sums);
  made.centroid = regions_.origin() + sums.reference + arm;
  for (std::size_t k = 0; k < 2; ++k) {
    PatchSide& side = k == 0 ? made.a : made.b;
    side.area_vector = sums.area_vector[k];
    side.moment = sums.moment[k] - cross(arm, sums.area_vector[k]);
    side.area = sums.area[k];
  }
  // The area vector of a closed region is 0, up to rounding.
  const double across = length(made.a.area_vector);
  // mutant patches-closed-normal: `0x1p-40` -> `0`
  if (across > 0x1p-40 * (made.a.area + made.b.area)) {
    made.normal = -made.a.area_vector / across;
    made.mean_depth = made.volume / across;
  }
  made.crossing_count = regions_.crossing_counts[patch];
  result.volume += sums.volume;
  diagonals_.push_back(sums.box.diagonal());
  result.patches.push_back(made);
  return {};
}

void PatchEngine::recognize(const PatchBodies& bodies, std::span<const KnownPatch> earlier, PatchResult& result) {
  const RigidTransform& transform_a = bodies.body[0]->transform();
  for (const ContactPatch& patch : result.patches) {
    KnownPatch& known = result.known.emplace_back(KnownPatch{PatchMatching::none,
                                                             {},
                                                             std::sqrt(std::max(patch.a.area, patch.b.area)),
                                                             axis_across(transform_a, patch.normal)});
    for (std::size_t k = 0; k < 2; ++k) {
      const RigidTransform& transform = bodies.body[k]->transform();
      known.centroid[k] = transform.inverse_rotate(patch.centroid - transform.translation);
    }
  }
  const std::span<const std::uint32_t> matches = matching_.find(earlier, result.known);
  for (std::uint32_t p = 0; p < matches.size(); ++p) {
    if (matches[p] == PatchMatching::none) continue;
    const KnownPatch& before = earlier[matches[p]];
    result.known[p].id = before.id;
    // The axis stays until it is too near the normal.
    if (std::abs(transform_a.inverse_rotate(result.patches[p].normal)[before.axis]) < 0.9)
      result.known[p].axis = before.axis;
  }
}

void PatchEngine::complete(const PatchBodies& bodies, std::uint32_t patch, const ContactPatchOptions& options,
                           PatchResult& result) {
  ContactPatch& made = result.patches[patch];
  result.points_begin.push_back(result.points.size());
  if (made.normal == Vec3{} || (!options.depths && options.max_points == 0)) return;
  // The point on the axis of the wrench that is nearest to the centroid; of a region that is nearly closed, whose axis
  // may be far away, the centroid.
  Vec3 arm = cross(made.a.area_vector, made.a.moment) / squared_length(made.a.area_vector);
  if (!(length(arm) <= diagonals_[patch])) arm = {};
  const Vec3 center = made.centroid - regions_.origin() + arm;
  const RigidTransform& transform = bodies.body[0]->transform();
  PatchFrame frame;
  const auto project = [&](int axis) {
    frame = frame_of(transform, axis, made.normal, center);
    for (std::size_t k = 0; k < 2; ++k) projected_[k].read(regions_, k, patch, frame);
  };
  // Points keep the axis of the step before; a depth that used it, too, would be rounded as earlier steps have it.
  const int own_axis = axis_across(transform, made.normal), kept_axis = result.known[patch].axis;
  if (options.depths) {
    project(own_axis);
    made.depth = depth_.of(projected_[0], projected_[1]);
  }
  if (options.max_points > 0 && (!options.depths || kept_axis != own_axis)) project(kept_axis);
  if (options.max_points > 0)
    points_.add(projected_[0], projected_[1], frame, options.max_points,
                {-made.a.area_vector, cross(arm, made.a.area_vector) - made.a.moment}, bodies.body, regions_.origin(),
                result.points);
}

}  // namespace morula::detail
