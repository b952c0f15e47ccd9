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
  given,     ///< listed in the given SRDF
  adjacent,  ///< joined by a joint, or through links without spheres
  rest,      ///< the surfaces touch or cross with all joints at rest
  apart,     ///< the spheres are proven apart in every configuration between the joints' limits
  never,     ///< the spheres were apart in every sampled configuration, and a search found none in which they overlap
};
/// The reason as in SRDF files: "User", "Adjacent", "Default", "Never", "Never".
std::string_view name(IgnoreReason reason);

struct IgnoredPair {
  std::size_t a = none, b = none;  ///< links, a < b
  IgnoreReason reason = IgnoreReason::adjacent;
};

/// A tested pair whose spheres overlap at rest, or in nearly every configuration. A planner takes the robot for
/// colliding with itself there.
struct OverlappingPair {
  std::size_t a = none, b = none;  ///< links, a < b
  /// Distance of the surfaces at rest, mesh units, if the spheres overlap there; otherwise no value. It may be too
  /// large by 0.3 % of the radius of cylinders, capsules and ellipsoids.
  std::optional<double> rest_distance;
  double share = 0;  ///< share of the first sampled configurations, at most 1,000, in which the spheres overlap; 0…1
};

struct SelfCollision {
  std::vector<IgnoredPair> ignored;  ///< ascending
  /// Number of configurations behind the verdict `never`; 0: no pair has it. Each such pair overlaps in a share of all
  /// configurations below never_bound(), with 95 % confidence.
  std::size_t samples = 0;
  std::size_t pairs = 0;                     ///< number of pairs of links with spheres
  std::vector<OverlappingPair> overlapping;  ///< ascending
  std::vector<std::string> notes;            ///< tested pairs that need attention, with the reason
  /// Upper bound of the share: 3 / samples; 1 without samples.
  double never_bound() const { return samples > 3 ? 3 / static_cast<double>(samples) : 1; }
};

struct SelfCollisionOptions {
  /// Least number of configurations, uniform over the joints' limits; 0: none, so only proven pairs are ignored.
  /// Sampling continues until no pair has overlapped for as many samples again, at most eight times as many; fewer if
  /// links have so many spheres that this takes many seconds.
  std::size_t samples = 100'000;
  std::uint64_t seed = 1;
  std::vector<std::array<std::string, 2>> given{};  ///< pairs to ignore in any case; missing links are skipped
  std::stop_token stop{};
  std::function<void(double share)>
      progress{};  ///< called with the completed share, 0…1, on any thread, one call at a time
};

/// Finds the pairs of links that need no test against each other.
///
/// A pair across a joint without a known range (Joint::range_known is false, floating, planar), or with a range far
/// longer than the robot, is never listed as `apart` or `never`. The result is the same for any number of workers.
/// Throws BuildStopped.
SelfCollision find_ignored(const Robot& robot, const RobotSpheres& spheres, const SelfCollisionOptions& options = {},
                           WorkersOrAll workers = {});

/// True if the spheres of two links overlap, with the links at these poses.
bool overlap(std::span<const Sphere> a, const RigidTransform& at_a, std::span<const Sphere> b,
             const RigidTransform& at_b);

/// Reads the pairs of <disable_collisions> of an SRDF. Throws FileError.
std::vector<std::array<std::string, 2>> read_ignored_pairs(const std::filesystem::path& srdf);

}  // namespace morula::robot
