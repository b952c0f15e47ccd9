// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Haptic probe: a proxy that stays on its side of a surface while the device point goes through it.
//
//   morula::HapticProbe probe({.radius = 0.01, .stiffness = 400});
//   for (const morula::Vec3& device : positions) {               // a point of the device, 1,000 times a second
//     const morula::HapticStep step = probe.step(a, device);
//     if (!step.status) std::puts(message(step.status).c_str());
//     std::printf("%g\n", step.force.z);                         // stiffness × (proxy − device point)
//   }
#pragma once

#include <cstddef>
#include <memory>
#include <morula/collide/collider.hpp>
#include <morula/geometry/triangle.hpp>
#include <optional>
#include <span>

namespace morula {

struct HapticOptions {
  double radius = 0;  ///< radius of the ball that touches, mesh units; 0: a point
  /// Distance that the proxy keeps from the surface besides the radius, mesh units: more than 2^-24 of the body's
  /// largest |coordinate|. No value: in the first step 2^-20 of
  /// the radius of the root's sphere, and at least 2^-22 of the largest |coordinate|.
  std::optional<double> skin{};
  double stiffness = 1;  ///< force per mesh unit between proxy and device point; 0 or more
  /// true: each part of the force has the direction of vertex normals (weighted by area, interpolated) instead of that
  /// of the facet, so the direction does not jump between facets. The position of the proxy does not depend on it.
  bool smooth_normals = false;
  double friction = 0;        ///< coefficient of Coulomb friction; 0: the proxy slides freely
  std::size_t max_moves = 8;  ///< largest number of straight moves toward the device point in a step, 1 or more
};

/// The result of a step. Positions and vectors are in the world.
struct [[nodiscard]] HapticStep {
  Status status;
  Vec3 proxy{};          ///< center of the proxy
  Vec3 force{};          ///< force on the device: stiffness × (proxy − device point), with smooth_normals turned
  bool touches = false;  ///< a facet is within radius + skin of the proxy, up to a sixteenth of the skin
  /// true: no move that brings the proxy nearer to the device point was found, up to 1/64 of the skin or 2^-44 of the
  /// distance to the device point. false: the next step continues.
  bool settled = false;
  /// true: the surface closed around the proxy, or moved too far in one step to be followed. The proxy is
  /// then on its side of the facet that was nearest, and may be on the other side of another one. Also true for a start
  /// on the surface with no room on either side.
  bool jammed = false;
  bool certified = false;  ///< SphereState::covers of the body; if false, facets may be missed
  /// Contact point: the point of the surface nearest to the proxy. No value if the proxy does not touch.
  std::optional<SurfacePoint> contact{};
  Vec3 normal{};                                  ///< unit vector from the contact point to the proxy; 0 if none
  std::size_t moves = 0;                          ///< number of straight moves
  std::size_t sphere_tests = 0, facet_tests = 0;  ///< numbers of tests of spheres and of facets
};

/// A god-object [zilles1995] with a radius [ruspini1997] for one body.
///
/// The proxy starts at the device point. Each step moves it toward the device point on straight lines: it goes until a
/// facet is at radius + skin, then along the planes of contact toward their point nearest to the device point. At rest
/// it is the constrained nearest point for one, two or three planes of contact.
///
/// Guarantee: on its way in a step, the center passes through no facet, however fast the device point moves. Each move
/// is a segment that is tested against the facets near it by exact predicates, and shortened while it meets one. From
/// every facet the center keeps radius + 7/8 of the skin, or its distance at the beginning of the step if that is less,
/// up to 1/64 of the skin per move. In a slot that is narrower than the ball, it keeps to the middle. The body needs no
/// inside: surfaces may be open or thin, and both sides hold the proxy.
///
/// If vertices move between steps, the proxy is carried with the facet it touches, and pushed where the surface meets
/// it. It passes through no facet while vertices and proxy move on straight lines: proven with time_of_impact() while
/// the center is farther from all facets than rounding. HapticStep::jammed is true if no such path was found. A
/// transform of the body carries the proxy as if it were a part of the body. All this holds in the body's coordinates,
/// for a body that covers its surface (SphereState::covers).
///
/// One thread may use a probe at a time. The body must stay unchanged during a call; Snapshots pass bodies from the
/// thread of a solver. Memory grows to that of one position per vertex and of the facets near the proxy; after that a
/// step allocates nothing. Cost: one ball query, and one capsule query for each move, at most max_moves. After a motion
/// of vertices one more ball query, time linear in vertices, and about 1 us per facet within reach of the motion.
class HapticProbe {
 public:
  /// Throws std::invalid_argument, naming the option: a radius, skin, stiffness or friction that is negative or not
  /// finite, a skin of 0, and max_moves of 0.
  explicit HapticProbe(HapticOptions options = {});
  ~HapticProbe();
  HapticProbe(HapticProbe&&) noexcept;
  HapticProbe& operator=(HapticProbe&&) noexcept;
  const HapticOptions& options() const;

  /// Moves the proxy toward the device point, in world coordinates. In the first step, and after reset(), the proxy
  /// starts at the device point; if this is nearer to the surface than radius + skin, it is pushed away from it, on its
  /// side. A start on a facet, an edge or a vertex goes to the outer side if this has room, else to any side that has.
  /// Where none has, HapticStep::jammed is true, and the next step starts at its device point. Such a start costs about
  /// 300 ball queries at most, and allocates.
  ///
  /// body: the same body in every step, or another object of the same mesh, such as a copy of the body in another
  /// snapshot: positions are compared with those of the last step. Rejected, with no change: a body that queries
  /// reject; a point that is not finite or has a |coordinate| of 2^200 or more (bad_shape); another number of vertices
  /// or facets than in the last step (other_bodies); a skin of 2^-24 or less of the body's largest |coordinate|
  /// (bad_option).
  HapticStep step(const Collider& body, const Vec3& device);
  /// Forgets the proxy, and the body of the last step, which it shares until then: the next step starts at its device
  /// point.
  void reset();
  /// Centers of the proxy in the last step, in the body's coordinates: at its beginning, after it followed the surface,
  /// and after every move. From the second one on, the proxy moved along the straight lines between them. Valid until
  /// the next step.
  std::span<const Vec3> path() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
