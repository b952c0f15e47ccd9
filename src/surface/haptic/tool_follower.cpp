// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/haptic/tool_follower.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/scale.hpp>
#include <morula/surface/swept.hpp>

namespace morula::detail {
namespace {

/// Whether one direction separates a point and a facet by more than `least` at both ends of straight moves, and so in
/// between: every difference of heights is linear in time.
bool is_apart_throughout(const Vec3& from, const Vec3& to, const Triangle& first, const Triangle& last, double least) {
  const Vec3 direction = normalized(from - closest_point(first, from).point, Vec3{});
  double gap = std::numeric_limits<double>::infinity(), size = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 before = from - first[k], after = to - last[k];
    gap = std::min({gap, dot(direction, before), dot(direction, after)});
    size = std::max({size, max_norm(before), max_norm(after)});
  }
  return gap * (1 - 0x1p-50) > least + 0x1p-46 * size + 0x1p-50 * max_norm(from);
}

}  // namespace

NearestMotion ToolConstraints::nearest(const Motion& goal, double skin) {
  const double tolerance = skin / 64;
  NearestMotion found = nearest_motion(goal, sides_, tolerance);
  if (found.exists) return found;
  const auto eased = [&](double share, const Motion& toward) {
    eased_ = sides_;
    for (KeptMotions& side : eased_)
      if (side.offset > 0) side.offset *= share;
    return nearest_motion(toward, eased_, tolerance);
  };
  double possible = 0, impossible = 1;
  for (int k = 0; k < 8; ++k) {
    const double share = 0.5 * (possible + impossible);
    (eased(share, {}).exists ? possible : impossible) = share;
  }
  return eased(possible, goal);
}

ToolFollower::Followed ToolFollower::follow(const Collider& body, const ToolShape& shape, double skin,
                                            const ToolPose& pose) {
  sphere_tests = facet_tests = 0;
  Followed result{pose};
  const double farthest = motion.compare(body);
  if (farthest == 0) return result;
  result.moved = true;
  const double longest = 4 * farthest + 8 * skin;
  shape.place(pose, centers_);
  result.jammed = !list(body, shape, skin, farthest, longest) || !slices(shape, skin, longest, result.pose);
  return result;
}

// Every center stays within `longest` of where it is. A point of a facet that comes to within radius + skin of it at
// some time has then moved by at most `farthest` when the positions are those of the body.
bool ToolFollower::list(const Collider& body, const ToolShape& shape, double skin, double farthest, double longest) {
  pairs_.clear();
  for (std::size_t k = 0; k < shape.size(); ++k) {
    const double touching = KeptDistances(shape.radius(k), skin).touching;
    // mutant haptic-tool-near-alone: `touching + farthest + longest` -> `touching + 0 * (farthest + longest)`
    const Sphere ball{centers_[k], (touching + farthest + longest) * (1 + 0x1p-40)};
    const Touch& found = touch_.run(body, ball, {.collect_all = true});
    if (!found.status) return false;
    sphere_tests += found.sphere_tests, facet_tests += found.facet_tests;
    for (const TouchingFacet& facet : found.facets) {
      const Facet& corners = body.mesh_facets()[facet.point.facet];
      const Triangle before = motion.before(corners);
      pairs_.push_back(
          {static_cast<std::uint32_t>(k), facet.point.facet, before, before, before, motion.after(corners), 0});
    }
  }
  return true;
}

/// Computes all distances; returns the least gap between a ball and a facet.
double ToolFollower::measure(const ToolShape& shape) {
  double least = std::numeric_limits<double>::infinity();
  for (Pair& pair : pairs_) {
    pair.distance = std::sqrt(closest_point(pair.now, centers_[pair.ball]).squared_distance);
    least = std::min(least, pair.distance - shape.radius(pair.ball));
  }
  return least;
}

