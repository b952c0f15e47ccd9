// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Facets near the proxy of a haptic probe: its contacts with them, and how far it can move among them.
#pragma once

#include <morula/geometry/triangle.hpp>
#include <vector>

namespace morula::detail {

/// Distances that the center of a proxy keeps. In contact it is at `rest` = radius + skin. A move ends at `stop`, an
/// eighth of the skin nearer; a move that begins near that may lose 1/64 of the skin, or of the distance if that is
/// less.
struct KeptDistances {
  KeptDistances(double radius, double skin_)
      : skin(skin_), rest(radius + skin_), stop(rest - skin_ / 8), touching(rest + skin_ / 16) {}
  double skin, rest, stop;
  double touching;  ///< up to this distance a facet is a contact
  double core = 0;  ///< a distance of which nothing is lost: what may be lost is 1/64 of the skin or of the rest
};

struct NearFacet {
  std::uint32_t facet;
  Triangle corners;
};

/// A point of the surface where the distance to the proxy is least among the points around it.
struct ProxyContact {
  std::uint32_t facet;
  Barycentric barycentric;
  Vec3 point;
  Vec3 normal;  ///< unit vector from the point to the center
  double distance;
  std::size_t place;    ///< of the facet among those near the proxy
  bool hidden = false;  ///< not a contact (find_contacts)
  /// Interval of the facet along an axis, and the largest `high` up to this one in the order of `low`: for the search
  /// in find_contacts() alone.
  double low = 0, high = 0, highest = 0;
};

/// The contacts of a center with facets at most `touching` away, in the order of the facets.
///
/// A nearest point that also lies on a nearer facet is none: the surface comes nearer to the center from there on. So a
/// proxy over a plane of many facets has one contact, and slides over their edges.
void find_contacts(const std::vector<NearFacet>& near, const Vec3& center, const KeptDistances& kept,
                   std::vector<ProxyContact>& contacts);

/// The share of the move, 0 to 1, after which the center is as near to one of the facets as it may come.
double free_share(const std::vector<NearFacet>& near, const Vec3& center, const Vec3& move, const KeptDistances& kept);

/// Whether the closed segment has a common point with one of the facets. Exact.
bool meets_a_facet(const std::vector<NearFacet>& near, const Vec3& from, const Vec3& to);
/// Whether the closed segment has no common point with the facets, except its beginning. Exact; facets with
/// an area, in one plane with the segment, that contain its beginning count as met.
bool leaves_facets(const std::vector<NearFacet>& near, const Vec3& from, const Vec3& to);

/// A vector in the frame of a triangle: along its first side, across it, and along its normal.
struct TriangleFrame {
  explicit TriangleFrame(const Triangle& t);
  Vec3 along, across, normal;
  Vec3 to_frame(const Vec3& v) const { return {dot(along, v), dot(across, v), dot(normal, v)}; }
  Vec3 from_frame(const Vec3& v) const { return v.x * along + v.y * across + v.z * normal; }
};

}  // namespace morula::detail
