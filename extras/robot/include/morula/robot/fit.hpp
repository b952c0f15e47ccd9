// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres for a robot: for every link a set that covers its shapes, proven for the numbers as files store them.
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

/// A plane that cuts a link, in the link's axes. The part with normal · x ≥ offset is kept, and has to be covered.
struct ClipPlane {
  Vec3 normal{0, 0, 1};  ///< unit vector toward the kept part
  double offset = 0;     ///< mesh units
  bool operator==(const ClipPlane&) const = default;
};

struct FitOptions {
  /// Largest number of spheres of a link; 0: as many as the largest protrusion requires. No value: 0 with a largest
  /// protrusion, otherwise a number that follows the size of the link: 16 a mesh on average, shared in proportion to
  /// the power 3/4 of the surface of each mesh's box, at least 1 each; spheres among the shapes come on top.
  std::optional<std::size_t> spheres{};
  /// Largest number of spheres of the whole robot, 1 or more, including `link_spheres` and `fixed_spheres`; `spheres`
  /// then has no effect. Every link gets at least one; each further sphere goes to the link where it reduces the
  /// estimated outside volume most. If the links need more, they get more, and a note says so.
  std::optional<std::size_t> max_total{};
  /// Largest number of spheres of single links, by name, 1 or more; it replaces the two numbers above for these links.
  std::map<std::string, std::size_t> link_spheres{};
  /// Largest protrusion of a sphere out of its link, above 0, mesh units; each link uses as few spheres as it can. If
  /// the number of spheres does not suffice, a note in LinkSpheres::notes says so.
  std::optional<double> max_protrusion{};
  /// Largest protrusion as a share of the diagonal of each link's box, above 0. If both are set, the smaller length
  /// counts.
  std::optional<double> max_protrusion_share{};
  /// Distance within which the spheres have to cover the shapes, 0 or more, mesh units; above 0 only for the method
  /// `optimized`. Spheres then leave surface uncovered on purpose and are fitted for less outside volume; every point
  /// of the shapes is proven to lie within the tolerance of a sphere (LinkFigures::within). Spheres that lie inside a
  /// closed mesh are as large as that allows; a mesh that is open has no inside. Spheres that are divided further for
  /// max_radius or clip_margin are fitted to cover and then reduced by the tolerance: more of them than it requires.
  double tolerance = 0;
  /// Largest share of the surface of the robot's shapes, balls left out, that may be in no sphere; above 0, at most 1,
  /// with a tolerance above 0 and without max_protrusion. Spheres are then placed for the least outside volume with
  /// that share over all links, instead of for the tolerance alone; thin spheres that reach the surface in many places
  /// are what planners usually get. Where a mesh is open, inside is where its winding number exceeds one half. Links
  /// with clip planes or balls are fitted for the tolerance alone. If the share is not reached, a note says so. It
  /// takes several times as long.
  std::optional<double> max_uncovered{};
  double padding = 0;     ///< length added to every radius after the fit, 0 or more, mesh units
  double min_radius = 0;  ///< smallest radius, 0 or more, mesh units; smaller radii are increased to it
  /// Largest radius, with padding, above 0, mesh units; links use more spheres than requested if it requires that. If
  /// 256 spheres or an octree of full depth do not suffice, a note in LinkSpheres::notes says so.
  std::optional<double> max_radius{};
  bool visual = false;           ///< true: fit the visual shapes; false: the collision shapes
  std::set<std::string> skip{};  ///< names of links that get no spheres
  /// Given spheres by link, in the link's axes. They are certified, measured and returned unchanged.
  std::map<std::string, std::vector<Sphere>> fixed_spheres{};
  /// Planes by link. The part of a link beyond any of its planes is cut off and does not need to be covered, up to
  /// rounding.
  std::map<std::string, std::vector<ClipPlane>> clip{};
  /// Distance to a plane within which the link also does not need to be covered, above 0, mesh units. The fit then
  /// divides spheres until none reaches beyond a plane, in more spheres than requested if necessary. If the link comes
  /// near to a plane, the margin must exceed the padding plus 2e-6 of the link's largest |coordinate|. No value:
  /// spheres may reach beyond planes.
  std::optional<double> clip_margin{};
  std::size_t inner = 0;  ///< largest number of additional spheres inside the shapes of each link
  Method method = Method::optimized;
  /// Quality of the method `optimized`; no value: fast. The other methods have only one, `standard`.
  std::optional<Quality> quality{};
  std::uint64_t seed = 1;  ///< seed of all random choices
  double density = 1000;   ///< density of links without a mass in the robot's file, above 0, mass per mesh unit³
  StopToken stop{};        ///< a stop request makes fit_spheres() throw BuildStopped
  /// Called with the completed share of the work, which rises to 1 at the end, and the name of the link that is done;
  /// on any thread, one call at a time.
  std::function<void(double share, const std::string& link)> progress{};
};

