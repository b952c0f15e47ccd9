// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Self-collision of robots: the pairs of links that a planner does not need to test against each other.
#pragma once

#include <functional>
#include <morula/parallel/threads.hpp>
#include <morula/robot/fit.hpp>
#include <optional>
#include <string_view>

namespace morula::robot {

/// The reason why a pair of links needs no test. If several apply, the first of this list is taken.
enum class IgnoreReason {
  given,     ///< the pair is in SelfCollisionOptions::given
  adjacent,  ///< a joint connects the links, or a chain of joints through links without spheres, or of fixed joints
  rest,      ///< the surfaces touch or cross if all joints have their rest values (rest_values)
  apart,     ///< the spheres are proven apart in every configuration between the joints' limits
  never,     ///< the spheres are apart in every sampled configuration, and a search finds none in which they overlap
};
/// The reason in the words of SRDF files: "User", "Adjacent", "Default", and "Never" for both `apart` and `never`.
std::string_view name(IgnoreReason reason);

struct IgnoredPair {
  std::size_t a = none, b = none;  ///< links, a < b
  IgnoreReason reason = IgnoreReason::adjacent;
};

/// A pair that is not ignored, and whose spheres overlap at rest or in at least 95 % of the first sampled
/// configurations. In these configurations a planner reports that the robot collides with itself.
struct OverlappingPair {
  std::size_t a = none, b = none;  ///< links, a < b
  /// Distance of the links' surfaces at rest, above 0, mesh units; no value if the spheres do not overlap at rest. It
  /// may be too large by 0.3 % of the radius of cylinders and capsules and of the half axes of ellipsoids, because
  /// polyhedra inside these shapes stand for them.
  std::optional<double> rest_distance;
  /// Share of the first sampled configurations (at most 1,000) in which the spheres overlap, 0 to 1; 0 without samples.
  double share = 0;
};

/// The result of find_ignored().
struct SelfCollision {
  std::vector<IgnoredPair> ignored;  ///< ascending by a, then by b
  /// Number of sampled configurations in which the spheres of each pair with the reason `never` are apart; 0: no pair
  /// has this reason. With 95 % confidence, such a pair overlaps in a smaller share of all configurations than
  /// never_bound().
  std::size_t samples = 0;
  std::size_t pairs = 0;                     ///< number of pairs of links with spheres
  std::vector<OverlappingPair> overlapping;  ///< ascending by a, then by b
  std::vector<std::string> notes;  ///< overlapping pairs and joints without a usable range, with remedies, as text
  /// 3 / samples, the upper bound of that share; 1 for up to 3 samples.
  double never_bound() const { return samples > 3 ? 3 / static_cast<double>(samples) : 1; }
};

struct SelfCollisionOptions {
  /// Least number of sampled configurations, uniform between the joints' limits; 0: none, and no pair gets the reason
  /// `never`. Sampling continues until the second half of all samples has found no further overlapping pair, up to
  /// eight times this number. It ends earlier after two billion tests of spheres, about 10 s of one thread.
  std::size_t samples = 100'000;
  std::uint64_t seed = 1;  ///< seed of the random configurations
  /// Names of pairs of links to ignore in any case, such as those of read_ignored_pairs(). Pairs with a link that the
  /// robot lacks, or that has no spheres, have no effect.
  std::vector<std::array<std::string, 2>> given{};
  StopToken stop{};  ///< a stop request makes find_ignored() throw BuildStopped
  /// Called with the completed share of the work, 0 to 1, on any thread, one call at a time.
  std::function<void(double share)> progress{};
};

/// Finds the pairs of links that need no test against each other.
///
/// spheres: the result of fit_spheres() for this robot. A pair gets the reasons `apart` and `never` only if all joints
/// between its links have a usable range. Floating and planar joints have none, nor have joints with Joint::range_known
/// false, joints that slide by more than 100 times the size of the robot, and joints that rotate by more than 1,000
/// radians. The result is the same for any number of workers. Throws BuildStopped on a stop request, and FileError for
/// a mesh that cannot be read.
SelfCollision find_ignored(const Robot& robot, const RobotSpheres& spheres, const SelfCollisionOptions& options = {},
                           WorkersOrAll workers = {});

/// True if a sphere of a touches or overlaps a sphere of b. a, b: spheres of two links in the links' axes; at_a, at_b:
/// poses of the links in common axes. Computed in double, without an allowance for rounding. Cost: spheres of a ×
/// spheres of b.
bool overlap(std::span<const Sphere> a, const RigidTransform& at_a, std::span<const Sphere> b,
             const RigidTransform& at_b);

/// Reads the pairs of link names of the <disable_collisions> elements of an SRDF file. Throws FileError if the file
/// cannot be read or parsed, or an element lacks link1 or link2.
std::vector<std::array<std::string, 2>> read_ignored_pairs(const std::filesystem::path& srdf);

}  // namespace morula::robot
