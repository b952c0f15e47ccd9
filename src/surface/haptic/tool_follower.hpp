// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Carries a haptic tool from the positions of one step to those of the next.
#pragma once

#include <morula/collide/primitives.hpp>
#include <vector>

#include "surface/haptic/surface_motion.hpp"
#include "surface/haptic/tool_neighbors.hpp"
#include "surface/haptic/tool_shape.hpp"

namespace morula::detail {

/// The least motion, in the kinetic metric, that the planes of contact permit, toward a goal. Where no motion reaches
/// radius + skin everywhere, it keeps as much distance as is possible.
class ToolConstraints {
 public:
  void clear() { sides_.clear(); }
  /// The derivative of the distance of a ball from a plane; `offset`: the least change of this distance.
  void add(const Motion& row, double offset) { sides_.push_back({row, offset}); }
  NearestMotion nearest(const Motion& goal, double skin);

 private:
  std::vector<KeptMotions> sides_, eased_;
};

class ToolFollower {
 public:
  SurfaceMotion motion;

  struct Followed {
    ToolPose pose;
    bool moved = false, jammed = false;
  };
  /// The pose when vertices have moved from the remembered positions to those of the body. body: without a transform.
  Followed follow(const Collider& body, const ToolShape& shape, double skin, const ToolPose& pose);
  std::size_t sphere_tests = 0, facet_tests = 0;  ///< of the last follow()

 private:
  struct Pair {
    std::uint32_t ball, facet;
    Triangle first, now, next, last;  // corners at the beginning, now, at the end of the slice, and at the end
    double distance;                  // of the ball's center, at the present time
  };
  bool list(const Collider& body, const ToolShape& shape, double skin, double farthest, double longest);
  double measure(const ToolShape& shape);
  RigidMotion wanted(const ToolShape& shape, double skin, const ToolPose& pose);
  double free_time(const ToolShape& shape, double skin, double sag) const;
  bool slices(const ToolShape& shape, double skin, double longest, ToolPose& pose);

  std::vector<Pair> pairs_;  // in the order of the balls
  std::vector<Vec3> start_, centers_, ends_;
  std::vector<NearFacet> near_;
  std::vector<std::size_t> places_;  // of the facets of near_ in pairs_
  std::vector<ProxyContact> contacts_;
  ToolConstraints constraints_;
  TouchQuery touch_;
};

}  // namespace morula::detail