// The least motion that keeps away from the facets in contact as they move on. Those farther away end a slice, and are
// contacts in the next one.
RigidMotion ToolFollower::wanted(const ToolShape& shape, double skin, const ToolPose& pose) {
  const RigidTransform rows = pose.rotation.rows();
  constraints_.clear();
  for (std::size_t begin = 0, end = 0; begin < pairs_.size(); begin = end) {
    const std::uint32_t ball = pairs_[begin].ball;
    const double radius = shape.radius(ball);
    const KeptDistances kept = kept_of_ball(radius, skin, ToolNeighbors::lookahead(radius, skin));
    near_.clear(), places_.clear();
    for (end = begin; end < pairs_.size() && pairs_[end].ball == ball; ++end)
      if (pairs_[end].distance <= kept.touching)
        near_.push_back({pairs_[end].facet, pairs_[end].now}), places_.push_back(end);
    find_contacts(near_, centers_[ball], kept, contacts_);
    for (const ProxyContact& contact : contacts_) {
      const Vec3 shift = at_barycentric(pairs_[places_[contact.place]].last, contact.barycentric) - contact.point;
      constraints_.add(shape.row(ball, contact.normal, rows),
                       kept.rest - contact.distance + dot(contact.normal, shift));
    }
  }
  return shape.from_metric(constraints_.nearest({}, skin).motion, rows);
}

// The share of a slice in which every ball is proven to keep its radius and half of its gap, at most half
// of the skin.
double ToolFollower::free_time(const ToolShape& shape, double skin, double sag) const {
  double share = 1;
  for (const Pair& pair : pairs_) {
    const Vec3 &from = centers_[pair.ball], &to = ends_[pair.ball];
    const double radius = shape.radius(pair.ball);
    const double least = radius + std::min(skin, pair.distance - radius) / 2 + sag;
    if (pair.distance > (least + distance(from, to) + largest_move(pair.now, pair.next)) * (1 + 0x1p-40) + skin / 64)
      continue;
    if (is_apart_throughout(from, to, pair.now, pair.next, least)) continue;
    // mutant haptic-tool-no-impact: `share = std::min(share, time_of_impact` -> `static_cast<void>(time_of_impact`
    share = std::min(share, time_of_impact(std::span(&from, 1), std::span(&to, 1), pair.now, pair.next, least));
  }
  return share;
}

// Vertices move on straight lines in every slice of time, and the tool in a screw motion. A slice ends where the tool
// would rotate too far for its sag, or where a ball would lose half of its gap. False if slices do not suffice, or gaps
// come near to rounding.
bool ToolFollower::slices(const ToolShape& shape, double skin, double longest, ToolPose& pose) {
  constexpr int most_slices = 64;
  constexpr double least_share = 1e-9;
  start_ = centers_;
  double time = 0;
  for (int count = 0; count < most_slices; ++count) {
    const double gap = measure(shape);
    if (!(gap > 0x1p-40 * (max_norm(pose.center) + shape.reach() + longest))) return false;
    RigidMotion move = wanted(shape, skin, pose);
    const double sag = std::min(skin, gap) / 64, turn = length(move.turn), most_turn = shape.turn_of_sag(sag);
    const double whole = turn > most_turn ? most_turn / turn : 1, until = whole < 1 ? time + whole * (1 - time) : 1;
    move = whole * move;
    shape.place(pose.moved(move), ends_);
    for (std::size_t k = 0; k < ends_.size(); ++k)
      if (!(distance(ends_[k], start_[k]) <= longest)) return false;
    for (Pair& pair : pairs_) pair.next = until < 1 ? between(pair.first, pair.last, until) : pair.last;
    const double share = free_time(shape, skin, sag);
    if (!(share * whole > least_share)) return false;
    pose = pose.moved(share * move);
    if (share >= 1 && until >= 1) return true;
    shape.place(pose, centers_);
    time += share * (until - time);
    for (Pair& pair : pairs_) pair.now = between(pair.first, pair.last, time);
  }
  return false;
}

}  // namespace morula::detail
