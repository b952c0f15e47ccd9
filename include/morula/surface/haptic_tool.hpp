// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Haptic tool: a rigid tool that stays on its side of a surface while the device pose goes through it; force and
// torque.
//
//   const std::vector<morula::Sphere> balls = morula::leaf_spheres(b.sphere_state());  // they cover the tool's mesh
//   morula::HapticTool tool(balls, {.stiffness = 400});
//   for (const morula::Vec3& position : positions) {            // poses of the device, 1,000 times a second
//     const morula::HapticToolStep step = tool.step(a, {.translation = position});
//     if (!step.status) std::puts(message(step.status).c_str());
//     std::printf("%g %g\n", step.force.z, step.torque.x);
//   }
#pragma once

#include <cstddef>
#include <memory>
#include <morula/collide/collider.hpp>
#include <morula/geometry/sphere.hpp>
#include <optional>
#include <span>
#include <vector>

namespace morula {

/// The leaf spheres of a state, in the order of the nodes, mesh units. If SphereState::covers, their union contains the
/// surface.
std::vector<Sphere> leaf_spheres(const SphereState& state);

struct HapticToolOptions {
  /// Distance that each ball keeps from the surface besides its radius, mesh units: more than 2^-24 of the largest
  /// |coordinate| that the tool reaches when it touches the body. No value: in the first step 2^-12 of the radius of
  /// the tool or of the root's sphere, whichever is less, and at least 2^-22 of that coordinate. A step rotates by at
  /// most about max_moves × √(skin / tool radius / 8) radians near the surface.
  std::optional<double> skin{};
  double stiffness = 1;  ///< force per mesh unit between the centers of proxy and device; 0 or more
  /// Torque per radian between proxy and device, 0 or more. No value: stiffness × inertia / mass of the balls; force
  /// and torque of a tool at rest are then those of normal forces at the contacts.
  std::optional<double> rotation_stiffness{};
  std::size_t max_moves = 16;  ///< largest number of moves toward the device pose in a step, 1 or more
};

/// A contact of a ball with the surface. Points and vectors are in the world.
struct ToolContact {
  std::uint32_t ball;   ///< index of the ball
  SurfacePoint point;   ///< the point of the surface nearest to the ball's center, among the points around it
  Vec3 normal;          ///< unit vector from the point to the ball's center
  double distance = 0;  ///< from the point to the center: the radius + about the skin, mesh units
};

/// The result of a step. Poses and vectors are in the world.
struct [[nodiscard]] HapticToolStep {
  Status status;
  RigidTransform proxy{};  ///< pose of the proxy: tool coordinates to world
  Vec3 force{};            ///< force on the device: stiffness × (center of the proxy − center of the device)
  Vec3 torque{};           ///< torque on the device about its center (HapticTool::center)
  bool touches = false;    ///< a facet is within radius + skin of a ball, up to a sixteenth of the skin
  /// true: no motion nearer to the device pose was found, up to 1/64 of the skin at every point of the balls, and to
  /// 1/64 radian. false: the next step continues.
  bool settled = false;
  /// true: the tool has no proven place. The surface closed around it, or moved too far in one step to be followed; or
  /// it has not started, because a ball reaches the surface at each device pose so far. The proxy stays, or is at the
  /// device pose before a start; force and torque are 0. It continues in the first step at whose beginning all balls of
  /// the proxy, or of the device pose, are off the surface; it may then be on another side.
  bool jammed = false;
  bool certified = false;                         ///< SphereState::covers of the body; if false, facets may be missed
  std::span<const ToolContact> contacts{};        ///< valid until the next step
  std::size_t moves = 0;                          ///< number of moves
  std::size_t sphere_tests = 0, facet_tests = 0;  ///< numbers of tests of spheres and of facets in queries
};

/// A virtual tool of six degrees of freedom, a god-object [ortega2007], for one body. The tool is a set of balls.
///
/// Each step moves the proxy toward the device pose in screw motions: the center moves on a straight line while the
/// tool rotates evenly about it. A motion is the nearest one to the device pose in the kinetic metric of the balls that
/// the planes of contact permit: Gauss's principle of least constraint, without inertia from step to step.
///
/// Guarantee: no ball meets a facet on the way, however far the device pose jumps. From every facet each ball keeps
/// radius + 3/4 of the skin, or loses at most 1/32 of its gap per move where it has less. Each move is proven for every
/// ball and every facet near it by a direction that separates them, with the deviation of its path from a segment and
/// with rounding counted against it, and shortened until it is proven. So if the balls cover a tool's mesh, its surface
/// meets no facet either, and the tool stays on its side of thin and open surfaces. If vertices move between steps,
/// they push the tool; no ball meets a facet while vertices move on straight lines, unless HapticToolStep::jammed. A
/// transform of the body carries the proxy as if it were a part of the body. All this holds in the body's coordinates,
/// for a body that covers its surface (SphereState::covers).
///
/// One thread may use a tool at a time; the body must stay unchanged during a call. Memory grows to that of one
/// position per vertex and of the facets near the balls. Cost: a capsule query for each ball that leaves the facets of
/// its last query, and about 0.2 us per move, ball and facet near it.
class HapticTool {
 public:
  /// Balls in the tool's coordinates, mesh units. Throws std::invalid_argument for no balls, for balls that are not
  /// finite, have a negative radius or coordinates above 2^100, and, naming the option, for a skin that is not positive
  /// and finite, a stiffness that is negative or not finite, and max_moves of 0.
  explicit HapticTool(std::span<const Sphere> balls, HapticToolOptions options = {});
  ~HapticTool();
  HapticTool(HapticTool&&) noexcept;
  HapticTool& operator=(HapticTool&&) noexcept;
  const HapticToolOptions& options() const;

  /// Moves the proxy toward the device pose (tool coordinates to world). It starts at the first device pose, in this
  /// step or after reset(), at which every ball keeps its radius and half of the skin.
  ///
  /// body: as in HapticProbe::step. Rejected, with no change: a body that queries reject; a pose that is not rigid
  /// (deviation_from_rigid above largest_float_deviation) or 2^200 or more away (bad_shape); another number of vertices
  /// or facets than in the last step (other_bodies); a skin that is too small (bad_option).
  HapticToolStep step(const Collider& body, const RigidTransform& device);
  /// Forgets the proxy, and the body of the last step, which it shares until then: the next step starts at its device
  /// pose.
  void reset();
  /// Center of mass of the balls, with their volumes as masses, in the tool's coordinates; with equal masses if all
  /// radii are 0.
  Vec3 center() const;
  /// Poses of the proxy in the last step, in the body's coordinates: at its beginning, after it followed the surface,
  /// and after every move. Valid until the next step.
  std::span<const RigidTransform> path() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
