// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Queries of planners: many configurations of a robot in one call, in a world of obstacles and against the robot
// itself.
//
//   const morula::robot::ConfigurationQuery query(robot, spheres, self_collision);
//   std::vector<morula::robot::ConfigurationVerdict> verdicts(count);
//   query.check(configurations, world, verdicts);           // count × coordinates numbers
//   query.check_motions(from, to, world, motion_verdicts);  // edges of a roadmap, certified
//   query.clearance(configurations, world, clearances, gradients);
#pragma once

#include <cstdint>
#include <morula/parallel/workers.hpp>
#include <morula/robot/world.hpp>
#include <string_view>

namespace morula::robot {

/// The first contact of a configuration: of the lowest link that touches an obstacle, with the lowest obstacle that it
/// touches. If no link touches one: of two links of the robot, the pair with the lowest `link`, then the lowest
/// `other_link`, where link < other_link.
struct ConfigurationVerdict {
  std::uint32_t link = free_link;        ///< index in Robot::links; free_link: there is no contact
  std::uint32_t other_link = free_link;  ///< second link, for a contact of the robot with itself
  std::uint32_t obstacle = free_link;    ///< number in the world, for a contact with it
  static constexpr std::uint32_t free_link = 0xffffffff;
  bool is_free() const { return link == free_link; }
  bool operator==(const ConfigurationVerdict&) const = default;
};

/// The least distance of a robot from what it may collide with.
struct Clearance {
  /// Least signed distance over all spheres of the robot and all obstacles, and over all tested pairs of spheres of two
  /// links, mesh units; negative: the depth of the deepest contact. Limited to ClearanceOptions::limit.
  double distance = 0;
  double lower = 0, upper = 0;  ///< bounds of the exact value for the given numbers, rounding included
  std::uint32_t link = ConfigurationVerdict::free_link;  ///< the nearest pair, as in ConfigurationVerdict
  std::uint32_t other_link = ConfigurationVerdict::free_link;
  std::uint32_t obstacle = ConfigurationVerdict::free_link;
};

struct ClearanceOptions {
  /// Distances are of interest up to this, above 0, mesh units: a smaller limit makes queries faster. A configuration
  /// that is farther away has this distance, no pair, and gradient 0.
  double limit = std::numeric_limits<double>::infinity();
  bool world = true, self = true;  ///< what counts
};

/// How an edge between two configurations ends.
enum class MotionResult : std::uint8_t {
  free,       ///< proven: no configuration of the edge has a contact
  touches,    ///< the configuration at `time` has a contact
  undecided,  ///< the robot comes nearer than MotionOptions::tolerance to a contact, and no contact was found; none is
              ///< deeper than that
};

/// The verdict about an edge: the straight line from one configuration to another.
struct MotionVerdict {
  MotionResult result = MotionResult::free;
  /// 0 to 1. touches: a time with a contact; for a certified edge, every earlier part is free or undecided, so that no
  /// earlier contact is deeper than MotionOptions::tolerance, and at a resolution it is the first that was found.
  /// undecided: the middle of the first part that could not be decided, where the robot is nearer than
  /// MotionOptions::tolerance to a contact. free: 1.
  double time = 1;
  ConfigurationVerdict contact{};  ///< of the configuration at `time`, for `touches`
  bool operator==(const MotionVerdict&) const = default;
};

struct MotionOptions {
  /// Above 0: tests configurations at most this far apart, in radians or mesh units of the coordinate that moves most,
  /// as planners usually do: the ends, then repeatedly the middles between tested ones, until one touches. Nothing is
  /// proven between them, and `free` means that they are free. 0: certified.
  double resolution = 0;
  /// Certified edges: every part with at least this gap is proven free, above 0, mesh units. Nearer parts may be
  /// undecided. The cost grows with the length of these parts divided by it. Rounding is the least tolerance: it is
  /// below 1e-9 of the size of robot and world unless there are hundreds of joints or they turn by thousands of
  /// radians.
  double tolerance = 1e-4;
  bool world = true, self = true;  ///< what counts
};

/// A robot's spheres, arranged for many configurations. A configuration is the values of robot.independent_joints, in
/// that order, radians or mesh units; an array of them has one after the other. Joint limits are not checked.
///
/// The world is in the axes in which `base` places the root link. Two spheres collide as in SphereRobot: if the
/// distance of their centers, computed in double, is at most the sum of their radii. Faster single-precision tests come
/// first and leave all doubtful cases to double, so verdicts are the same on every processor and for any number of
/// workers.
///
/// Queries are const; several threads may use one object at once.
class ConfigurationQuery {
 public:
  /// Copies the required data. spheres: a result of fit_spheres() for this robot. Throws as SphereRobot, and for joints
  /// with numbers that are not finite or beyond greatest_usable_scale, including the product of the multipliers of
  /// joints that follow each other.
  ConfigurationQuery(const Robot& robot, const RobotSpheres& spheres, const SelfCollision& self_collision = {});
  ~ConfigurationQuery();
  ConfigurationQuery(const ConfigurationQuery&);
  ConfigurationQuery& operator=(const ConfigurationQuery&);
  ConfigurationQuery(ConfigurationQuery&&) noexcept;
  ConfigurationQuery& operator=(ConfigurationQuery&&) noexcept;

