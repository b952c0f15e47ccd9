// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/haptic/surface_follower.hpp"

#include <algorithm>
#include <cmath>
#include <morula/surface/swept.hpp>

namespace morula::detail {
namespace {

// The center when a facet moves and carries it, at the same place in its frame.
Vec3 carried(const Vec3& center, const Vec3& point, const Barycentric& barycentric, const Triangle& from,
             const Triangle& to) {
  const Vec3 offset = TriangleFrame(from).to_frame(center - point);
  return at_barycentric(to, barycentric) + TriangleFrame(to).from_frame(offset);
}

}  // namespace

// The center stays within `longest` of where it is. A point of a facet that comes to within `touching` of it at some
// time has then moved by at most `farthest` when the positions are those of the body, which the ball is tested against.
SurfaceFollower::Followed SurfaceFollower::follow(const Collider& body, TouchQuery& touch, const Vec3& center,
                                                  const KeptDistances& kept) {
  sphere_tests_ = facet_tests_ = 0;
  const double farthest = motion_.compare(body);
  if (farthest == 0) return {center, false, false};
  const double longest = 2 * farthest + 4 * kept.rest;
  // mutant haptic-near-facets-alone: `kept.touching + farthest + longest` -> `kept.touching`
  const double reach = (kept.touching + farthest + longest) * (1 + 0x1p-40);
  const Touch& found = touch.run(body, Sphere{center, reach}, {.collect_all = true});
  if (!found.status) return {center, true, true};
  sphere_tests_ = found.sphere_tests, facet_tests_ = found.facet_tests;
  near_.clear(), last_.clear();
  for (const TouchingFacet& facet : found.facets) {
    const Facet& corners = body.mesh_facets()[facet.point.facet];
    near_.push_back({facet.point.facet, motion_.before(corners)});
    last_.push_back({facet.point.facet, motion_.after(corners)});
  }
  return slices(center, longest, kept);
}

// Vertices and center move on straight lines in every slice of time, which ends where a facet would come nearer than
// half its distance. At its beginning, the move is chosen that keeps away from the facets in contact as they move on.
// time_of_impact() is never late, so no facet meets the center within a slice.
SurfaceFollower::Followed SurfaceFollower::slices(const Vec3& start, double longest, const KeptDistances& kept) {
  constexpr int most_slices = 24;
  constexpr double least_share = 1e-9;
  Vec3 center = start;
  first_.clear();
  for (const NearFacet& facet : near_) first_.push_back(facet.corners);
  double time = 0;
  for (int count = 0; count < most_slices; ++count) {
    Vec3 move = wanted_move(center, kept);
    if (const double way = distance(center + move, start); !(way <= longest)) move = Vec3{};
    if (!keeps_its_side(center, longest)) break;
    const double share = free_time(center, move, kept);
    // mutant haptic-no-impact: `if (share >= 1) return` -> `return`
    if (share >= 1) return {center + move, true, false};
    if (!(share > least_share)) break;
    center += share * move;
    time += share * (1 - time);
    for (std::size_t k = 0; k < near_.size(); ++k) near_[k].corners = between(first_[k], last_[k].corners, time);
  }
  // No way was found: the place beside the facet that is nearest.
  std::size_t nearest = near_.size();
  TrianglePoint point{};
  for (std::size_t k = 0; k < near_.size(); ++k) {
    const TrianglePoint found = closest_point(near_[k].corners, center);
    if (nearest < near_.size() && !(found.squared_distance < point.squared_distance)) continue;
    nearest = k, point = found;
  }
  if (nearest == near_.size()) return {center, true, true};
  return {carried(center, point.point, point.barycentric, near_[nearest].corners, last_[nearest].corners), true, true};
}

// The move to the end of the motion: that of the nearest facet in contact, which keeps the center at its place in the
// frame of the facet, or none; and then to the nearest point beyond all planes of contact, which move with their
// points.
Vec3 SurfaceFollower::wanted_move(const Vec3& center, const KeptDistances& kept) {
  find_contacts(near_, center, kept, contacts_);
  if (contacts_.empty()) return {};
  const auto nearest = std::min_element(contacts_.begin(), contacts_.end(),
                                        [](const auto& a, const auto& b) { return a.distance < b.distance; });
  const Vec3 goal = carried(center, nearest->point, nearest->barycentric, near_[nearest->place].corners,
                            last_[nearest->place].corners);
  sides_.clear();
  for (const ProxyContact& contact : contacts_) {
    const Vec3 shift = at_barycentric(last_[contact.place].corners, contact.barycentric) - contact.point;
    sides_.push_back({contact.normal, kept.rest - contact.distance + dot(contact.normal, shift)});
  }
  return nearest_kept(goal - center, sides_, kept.skin / 64).point;
}

// Positions within a slice, and the center, are off by less than 2^-50 of their coordinates. A center that is much
// farther from all facets is on the side of each that it seems to be on.
bool SurfaceFollower::keeps_its_side(const Vec3& center, double longest) const {
  const double least = 0x1p-44 * (max_norm(center) + longest);
  return std::all_of(near_.begin(), near_.end(), [&](const NearFacet& facet) {
    return closest_point(facet.corners, center).squared_distance > least * least;
  });
}

// The share of the rest of the motion in which no facet comes nearer to the center than half of `rest`, or of its
// present distance if that is less.
double SurfaceFollower::free_time(const Vec3& center, const Vec3& move, const KeptDistances& kept) {
  const Vec3 end = center + move;
  const double way = length(move);
  double share = 1;
  for (std::size_t k = 0; k < near_.size(); ++k) {
    const Triangle &from = near_[k].corners, &to = last_[k].corners;
    const double now = std::sqrt(closest_point(from, center).squared_distance);
    const double least = std::min(now, kept.rest) / 2;
    if (now > (least + way + largest_move(from, to)) * (1 + 0x1p-40) + kept.skin / 64) continue;
    ++facet_tests_;
    share = std::min(share, time_of_impact(std::span(&center, 1), std::span(&end, 1), from, to, least));
  }
  return share;
}

}  // namespace morula::detail