struct RobotSpheres;

/// Fits spheres to all links that have shapes. Links with the same shapes and options share one fit. The result has the
/// same bits for any number of workers; by default there is one thread per processor. Throws std::invalid_argument for
/// options out of range and for names of links that the robot lacks, FileError for meshes that cannot be read or used,
/// and BuildStopped on a stop request.
RobotSpheres fit_spheres(const Robot& robot, const FitOptions& options = {}, WorkersOrAll workers = {});

/// Measurements of one link with its spheres.
struct LinkFigures {
  std::size_t facets = 0;  ///< facets of the link's surface
  /// True: every point of the shapes that has to be covered is proven to be in a sphere, also if a reader rounds the
  /// numbers to float.
  bool covered = false;
  /// Proven: every point of the shapes that has to be covered lies within this distance of a sphere, also if a reader
  /// rounds the numbers to float; mesh units; 0 if covered. At most the tolerance of the fit, for spheres that it made.
  double within = 0;
  /// Largest distance of a point of the shapes from the spheres, mesh units; for spheres among the shapes an upper
  /// bound of it; 0 if covered.
  double uncovered_distance = 0;
  /// Share of the surface that is in no sphere, in closed form; spheres among the shapes do not count; 0 if covered.
  double uncovered_share = 0;
  /// Mean, 95th percentile and maximum of upper bounds of the spheres' protrusion out of the shapes, mesh units.
  double protrusion_mean = 0, protrusion_p95 = 0, protrusion_max = 0;
  /// Volume of the shapes, mesh units³; no value if they have no inside, or are both spheres and others.
  std::optional<double> object_volume;
  /// Volume inside the spheres and outside the shapes, mesh units³; no value if object_volume has none.
  std::optional<double> outside_volume;
  /// Largest distance by which a sphere reaches beyond a clip plane, mesh units; no value without planes.
  std::optional<double> beyond_clip;
  UnionMass solid{};  ///< volume, center and inertia of the union of the spheres
  double mass = 0;    ///< mass from the robot's file if that is above 0, otherwise density × volume of the union
};

/// The spheres of one link.
struct LinkSpheres {
  std::size_t link = none;      ///< index in Robot::links
  std::vector<Sphere> spheres;  ///< spheres in the link's axes, rounded to the decimals that files have
  /// Index of an earlier link whose fit this link shares, because the shapes are the same; `none`: it has its own.
  std::size_t same_shape_as = none;
  LinkSurface surface;  ///< surface of the shapes, without the parts that planes cut off
  /// Tree whose leaves became spheres, before they were reduced by the tolerance or grew inside the shapes, and were
  /// padded and rounded: it covers;
  /// nullptr for given spheres and for shapes that are all spheres. With max_uncovered it covers also, but its leaves
  /// are other spheres.
  std::shared_ptr<const CoveredTree> tree;
  LinkFigures figures;
  /// Inner spheres. Each is proven to be inside a closed surface of the shapes and on the kept side of all clip planes,
  /// also if a reader rounds its numbers to float.
  std::vector<Sphere> inner;
  double inner_volume = 0;         ///< volume of the union of the inner spheres, mesh units³
  std::vector<std::string> notes;  ///< limits that the fit did not keep, and fallbacks, as text
};

/// The result of fit_spheres().
struct RobotSpheres {
  std::vector<LinkSpheres> links;  ///< links that have spheres, in the robot's order
  std::vector<std::string> notes;  ///< links that got no spheres, and notes on their meshes, as text
  bool visual = false;             ///< true: the spheres cover the visual shapes; false: the collision shapes
  std::size_t sphere_count() const;
  /// True if LinkFigures::covered is true for all links.
  bool covered() const;
  /// The largest LinkFigures::within of all links: 0 if covered.
  double within() const;
  /// The share of the surface of all links that is in no sphere, spheres among the shapes left out. Cost: linear in
  /// facets.
  double uncovered_share() const;
  /// The spheres of a link, by its index in Robot::links; nullptr if it has none.
  const LinkSpheres* of(std::size_t link) const;
  std::size_t inner_count() const;
  /// A copy for writers of files: it has the links with inner spheres, and these spheres in place of the covering ones.
  /// The notes of the other links become notes of the robot.
  RobotSpheres with_inner_spheres() const;
};

}  // namespace morula::robot
