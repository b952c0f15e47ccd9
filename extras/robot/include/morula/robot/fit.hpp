// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres for a robot: a set for every link that covers its shapes, proven for the very numbers that files hold.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <morula/accuracy/measure.hpp>
#include <morula/generators/build.hpp>
#include <morula/robot/robot.hpp>
#include <set>

namespace morula::robot {

/// Half of space in a link's axes: what is kept has normal · x ≥ offset.
struct ClipPlane {
  Vec3 normal{0, 0, 1};  ///< unit, towards what is kept
  double offset = 0;
  bool operator==(const ClipPlane&) const = default;
};

struct FitOptions {
  std::size_t spheres = 16;  ///< most of a link; 0: as many as max_protrusion needs
  /// Most of the whole robot, 1 or more, shared so that the next sphere goes where it takes away most outside volume.
  std::optional<std::size_t> max_total{};
  std::map<std::string, std::size_t> link_spheres{};  ///< most of single links, instead of these two
  std::optional<double> max_protrusion{};  ///< as few as needed to stick out by at most so much, above 0, mesh units
  std::optional<double> max_protrusion_share{};  ///< the same as a share of the diagonal of each link's box
  double padding = 0;                            ///< added to every radius, 0 or more
  double min_radius = 0;                         ///< smaller ones are enlarged
  std::optional<double> max_radius{};            ///< above 0; as many spheres as it takes for none to be larger
  bool visual = false;                           ///< the visual shapes, not those of collision
  std::set<std::string> skip{};                  ///< links that get none
  std::map<std::string, std::vector<Sphere>> fixed_spheres{};  ///< links that keep these, which are certified anew
  /// What lies beyond one of a link's planes is left out, up to rounding: it need not be covered.
  std::map<std::string, std::vector<ClipPlane>> clip{};
  /// What is nearer to a plane than this is left out, too, and no sphere reaches beyond one, however many it takes. It
  /// has to be more than the padding and 2e-6 of the largest |coordinate| where something is that near.
  std::optional<double> clip_margin{};
  std::size_t inner = 0;  ///< how many spheres each link also gets inside its shapes, at most
  Method method = Method::optimized;
  Quality quality = Quality::fast;
  std::uint64_t seed = 1;
  double density = 1000;  ///< of links without a mass, mass over mesh units cubed
  std::stop_token stop{};
  std::function<void(double share, const std::string& link)> progress{};  ///< on any thread, one call at a time
};

struct LinkFigures {
  std::size_t facets = 0;
  bool covered = false;  ///< proven: every point of the shapes is in a sphere, also when numbers are read as float
  double uncovered_distance = 0;  ///< largest distance of a point of the shapes from the spheres; 0 when covered
  double protrusion_mean = 0, protrusion_p95 = 0, protrusion_max = 0;  ///< over spheres, of (r + φ(c))⁺: upper bounds
  std::optional<double> object_volume;   ///< nothing: the shapes tell no inside from outside, or overlap with spheres
  std::optional<double> outside_volume;  ///< inside the spheres and outside the shapes
  std::optional<double> beyond_clip;     ///< how far a sphere reaches beyond a clip plane; nothing: there is none
  UnionMass solid{};
  double mass = 0;  ///< the robot's own where it gives one, else density × volume of the union
};

struct LinkSpheres {
  std::size_t link = none;
  std::vector<Sphere> spheres;       ///< in the link's axes, in decimals that files hold
  std::size_t same_shape_as = none;  ///< the link whose shapes are the same, where there was one before
  LinkSurface surface;
  std::shared_ptr<const CoveredTree> tree;  ///< whose leaves became these, without padding; none for spheres alone
  LinkFigures figures;
  /// Each proven to be inside a closed surface of the shapes, and on the side of all clip planes that is kept, also
  /// when its numbers are read as float.
  std::vector<Sphere> inner;
  double inner_volume = 0;  ///< of the union of the inner spheres
  std::vector<std::string> notes;
};

struct RobotSpheres {
  std::vector<LinkSpheres> links;  ///< those with shapes and not left out, in the robot's order
  std::vector<std::string> notes;  ///< about links that are not among them
  bool visual = false;             ///< the spheres cover the visual shapes, not those of collision
  std::size_t sphere_count() const;
  bool covered() const;
  const LinkSpheres* of(std::size_t link) const;
  std::size_t inner_count() const;
  /// The inner spheres in the place of those that cover, of the links that have some: for writers.
  RobotSpheres with_inner_spheres() const;
};

/// Throws std::invalid_argument for options out of range and links that are not there, FileError for meshes that cannot
/// be used, BuildStopped. The same bits for any number of workers.
RobotSpheres fit_spheres(const Robot& robot, const FitOptions& options = {}, WorkersOrAll workers = {});

}  // namespace morula::robot
