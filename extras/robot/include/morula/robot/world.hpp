// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The world of a robot: the obstacles among which it plans. They do not move; for another place, make another world.
//
//   morula::robot::World world;
//   world.add(morula::robot::ObstacleBox{.pose = table_pose, .half = {0.5, 0.4, 0.02}});
//   const std::size_t shelf = world.add(morula::read_mesh("shelf.stl"), shelf_pose);
//   const std::size_t cloud = world.add_points(points, 0.01);
#pragma once

#include <limits>
#include <memory>
#include <morula/collide/primitives.hpp>
#include <morula/geometry/mesh_view.hpp>
#include <morula/robot/sphere_robot.hpp>
#include <span>

namespace morula::robot {

/// A terrain over a grid in the plane z = 0 of its own axes: the height at column i and row k is heights[k * columns +
/// i], over the point (i * spacing, k * spacing). Each cell is two triangles, cut from (i, k) to (i + 1, k + 1). The
/// solid is everything below, with no lower end; it ends at the borders of the grid.
struct HeightField {
  std::span<const double> heights{};  ///< columns × rows numbers, finite, mesh units
  std::size_t columns = 0, rows = 0;  ///< 2 or more each
  double spacing = 1;                 ///< edge of a cell, above 0, mesh units
  RigidTransform pose{};              ///< pose of the grid
};

/// The place in a world that is nearest to a point.
struct NearestObstacle {
  /// Signed distance of the point from the obstacle, mesh units; negative inside. Infinite if every obstacle is farther
  /// away than the limit of the search.
  double distance = std::numeric_limits<double>::infinity();
  Vec3 direction{};             ///< unit vector along which the distance grows; 0 if it is infinite
  std::size_t obstacle = none;  ///< number of the obstacle; the lowest of equals
};

/// Obstacles, numbered in the order in which they were added, from 0. All are solid: spheres, boxes, capsules, closed
/// meshes, and the spheres around points. A mesh that is not closed (MeshReport::has_volume) is its surface only.
///
/// Copies share their data. Several threads may ask one world at once; only add() needs a world to itself.
class World {
 public:
  World();
  World(const World&);
  World& operator=(const World&);
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  /// Each adds an obstacle, in world axes, and returns its number. Throws std::invalid_argument for numbers that are
  /// not finite or beyond greatest_usable_scale, negative lengths, poses that rigid_or_throw() rejects, and meshes that
  /// require_usable() rejects. A pose that deviates from a rotation by more than rounding counts as the nearest one.
  std::size_t add(const Sphere& sphere);
  std::size_t add(const ObstacleBox& box);
  std::size_t add(const Capsule& capsule);
  /// Copies the mesh. Cost: that of a SignedDistance, and of at most 33³ of its distances, in a grid around the mesh
  /// that makes queries faster; add a mesh once, not for each query.
  std::size_t add(const MeshView& mesh, const RigidTransform& pose = {});
  std::size_t add(const HeightField& field);
  /// One obstacle: a sphere of this radius around each point, such as those of a depth camera.
  std::size_t add_points(std::span<const Vec3> points, double radius);
  /// One obstacle: the union of these spheres, such as those of another robot. Inside, its distance is minus the depth
  /// in the sphere that the point is deepest in.
  std::size_t add_spheres(std::span<const Sphere> spheres);

  std::size_t size() const;
  /// The nearest obstacle of a point. within: larger distances need not be found, which shortens the search.
  NearestObstacle nearest(const Vec3& p, double within = std::numeric_limits<double>::infinity()) const;

  struct Data;  // for the queries of this library
  const Data& data() const { return *data_; }

 private:
  std::shared_ptr<Data> data_;
};

}  // namespace morula::robot
