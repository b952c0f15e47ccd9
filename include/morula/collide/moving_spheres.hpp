// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Moving spheres: the spheres of one tree during a step, for bounds between two frames: motion blur, swept culling, and
// the earliest time at which two bodies can touch.
//
//   morula::MovingSpheres a, b;
//   a.set_start(body_a), b.set_start(body_b);             // colliders
//   // ... the step: update the bodies, move the colliders
//   a.set_end(body_a), b.set_end(body_b);
//   const morula::Sphere shutter = a.sphere(0, 0.5);      // contains the surface of a in the middle of the step
//   const morula::EarliestTouch touch = morula::earliest_touch(a, b);
//   if (touch.apart) std::puts("no touch in this step");
//   else std::printf("no touch before %g\n", touch.time);
#pragma once

#include <cstdint>
#include <memory>
#include <morula/collide/budget.hpp>
#include <morula/collide/collider.hpp>
#include <morula/geometry/box.hpp>
#include <span>
#include <vector>

namespace morula {

/// A node's center and radius go evenly from those at time 0 to those at time 1. If the vertices go evenly too, each on
/// a straight line, the sphere contains the part of the surface that the node owns at every time t between:
///
///   |lerp(p) - lerp(c)| = |(1 - t)(p0 - c0) + t (p1 - c1)| <= (1 - t) r0 + t r1 = lerp(r).
///
/// This holds for points of facets, which are fixed means of vertices, in exact arithmetic and for vertices computed as
/// v0 + t (v1 - v0) in double. Radii are padded for it by 2^-47 of coordinates and radii. Where a body turns, or bones
/// are interpolated as rotations, vertices move on arcs: arc_deviation() bounds their distance from the straight
/// lines, and widen() pays for it.
///
/// The spheres are copied, in world coordinates: 64 bytes per node. Bodies and colliders may change or end afterwards.
class MovingSpheres {
 public:
  /// Copies the spheres of a body as those of time 0; until set_end() they are also those of time 1. Takes back
  /// widen(). Rejects a body that queries reject. Allocates only if the tree has more nodes than earlier ones. Cost:
  /// linear in nodes.
  Status set_start(const Collider& body);
  /// Copies the spheres of the same body after the step. Rejects what set_start() rejects, and with other_bodies a body
  /// with another cover than that of set_start(); the spheres of time 1 then stay as they were.
  Status set_end(const Collider& body);
  /// Begins the next step: time 1 becomes time 0. Takes back widen().
  void advance();
  /// Enlarges all spheres by `length` at every time, for vertices that leave their straight lines by at most that far,
  /// mesh units. Throws std::invalid_argument for a length that is negative or not finite.
  void widen(double length);

  /// True if both frames cover (SphereState::covers): what is said of cover above is then proven.
  bool covers() const { return start_covers_ && end_covers_; }
  /// The number of nodes: 0 before set_start().
  std::size_t size() const { return start_.size(); }
  /// The tree at rest, for its structure. Requires set_start().
  const SphereTree& tree() const { return *tree_; }

  /// A node's sphere at a time, in world coordinates. t: 0 to 1; others count as the nearer of these.
  Sphere sphere(std::uint32_t node, double t) const;
  /// A sphere that contains the node's sphere at all times: the smallest one up to rounding.
  Sphere swept_sphere(std::uint32_t node) const;
  /// The smallest box, up to rounding, that contains the node's sphere at all times.
  Box swept_box(std::uint32_t node) const;

 private:
  friend class EarliestTouchQuery;
  std::vector<Sphere> start_, end_;
  double wider_ = 0;
  const SphereTree* tree_ = nullptr;
  std::shared_ptr<const void> kept_;
  std::uint64_t cover_id_ = 0;
  bool start_covers_ = false, end_covers_ = false;
};

/// A bound of the distance of a point from its chord: of x(t) from (1 - t) x(0) + t x(1), for 0 <= t <= 1, if x turns
/// evenly by an angle about a fixed point that is `reach` away, such as the joint of a bone: reach * angle^2 / 8. If
/// the point also moves with joints above it, each turning evenly by angles θ_i at reaches ρ_i from the root on, the
/// bound is (Σ_ij θ_i θ_j ρ_max(i,j)) / 8: pass both lists. angles: radians; reaches: mesh units, largest distance of
/// the point from each joint during the step. Throws std::invalid_argument for lists of different lengths and for
/// numbers that are negative or not finite.
double arc_deviation(std::span<const double> angles, std::span<const double> reaches);

struct EarliestTouchOptions {
  /// Distance at which surfaces count as touching, mesh units; finite, 0 or more.
  double distance = 0;
  /// Limit in pair tests; a budget of time is rejected. The result stays a bound when it ends the search.
  Budget budget{};
};

struct [[nodiscard]] EarliestTouch {
  Status status;
  /// No point of one surface comes within the distance of the other before this time: 0 to 1.
  double time = 0;
  bool apart = false;      ///< true: nor at any later time of the step; `time` is then 1
  bool certified = false;  ///< MovingSpheres::covers() of both; if false, the two above are not proven
  bool complete = false;   ///< false: the budget ended the search, and the spheres of `nodes` are not leaves
  NodePair nodes{};        ///< the pair whose spheres touch at that time, unless `apart`
  std::size_t sphere_tests = 0;
};

/// Finds the earliest time at which leaf spheres of two bodies can touch, again and again; it keeps its memory.
///
/// The gap of two moving spheres along a fixed direction is linear in time, and a lower bound of their distance. So a
/// direction proves them apart up to the zero of a line; the direction between the centers at that time proves more,
/// and a few of them reach the first touch. The search is best first: it opens the pair of nodes that may touch
/// earliest, at the larger sphere. Times are never later than those of exact arithmetic, and hold for vertices that are
/// computed as MovingSpheres says.
///
/// Surfaces between which leaf spheres touch may still be apart: SweptQuery tests facets.
class EarliestTouchQuery {
 public:
  EarliestTouchQuery();
  ~EarliestTouchQuery();
  EarliestTouchQuery(EarliestTouchQuery&&) noexcept;
  EarliestTouchQuery& operator=(EarliestTouchQuery&&) noexcept;
  /// Rejects a side without spheres with body_not_current, and with bad_option a distance or a budget out of range.
  /// Cost: about 50 ns per test.
  EarliestTouch run(const MovingSpheres& a, const MovingSpheres& b, const EarliestTouchOptions& options = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};
/// The same, once. Throws std::invalid_argument, with the message, if EarliestTouchQuery rejects the input.
EarliestTouch earliest_touch(const MovingSpheres& a, const MovingSpheres& b, const EarliestTouchOptions& options = {});

}  // namespace morula
