// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Carries the proxy of a haptic probe from the positions of one step to those of the next.
#pragma once

#include <morula/collide/primitives.hpp>
#include <vector>

#include "surface/haptic/half_spaces.hpp"
#include "surface/haptic/proxy_contacts.hpp"
#include "surface/haptic/surface_motion.hpp"

namespace morula::detail {

/// Vertices of facets at the last step, and the way of the proxy while they move on straight lines.
class SurfaceFollower {
 public:
  /// Remembers the body's positions. It is the first step.
  void start(const Collider& body) { motion_.start(body); }
  std::size_t vertex_count() const { return motion_.vertex_count(); }
  std::size_t facet_count() const { return motion_.facet_count(); }

  struct Followed {
    Vec3 center;
    bool moved = false, jammed = false;
  };
  /// The center when vertices have moved from the remembered positions to those of the body. body: without a transform.
  /// Keeps the remembered positions until accept().
  Followed follow(const Collider& body, TouchQuery& touch, const Vec3& center, const KeptDistances& kept);
  /// Remembers the positions of the last follow(), which are the body's.
  void accept(const Collider& body) { motion_.accept(body); }
  std::size_t sphere_tests() const { return sphere_tests_; }
  std::size_t facet_tests() const { return facet_tests_; }

 private:
  Followed slices(const Vec3& start, double longest, const KeptDistances& kept);
  bool keeps_its_side(const Vec3& center, double longest) const;
  double free_time(const Vec3& center, const Vec3& move, const KeptDistances& kept);
  Vec3 wanted_move(const Vec3& center, const KeptDistances& kept);

  SurfaceMotion motion_;
  std::vector<Triangle> first_;         // corners at the beginning of the motion, of the facets of near_
  std::vector<NearFacet> near_, last_;  // facets within reach of the motion, at the present time and at the end
  std::vector<ProxyContact> contacts_;
  std::vector<KeptSide> sides_;
  std::size_t sphere_tests_ = 0, facet_tests_ = 0;
};

}  // namespace morula::detail
