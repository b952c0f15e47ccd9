// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres for a robot: a set for every link that covers its shapes, proven for the exact numbers in files.
//
//   const morula::robot::Robot arm = morula::robot::read_robot("arm.urdf");
//   const morula::robot::RobotSpheres spheres = morula::robot::fit_spheres(arm, {.spheres = 16});
//   for (const morula::robot::LinkSpheres& link : spheres.links)
//     std::printf("%s: %zu spheres\n", arm.links[link.link].name.c_str(), link.spheres.size());
//   if (!spheres.covered()) std::puts("the shapes of a link are not covered");
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <morula/accuracy/measure.hpp>
#include <morula/generators/build.hpp>
#include <morula/robot/robot.hpp>
#include <set>

namespace morula::robot {

/// A half space in a link's axes: the kept part has normal · x ≥ offset.
struct ClipPlane {
  Vec3 normal{0, 0, 1};  ///< unit vector toward the kept part
  double offset = 0;
  bool operator==(const ClipPlane&) const = default;
};

struct FitOptions {
  std::size_t spheres = 16;  ///< largest number of spheres of a link; 0: as many as max_protrusion needs
  /// Largest number of spheres of the whole robot, 1 or more, including `link_spheres` and `fixed_spheres`. Each next
  /// sphere goes to the link where it reduces outside volume most. If the links need more, they get more, and a note
  /// says so.
  std::optional<std::size_t> max_total{};
  /// Largest number for single links, in place of `spheres` and of a share of `max_total`.
  std::map<std::string, std::size_t> link_spheres{};
  /// Largest protrusion, above 0, mesh units; links then use as few spheres as they can.
  std::optional<double> max_protrusion{};
  std::optional<double> max_protrusion_share{};  ///< largest protrusion as a share of the diagonal of each link's box
  double padding = 0;                            ///< length added to every radius, 0 or more, mesh units
  double min_radius = 0;                         ///< smallest radius, mesh units; smaller spheres are enlarged
  /// Largest radius, above 0, mesh units; links use as many spheres as this requires.
  std::optional<double> max_radius{};
  bool visual = false;           ///< true: fit the visual shapes instead of the collision shapes
  std::set<std::string> skip{};  ///< links without spheres
  std::map<std::string, std::vector<Sphere>> fixed_spheres{};  ///< links with given spheres, which are certified again
  /// Planes by link: the part of a link beyond one of its planes need not be covered, up to rounding.
  std::map<std::string, std::vector<ClipPlane>> clip{};
  /// Distance to a plane within which the link need not be covered either, mesh units; no sphere then reaches beyond a
  /// plane, with any number of spheres. It must exceed the padding and 2e-6 of the largest |coordinate| if the link
  /// comes that near to a plane.
  std::optional<double> clip_margin{};
  std::size_t inner = 0;  ///< largest number of additional spheres inside the shapes of each link
  Method method = Method::optimized;
  /// Quality of the method optimized; no value: fast. The other methods have only one, `standard`.
  std::optional<Quality> quality{};
  std::uint64_t seed = 1;
  double density = 1000;  ///< density of links without a mass, mass per mesh unit³
  std::stop_token stop{};
  /// Called on any thread, one call at a time, with the completed share of the work, which ascends to 1 at the end.
  std::function<void(double share, const std::string& link)> progress{};
};

struct RobotSpheres;

/// Fits spheres to all links. Throws std::invalid_argument for options out of range and for missing links, FileError
/// for meshes that cannot be used, BuildStopped. The result has the same bits for any number of workers.
RobotSpheres fit_spheres(const Robot& robot, const FitOptions& options = {}, WorkersOrAll workers = {});

struct LinkFigures {
  std::size_t facets = 0;
  bool covered = false;  ///< proven: every point of the shapes is in a sphere, even if numbers are read as float
  /// Largest distance of a point of the shapes from the spheres, mesh units; for spheres among the shapes an upper
  /// bound of it; 0 if covered.
  double uncovered_distance = 0;
  /// Upper bounds of the spheres' protrusion (r + φ(c))⁺, mesh units.
  double protrusion_mean = 0, protrusion_p95 = 0, protrusion_max = 0;
  /// Volume of the shapes, mesh units³; no value if they have no inside, or overlap with spheres.
  std::optional<double> object_volume;
  std::optional<double> outside_volume;  ///< volume inside the spheres and outside the shapes, mesh units³
  /// Largest distance of a sphere beyond a clip plane, mesh units; no value without planes.
  std::optional<double> beyond_clip;
  UnionMass solid{};
  double mass = 0;  ///< mass of the robot's file if given, otherwise density × volume of the union
};

struct LinkSpheres {
  std::size_t link = none;
  std::vector<Sphere> spheres;       ///< spheres in the link's axes, in decimals that files keep
  std::size_t same_shape_as = none;  ///< earlier link with the same shapes; none if there is none
  LinkSurface surface;
  /// Tree whose leaves became these spheres, without padding; nullptr for given spheres.
  std::shared_ptr<const CoveredTree> tree;
  LinkFigures figures;
  /// Inner spheres, each proven to be inside a closed surface of the shapes, and on the kept side of all clip planes,
  /// even if its numbers are read as float.
  std::vector<Sphere> inner;
  double inner_volume = 0;  ///< volume of the union of the inner spheres, mesh units³
  std::vector<std::string> notes;
};

struct RobotSpheres {
  std::vector<LinkSpheres> links;  ///< links with shapes, without skipped links, in the robot's order
  std::vector<std::string> notes;  ///< notes about the robot and the other links
  bool visual = false;             ///< the spheres cover the visual shapes instead of the collision shapes
  std::size_t sphere_count() const;
  bool covered() const;
  const LinkSpheres* of(std::size_t link) const;
  std::size_t inner_count() const;
  /// A copy for writers in which inner spheres replace the covering ones, with the links that have some; the notes of
  /// the others become notes of the robot.
  RobotSpheres with_inner_spheres() const;
};

}  // namespace morula::robot
