// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// False self-collisions of spheres: how often they occur, and spheres that are placed to avoid them.
//
//   const morula::robot::Robot arm = morula::robot::read_robot("arm.urdf");
//   const morula::robot::SelfFit fit = morula::robot::fit_for_self_collision(arm, {.max_total = 112});
//   std::printf("%.1f %% false, %zu spheres\n", 100 * fit.rates.false_share, fit.spheres.sphere_count());
//   for (const morula::robot::SelfFitStep& more : fit.more)
//     std::printf("%zu spheres: %.1f %%\n", more.spheres, 100 * more.false_share);
#pragma once

#include <morula/robot/self_collision.hpp>

namespace morula::robot {

struct SelfRateOptions {
  std::size_t samples = 1000;  ///< number of configurations, uniform between the joints' limits, 1 or more
  std::uint64_t seed = 1;      ///< seed of the random configurations
  StopToken stop{};            ///< a stop request makes the function throw BuildStopped
  /// Called with the completed share of the work, 0 to 1, on any thread, one call at a time.
  std::function<void(double share)> progress{};
};

/// Two links, and the shares of the sampled configurations in which they collide, 0 to 1.
struct SelfPairRate {
  std::size_t a = none, b = none;  ///< links, a < b
  double spheres = 0;              ///< share in which the spheres overlap
  double surfaces = 0;             ///< share in which the shapes collide
  double false_share = 0;          ///< share in which the spheres overlap and the shapes do not collide
  /// True: the shapes collide in at least 95 % of the samples, and the pair does not count for the shares of SelfRates.
  bool always_collides = false;
};

/// The result of self_collision_rates(). The three shares leave out pairs with SelfPairRate::always_collides: with
/// them, nearly every configuration would collide. Such shapes overlap by design, and a planner has to ignore the pair.
struct SelfRates {
  std::size_t samples = 0;
  double spheres = 0;      ///< share of the configurations in which the spheres of some tested pair overlap
  double surfaces = 0;     ///< share in which the shapes of some tested pair collide
  double false_share = 0;  ///< share in which spheres of some pair overlap and the shapes of no pair collide
  /// Tested pairs whose spheres overlap in some sample, descending by false_share, then ascending by a and b.
  std::vector<SelfPairRate> pairs;
};

/// Compares self-collisions of the spheres with those of the shapes that they cover, in random configurations.
///
/// spheres: a result of fit_spheres() for this robot. ignored: pairs that are not tested. Shapes collide if their
/// surfaces cross or touch, or if one contains a component of the other. Polyhedra around cylinders, capsules and
/// ellipsoids stand for them; the polyhedra and the round shapes differ by at most 0.3 % of the radii. Joints without a
/// usable range (find_ignored) stay at rest. The result is the same for any number of workers. Throws
/// std::invalid_argument for 0 samples, and BuildStopped. Cost: one test of surfaces for each configuration and pair
/// whose spheres overlap, about 10 us each.
SelfRates self_collision_rates(const Robot& robot, const RobotSpheres& spheres, std::span<const IgnoredPair> ignored,
                               const SelfRateOptions& options = {}, WorkersOrAll workers = {});

struct SelfFitOptions {
  std::size_t samples = 1000;  ///< number of configurations in which the spheres are chosen, 1 or more
  /// Names of pairs of links that are not tested, such as those of read_ignored_pairs(). Pairs of adjacent links and
  /// of links whose surfaces touch at rest are not tested in any case.
  std::vector<std::array<std::string, 2>> given{};
};

/// A total number of spheres, and the rate that is reached with it.
struct SelfFitStep {
  std::size_t spheres = 0;
  double false_share = 0;  ///< SelfRates::false_share of the same samples
};

/// The result of fit_for_self_collision().
struct SelfFit {
  RobotSpheres spheres;
  SelfRates rates;        ///< rates of these spheres
  SelfRates evenly;       ///< rates of fit_spheres() with the same options
  std::size_t total = 0;  ///< largest number of spheres: max_total, otherwise the number that fit_spheres() uses
  /// Rates that a fit with this total reaches, for fewer and for more spheres, ascending, up to twice the total;
  /// false_share does not increase.
  std::vector<SelfFitStep> steps;
};

/// Fits spheres, and places them where self-collision requires them.
///
/// Every link starts with one sphere. Then the sets grow step by step: a link gets a fit with more spheres, or one of
/// its spheres is divided into smaller ones over the same part of the surface, or moved. Where links pass each other,
/// centers also move away from the other link, deeper into their own or beyond it: large spheres are flatter there.
/// Each step is the one that removes most false collisions per sphere, in sampled configurations in which no shapes
/// collide, and outside volume. At intervals, spheres that do little are left out, and others grow over their part.
/// The result is the state of the fewest false configurations before the number first exceeds the total. The steps do
/// not depend on the total, so in these samples a larger total never has a higher false share.
///
/// fit: as for fit_spheres(), without max_protrusion, max_protrusion_share, max_radius and max_uncovered. Links of
/// link_spheres, fixed_spheres and, with clip_margin, of clip keep the spheres of fit_spheres(). The result is covered
/// and measured like that of fit_spheres(), and the same for any number of workers. Throws like fit_spheres() and
/// self_collision_rates(), and std::invalid_argument for options that it does not take. Cost: ten fits, and steps that
/// take longer than all of these.
SelfFit fit_for_self_collision(const Robot& robot, const FitOptions& fit = {}, const SelfFitOptions& options = {},
                               WorkersOrAll workers = {});

}  // namespace morula::robot
