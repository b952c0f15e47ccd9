// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// One obstacle of a world, in world axes: what a ball touches, and how far away a point is, in double.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <morula/geometry/box.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/robot/world.hpp>
#include <string_view>

namespace morula::robot {

/// Shapes that single-precision kernels know; they test all others by their bounds only.
enum class ObstacleKind { sphere, box, other };

/// Bounds of a signed distance.
struct DistanceBounds {
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  /// An upper bound of its absolute value.
  double largest() const { return std::max(-lower, upper); }
};

/// An obstacle does not change, so several threads may use one at once.
class Obstacle {
 public:
  explicit Obstacle(ObstacleKind kind_of = ObstacleKind::other) : kind(kind_of) {}
  virtual ~Obstacle() = default;
  Obstacle(const Obstacle&) = delete;
  Obstacle& operator=(const Obstacle&) = delete;

  /// True if the ball touches the obstacle. This test, computed in double, is the definition of a contact.
  virtual bool touches(const Sphere& ball) const = 0;
  /// True only if no ball inside this one touches. It is fast, and false where that is not plain.
  virtual bool is_clear_of(const Sphere& /*ball*/) const { return false; }
  /// Bounds of the signed distance of p as computed, without a search.
  virtual DistanceBounds bounds_at(const Vec3& /*p*/) const { return {}; }
  /// The signed distance of p and its direction; an infinite distance if it exceeds `within`. Leaves `obstacle` unset.
  /// Its rounding may differ from that of touches().
  virtual NearestObstacle nearest(const Vec3& p, double within) const = 0;

  const ObstacleKind kind;
  /// Contains the obstacle, also as computed in double. Infinite where the obstacle has no end.
  Box bounds{};
  /// For bounds of rounding: at least the largest |coordinate| that enters the obstacle's computations, and how far its
  /// pose is from a rotation.
  double magnitude = 0, deviation = 0;

 protected:
  /// Sets the bounds, enlarged for rounding, and the magnitude. own_coordinates: a bound of the numbers in axes of the
  /// obstacle's own, which the pose may cancel.
  void set_bounds(const Box& box, double own_coordinates = 0);
};

/// The single sphere, and the box, for kernels.
struct SphereObstacle final : Obstacle {
  explicit SphereObstacle(const Sphere& sphere);
  bool touches(const Sphere& ball) const override;
  NearestObstacle nearest(const Vec3& p, double within) const override;
  const Sphere shape;
};
struct BoxObstacle final : Obstacle {
  explicit BoxObstacle(const ObstacleBox& box);
  bool touches(const Sphere& ball) const override;
  NearestObstacle nearest(const Vec3& p, double within) const override;
  const ObstacleBox shape;
};

using ObstaclePointer = std::shared_ptr<const Obstacle>;
ObstaclePointer capsule_obstacle(const Capsule& capsule);
/// A mesh in world axes. It is solid if it is closed and oriented, otherwise its surface alone.
ObstaclePointer mesh_obstacle(const MeshView& mesh);
/// The union of spheres, of which there is at least one. The distance is the least of those from single spheres.
ObstaclePointer spheres_obstacle(std::span<const Sphere> spheres);
ObstaclePointer height_obstacle(const HeightField& field);

/// A pose whose rows are orthonormal up to rounding: bounds around what it places allow for rounding alone. Throws as
/// rigid_or_throw().
RigidTransform exact_pose(const RigidTransform& pose, std::string_view what);

/// True if all numbers are finite and of at most greatest_usable_scale.
inline bool has_usable_size(const Vec3& v) {
  return max_norm(v) <= greatest_usable_scale && is_finite(v);
}

/// The place at this signed distance, or nothing if it exceeds `within`.
inline NearestObstacle place_at(double distance, const Vec3& direction, double within) {
  return distance <= within ? NearestObstacle{.distance = distance, .direction = direction} : NearestObstacle{};
}

/// A world's obstacles, by number. Copies of a world share them.
struct World::Data {
  std::vector<ObstaclePointer> obstacles;
};

}  // namespace morula::robot
