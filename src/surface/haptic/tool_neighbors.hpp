// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Facets near the balls of a tool: its contacts with them, and how far it can move among them.
#pragma once

#include <morula/collide/primitives.hpp>
#include <vector>

#include "surface/haptic/proxy_contacts.hpp"
#include "surface/haptic/tool_shape.hpp"

namespace morula::detail {

struct BallContact {
  std::uint32_t ball;
  ProxyContact at;
};

/// The distances that the center of a ball keeps. A facet within `ahead` beyond them counts as a contact.
KeptDistances kept_of_ball(double radius, double skin, double ahead = 0);

/// Whether a direction proves that a segment keeps more than `least` from a facet, with rounding counted against it.
bool is_proven_apart(const Triangle& t, const Vec3& from, const Vec3& to, double least);

class ToolNeighbors {
 public:
  /// Forgets all facets, as their positions have changed.
  void clear();
  /// Lists the facets that can be nearer than radius + skin to a ball on the segment from its center to `to`, unless
  /// they are listed, and those within lookahead() of these. False if the query rejects the segment.
  bool gather(const Collider& body, const ToolShape& shape, double skin, const std::vector<Vec3>& centers,
              const std::vector<Vec3>& to);
  /// How much farther than radius + skin the facets of a ball are listed.
  static double lookahead(double radius, double skin) { return 8 * skin + radius / 8; }

  /// Contacts of the balls at these centers, in the order of balls and facets; those within lookahead() included.
  void find_contacts(const ToolShape& shape, double skin, const std::vector<Vec3>& centers,
                     std::vector<BallContact>& contacts);
  /// The share of the moves from centers to ends, 0 to 1, after which a ball is as near to a facet as it may come. sag:
  /// deviation of the ways from segments.
  double free_share(const ToolShape& shape, double skin, double sag, const std::vector<Vec3>& centers,
                    const std::vector<Vec3>& ends) const;
  /// Whether all balls are proven to keep their radius and half of their gap, at most half of the skin, on their ways.
  bool is_proven_free(const ToolShape& shape, double skin, double sag, const std::vector<Vec3>& centers,
                      const std::vector<Vec3>& ends) const;

  std::size_t sphere_tests = 0, facet_tests = 0;  ///< of the queries since the caller set them to 0

 private:
  struct Ball {
    Vec3 from, to;  // the capsule whose facets are listed
    double slack = -1;
    std::vector<NearFacet> near;
  };
  std::vector<Ball> balls_;
  std::vector<ProxyContact> found_;
  TouchQuery touch_;
};

}  // namespace morula::detail