  /// Number of coordinates of a configuration.
  std::size_t coordinates() const;
  /// Places the root link in the world. Throws std::invalid_argument for a pose that rigid_or_throw() rejects, or
  /// beyond greatest_usable_scale. A pose that deviates from a rotation by more than rounding counts as the nearest
  /// one.
  void set_base(const RigidTransform& base);
  /// Fastens an object to a link, such as a grasped part: its spheres move with it, in the link's axes, and count as
  /// that link's. They are tested against all other links with spheres except those in `touching`, and against what
  /// these links hold; ignored pairs of links do not matter for them. Contacts with the obstacles of these numbers do
  /// not count, such as that with the table from which the object is lifted. The link needs no spheres of its own.
  /// Replaces the object that this link held. Throws std::invalid_argument for links that the robot lacks, and for
  /// spheres that tree_from_spheres() rejects.
  void attach(std::string_view link, std::span<const Sphere> spheres, std::span<const std::string> touching = {},
              std::span<const std::size_t> touching_obstacles = {});
  /// The link holds nothing. Throws std::invalid_argument for a link that the robot lacks.
  void detach(std::string_view link) { attach(link, {}); }
  /// Contacts of the link's own spheres with the obstacles of these numbers do not count: those of a base with its
  /// table. The numbers hold in every world that is given later; a world with fewer obstacles lacks some. Replaces the
  /// numbers of an earlier call. Throws std::invalid_argument for a link that the robot lacks.
  void allow_contacts(std::string_view link, std::span<const std::size_t> obstacles);

  /// Checks configurations. verdicts: one per configuration, whose count it gives. Throws std::invalid_argument unless
  /// there are verdicts.size() × coordinates() numbers of at most greatest_usable_scale.
  void check(std::span<const double> configurations, const World& world, std::span<ConfigurationVerdict> verdicts,
             WorkersOrAll workers = {}) const;
  /// Checks the robot against itself alone.
  void check_self(std::span<const double> configurations, std::span<ConfigurationVerdict> verdicts,
                  WorkersOrAll workers = {}) const;

  /// The clearance of each configuration, and its derivatives by the coordinates (the robot moves, the obstacles stay).
  /// gradients: empty, or clearances.size() × coordinates() numbers, mesh units per coordinate: those of the nearest
  /// pair; of pairs that are equally near, the one with the lowest link and obstacle, and links after obstacles.
  ///
  /// Inside a solid obstacle a distance is minus the depth to the surface of that obstacle alone, also where obstacles
  /// overlap; among points or spheres that are one obstacle, that of the sphere that is deepest there. From a center
  /// that every direction leads out of, such as an obstacle's own, the gradient is that of one of these directions,
  /// always the same. The exact value has exact sines and cosines of the coordinates; it takes joints that follow each
  /// other by one multiplier and offset, and meshes with vertices rounded in world axes. Throws std::invalid_argument
  /// as check(), and for a limit of 0 or less and gradients of another size. Cost: that of poses, and of the pairs of
  /// links and obstacles that the nearest pair does not exclude.
  void clearance(std::span<const double> configurations, const World& world, std::span<Clearance> clearances,
                 std::span<double> gradients = {}, const ClearanceOptions& options = {},
                 WorkersOrAll workers = {}) const;

  /// Checks edges: from[i] to to[i], each coordinate in proportion. from, to: verdicts.size() × coordinates() numbers.
  ///
  /// A certified edge is halved until bounds of each sphere's motion prove its parts free. `free` holds for exact
  /// arithmetic on the given numbers, hence for every configuration of the edge that check() computes. Throws
  /// std::invalid_argument for other sizes, numbers that are not finite, options out of range, and edges of more than a
  /// billion configurations at a resolution. Results are the same for any number of workers.
  void check_motions(std::span<const double> from, std::span<const double> to, const World& world,
                     std::span<MotionVerdict> verdicts, const MotionOptions& options = {},
                     WorkersOrAll workers = {}) const;

  struct Model;  // for the queries of this library

 private:
  std::shared_ptr<const Model> model_;
};

}  // namespace morula::robot
