// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of links that a planner need not test against each other.
#pragma once

#include <functional>
#include <morula/robot/fit.hpp>
#include <optional>
#include <stop_token>
#include <string_view>

namespace morula::robot {

enum class IgnoreReason {
  given,     ///< in the SRDF that was given
  adjacent,  ///< joined, or joined through links without spheres
  rest,      ///< the surfaces touch or cross with all joints at rest
  apart,     ///< the spheres are apart in every configuration between the joints' limits, proven
  never,     ///< the spheres were apart in every sampled configuration, and no search found one in which they meet
};
/// "User", "Adjacent", "Default", "Never", "Never": as SRDF files give reasons.
std::string_view name(IgnoreReason reason);

struct IgnoredPair {
  std::size_t a = none, b = none;  ///< links, a < b
  IgnoreReason reason = IgnoreReason::adjacent;
};

/// A tested pair whose spheres overlap at rest, or in nearly every configuration: a planner takes the robot for
/// colliding with itself there.
struct OverlappingPair {
  std::size_t a = none, b = none;  ///< links, a < b
  /// The distance of the surfaces at rest, mesh units, where the spheres overlap there; nothing where they do not. It
  /// may be too large by 0.3 % of the radius of cylinders, capsules and ellipsoids.
  std::optional<double> rest_distance;
  double share = 0;  ///< of the first sampled configurations, at most 1,000, in which the spheres overlap; 0…1
};

struct SelfCollision {
  std::vector<IgnoredPair> ignored;  ///< ascending
  /// Configurations that `never` rests on; 0: no pair is ignored for it. Each such pair meets in a share of all
  /// configurations that is below never_bound(), with 95 % confidence.
  std::size_t samples = 0;
  std::size_t pairs = 0;                     ///< of links with spheres
  std::vector<OverlappingPair> overlapping;  ///< ascending
  std::vector<std::string> notes;            ///< which tested pairs a user should know of, and why
  /// 3 / samples; 1 without samples.
  double never_bound() const { return samples > 3 ? 3 / static_cast<double>(samples) : 1; }
};

struct SelfCollisionOptions {
  /// The fewest configurations, even over the joints' limits; 0: none, and only proven pairs never meet. More are
  /// sampled until no pair has met for as long again, at most eight times as many; fewer where links have so many
  /// spheres that they would take many seconds.
  std::size_t samples = 100'000;
  std::uint64_t seed = 1;
  std::vector<std::array<std::string, 2>> given{};  ///< ignored anyway; links that are not there are passed over
  std::stop_token stop{};
  std::function<void(double share)> progress{};  ///< of the work, 0…1; on any thread, one call at a time
};

/// The pairs of links that need no test against each other.
///
/// A pair over a joint that may stand anywhere (Joint::range_known is false, floating, planar) or whose range is far
/// longer than the robot is never listed as `apart` or `never`. The same result for any number of workers. Throws
/// BuildStopped.
SelfCollision find_ignored(const Robot& robot, const RobotSpheres& spheres, const SelfCollisionOptions& options = {},
                           WorkersOrAll workers = {});

/// Do the spheres of two links overlap, with the links at these places?
bool overlap(std::span<const Sphere> a, const RigidTransform& at_a, std::span<const Sphere> b,
             const RigidTransform& at_b);

/// The pairs of <disable_collisions> of an SRDF. Throws FileError.
std::vector<std::array<std::string, 2>> read_ignored_pairs(const std::filesystem::path& srdf);

}  // namespace morula::robot
