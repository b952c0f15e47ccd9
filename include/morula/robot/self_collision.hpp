// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of links that a planner need not test against each other.
#pragma once

#include <morula/robot/fit.hpp>
#include <string_view>

namespace morula::robot {

enum class IgnoreReason {
  given,     ///< in the SRDF that was given
  adjacent,  ///< joined, or joined through links without spheres
  rest,      ///< the spheres overlap with all joints at rest
  never,     ///< apart in every sampled configuration, which proves nothing about the others
};
/// "User", "Adjacent", "Default", "Never": as SRDF files give reasons.
std::string_view name(IgnoreReason reason);

struct IgnoredPair {
  std::size_t a = none, b = none;  ///< links, a < b
  IgnoreReason reason = IgnoreReason::adjacent;
};

struct SelfCollision {
  std::vector<IgnoredPair> ignored;  ///< ascending
  std::size_t samples = 0;           ///< configurations that `never` rests on; 0: no pair is ignored for it
  std::size_t pairs = 0;             ///< of links with spheres
};

struct SelfCollisionOptions {
  std::size_t samples = 2000;  ///< even over the joints' limits; 0: none
  std::uint64_t seed = 1;
  std::vector<std::array<std::string, 2>> given{};  ///< ignored anyway; links that are not there are passed over
};

SelfCollision find_ignored(const Robot& robot, const RobotSpheres& spheres, const SelfCollisionOptions& options = {},
                           Workers& workers = serial_workers());

/// Do the spheres of two links overlap, with the links at these places?
bool overlap(std::span<const Sphere> a, const RigidTransform& at_a, std::span<const Sphere> b,
             const RigidTransform& at_b);

/// The pairs of <disable_collisions> of an SRDF. Throws FileError.
std::vector<std::array<std::string, 2>> read_ignored_pairs(const std::filesystem::path& srdf);

}  // namespace morula::robot
