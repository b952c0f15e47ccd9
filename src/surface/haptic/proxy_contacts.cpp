// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/haptic/proxy_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <morula/geometry/triangle_intersection.hpp>

#include "geometry/exact_predicates.hpp"

namespace morula::detail {
namespace {

/// Where a facet is nearest to a point.
struct Approach {
  TrianglePoint nearest;
  double distance;
  Vec3 normal;  // from the facet to the point; the facet's own where they meet
};

// The direction from the nearest point has an error of about 2^-53 of the coordinates over the distance. Inside a facet
// the direction is known: the facet's normal, on the exact side; on an edge, it is across the edge. A normal of a facet
// that is nearly a segment has a larger error, and is not used.
Vec3 direction_from(const Triangle& t, const TrianglePoint& nearest, const Vec3& p, double distance) {
  const Vec3 area = area_vector(t), away = distance > 0 ? (p - nearest.point) / distance : Vec3{};
  if (!(distance > 0)) return normalized(area);
  const auto inside =
      std::count_if(nearest.barycentric.begin(), nearest.barycentric.end(), [](double b) { return b > 0; });
  if (inside == 1) return away;
  if (inside == 3) {
    const double longest =
        std::max({squared_distance(t[0], t[1]), squared_distance(t[1], t[2]), squared_distance(t[2], t[0])});
    if (!(length(area) > 0x1p-10 * longest)) return away;
    const int side = TrianglePlane(t).side(p).sign;
    return side < 0 ? -normalized(area) : normalized(area);
  }
  const std::size_t opposite = nearest.barycentric[0] > 0 ? nearest.barycentric[1] > 0 ? 2 : 1 : 0;
  const Vec3 edge = normalized(t[(opposite + 2) % 3] - t[(opposite + 1) % 3]);
  return normalized(away - dot(away, edge) * edge, away);
}

Approach approach(const Triangle& t, const Vec3& p) {
  Approach made{closest_point(t, p), 0, {}};
  made.distance = std::sqrt(made.nearest.squared_distance);
  made.normal = direction_from(t, made.nearest, p, made.distance);
  return made;
}

/// Whether the nearest point of `contact` is also on the facet of `nearer`, which is nearer to the center, or as near
/// and before it. The normals of both then make an acute angle; facets that face each other, nearer to each other than
/// the tolerance, do not.
bool hides(const ProxyContact& nearer, const ProxyContact& contact, const std::vector<NearFacet>& near,
           double tolerance) {
  if (nearer.facet == contact.facet || nearer.distance > contact.distance) return false;
  if (nearer.distance == contact.distance && nearer.facet > contact.facet) return false;
  // mutant haptic-hides-opposite: `!(dot(nearer.normal, contact.normal) > 0)` -> `false`
  if (!(dot(nearer.normal, contact.normal) > 0)) return false;
  return closest_point(near[nearer.place].corners, contact.point).squared_distance <= tolerance * tolerance;
}

/// Exact.
bool are_on_a_line(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::all_of(std::begin(projections), std::end(projections),
                     [&](Projection p) { return orient2d(a, b, c, p) == 0; });
}

/// The axis along which the nearest points extend most.
int longest_axis(const std::vector<ProxyContact>& contacts) {
  Vec3 low = contacts.front().point, high = low;
  for (const ProxyContact& contact : contacts)
    for (int k = 0; k < 3; ++k)
      low[k] = std::min(low[k], contact.point[k]), high[k] = std::max(high[k], contact.point[k]);
  const Vec3 extent = high - low;
  return extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
}

// Only facets whose interval along an axis contains a nearest point, up to the tolerance and rounding, can hide it. So
// a ball over n small facets tests about √n of them for each, instead of all.
void mark_hidden(std::vector<ProxyContact>& contacts, const std::vector<NearFacet>& near, double tolerance) {
  constexpr std::size_t few = 32;
  if (contacts.size() <= few) {
    for (ProxyContact& contact : contacts)
      contact.hidden = std::any_of(contacts.begin(), contacts.end(),
                                   [&](const ProxyContact& nearer) { return hides(nearer, contact, near, tolerance); });
    return;
  }
  const int axis = longest_axis(contacts);
  for (ProxyContact& contact : contacts) {
    const Triangle& t = near[contact.place].corners;
    const double pad = tolerance + 0x1p-44 * std::max({max_norm(t[0]), max_norm(t[1]), max_norm(t[2])});
    contact.low = std::min({t[0][axis], t[1][axis], t[2][axis]}) - pad;
    contact.high = std::max({t[0][axis], t[1][axis], t[2][axis]}) + pad;
  }
  std::sort(contacts.begin(), contacts.end(), [](const auto& a, const auto& b) { return a.low < b.low; });
  double highest = contacts.front().high;
  for (ProxyContact& contact : contacts) contact.highest = highest = std::max(highest, contact.high);
  for (ProxyContact& contact : contacts) {
    const double at = contact.point[axis];
    auto nearer = std::upper_bound(contacts.begin(), contacts.end(), at,
                                   [](double value, const ProxyContact& c) { return value < c.low; });
    contact.hidden = false;
    while (!contact.hidden && nearer != contacts.begin() && std::prev(nearer)->highest >= at) {
      --nearer;
      contact.hidden = nearer->high >= at && hides(*nearer, contact, near, tolerance);
    }
  }
  std::sort(contacts.begin(), contacts.end(), [](const auto& a, const auto& b) { return a.place < b.place; });
}

// The distance of a point that moves on a line to a convex set is a convex function f of the time. While f falls, its
// tangent meets the value sought not later than f does, so Newton's steps from the left never pass the time sought, and
// f stays above the value up to there. Where f does not fall, it never falls again. Rounding: points of the line and
// distances are off by a few 2^-53 of the coordinates, which is less than 2^-14 of the skin.
double time_until_near(const Triangle& t, const Vec3& center, const Vec3& move, double end, const KeptDistances& kept) {
  constexpr int most_steps = 32;
  double time = 0, value = 0, least_gap = 0;
  for (int steps = 0; steps < most_steps; ++steps) {
    const Approach now = approach(t, center + time * move);
    if (steps == 0) {
      // A little may be lost in any case, so that rounding does not hold a proxy that slides; but never all.
      const double held = std::max(0.0, std::min(kept.skin, now.distance - kept.core));
      // mutant haptic-loses-all: `held / 64` -> `now.distance`
      value = std::min(kept.stop, now.distance - held / 64);
      // mutant haptic-stuck-near: `held * 0x1p-12` -> `kept.skin * 0x1p-12`
      least_gap = held * 0x1p-12;
    }
    const double speed = -dot(now.normal, move);
    // mutant haptic-no-sweep: `!(speed > 0)` -> `true`
    if (!(speed > 0)) return end;
    const double gap = now.distance - value;
    if (!(gap > least_gap)) return time;
    time += gap / speed;
    if (!(time < end)) return end;
  }
  return time;
}

}  // namespace

// A facet is convex: from a point of it that is not its nearest one, the distance to the center falls toward that one.
// So a nearest point of one facet that lies on a nearer facet is no least distance of the surface. If it lies beside
// that facet by less than the tolerance, a contact is lost that free_share() respects nevertheless.
void find_contacts(const std::vector<NearFacet>& near, const Vec3& center, const KeptDistances& kept,
                   std::vector<ProxyContact>& contacts) {
  contacts.clear();
  for (std::size_t k = 0; k < near.size(); ++k) {
    const Approach found = approach(near[k].corners, center);
    if (found.distance > kept.touching) continue;
    contacts.push_back(
        {near[k].facet, found.nearest.barycentric, found.nearest.point, found.normal, found.distance, k});
  }
  mark_hidden(contacts, near, kept.skin * 0x1p-10);
  std::erase_if(contacts, [](const ProxyContact& contact) { return contact.hidden; });
}

double free_share(const std::vector<NearFacet>& near, const Vec3& center, const Vec3& move, const KeptDistances& kept) {
  double share = 1;
  for (const NearFacet& facet : near)
    share = std::min(share, time_until_near(facet.corners, center, move, share, kept));
  return share;
}

bool meets_a_facet(const std::vector<NearFacet>& near, const Vec3& from, const Vec3& to) {
  return std::any_of(near.begin(), near.end(), [&](const NearFacet& facet) {
    const TrianglePlane plane(facet.corners);
    if (plane.side(from).sign * plane.side(to).sign > 0) return false;
    // mutant haptic-no-exact-test: `intersect(facet.corners, {from, to, to})` -> `false`
    return intersect(facet.corners, {from, to, to});
  });
}

bool leaves_facets(const std::vector<NearFacet>& near, const Vec3& from, const Vec3& to) {
  return std::all_of(near.begin(), near.end(), [&](const NearFacet& facet) {
    const Triangle& t = facet.corners;
    if (!intersect(t, {from, from, from})) return !intersect(t, {from, to, to});
    if (orient3d(t[0], t[1], t[2], to) != 0) return true;
    // In one plane. Only a facet without area can be left: a point, or a segment from whose line `to` is away.
    if (!are_on_a_line(t[0], t[1], t[2])) return false;
    return (t[0] == t[1] && t[1] == t[2]) || !are_on_a_line(t[0], t[1], to) || !are_on_a_line(t[1], t[2], to);
  });
}

TriangleFrame::TriangleFrame(const Triangle& t) {
  along = normalized(t[1] - t[0]);
  normal =
      normalized(area_vector(t), normalized(cross(along, std::abs(along.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0})));
  across = cross(normal, along);
}

}  // namespace morula::detail
