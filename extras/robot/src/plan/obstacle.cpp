// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres, boxes, capsules and meshes as obstacles.
#include "plan/obstacle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <morula/query/signed_distance.hpp>
#include <vector>

namespace morula::robot {
namespace {

constexpr Vec3 up{0, 0, 1};

struct CapsuleObstacle final : Obstacle {
  explicit CapsuleObstacle(const Capsule& capsule) : shape(capsule), along(capsule.q - capsule.p) {
    const Vec3 r{shape.radius, shape.radius, shape.radius};
    Box box;
    for (const Vec3& end : {shape.p, shape.q}) box.add(end - r), box.add(end + r);
    set_bounds(box);
  }
  Vec3 on_axis(const Vec3& p) const {
    const double square = squared_length(along);
    const double share = square > 0 ? std::clamp(dot(p - shape.p, along) / square, 0.0, 1.0) : 0.0;
    return share == 1 ? shape.q : shape.p + share * along;
  }
  bool touches(const Sphere& ball) const override {
    const double reach = ball.radius + shape.radius;
    return squared_distance(ball.center, on_axis(ball.center)) <= reach * reach;
  }
  NearestObstacle nearest(const Vec3& p, double within) const override {
    const Vec3 offset = p - on_axis(p);
    // On the axis every direction at right angles to it leads out.
    const Vec3 flat = std::abs(along.x) <= std::abs(along.y) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    return place_at(length(offset) - shape.radius, normalized(offset, normalized(cross(along, flat), up)), within);
  }
  const Capsule shape;
  const Vec3 along;
};

/// Signed distances at the centers of cubes around a mesh. Distances of two points differ by at most the distance of
/// the points, and their signs only if the surface lies between them. So the entry of a point's cube bounds the
/// point's.
class DistanceGrid {
 public:
  DistanceGrid(const SignedDistance& distance, bool solid, const Box& box) : box_(box) {
    constexpr double along_longest = 30;  // cubes, and one or two more at each end
    const Vec3 extent = box.extent();
    edge_ = std::max({extent.x, extent.y, extent.z}) / along_longest;
    if (!(edge_ > 0)) return;
    lower_ = box.lower - Vec3{edge_, edge_, edge_};
    for (int k = 0; k < 3; ++k) counts_[static_cast<std::size_t>(k)] = static_cast<std::size_t>(extent[k] / edge_) + 3;
    allowance_ = 1e-12 * largest_coordinate(box) + 1e-12 * edge_;
    entries_.reserve(counts_[0] * counts_[1] * counts_[2]);
    double known = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < counts_[0] * counts_[1] * counts_[2]; ++i) {
      if (i % counts_[0] == 0) known = std::numeric_limits<double>::infinity();
      const double d = distance.at(center(i), known).distance;
      known = std::abs(d) + 1.01 * edge_;
      entries_.push_back(static_cast<float>(solid ? d : std::abs(d)));
    }
  }

  /// Bounds of the distance at p, as computed.
  DistanceBounds at(const Vec3& p) const {
    const Vec3 q = min(max(p, box_.lower), box_.upper);
    const DistanceBounds bound = inside(q);
    if (q == p) return bound;
    // The surface is in the box, and q is the box's nearest point to p: every point s of the surface is at an angle of
    // at least 90 degrees there, hence |p - s|² >= |p - q|² + |q - s|². p is outside.
    // mutant grid-corner: `std::max(bound.lower, 0.0)` -> `bound.upper`
    const double away = scaled_length(p - q), below = scaled_length({away, std::max(bound.lower, 0.0), 0});
    return {below * (1 - 1e-12) - allowance_, (away + bound.largest()) * (1 + 1e-12) + allowance_};
  }

 private:
  /// For points in the box.
  DistanceBounds inside(const Vec3& p) const {
    if (entries_.empty()) return {};
    std::size_t place = 0, stride = 1;
    for (int k = 0; k < 3; ++k) {
      const double share = (p[k] - lower_[k]) / edge_;
      const std::size_t count = counts_[static_cast<std::size_t>(k)];
      if (!(share >= 0 && share < static_cast<double>(count))) return {};
      place += stride * static_cast<std::size_t>(share);
      stride *= count;
    }
    // The entry is rounded to float, and all of this in double.
    // mutant grid-reach: `distance(p, center(place)) +` -> `0.5 * distance(p, center(place)) +`
    const double d = entries_[place], reach = distance(p, center(place)) + 0x1p-22 * std::abs(d) + allowance_;
    if (d > reach) return {d - reach, d + reach};
    if (d < -reach) return {d - reach, d + reach};
    return {-std::abs(d) - reach, std::abs(d) + reach};
  }
  Vec3 center(std::size_t i) const {
    const auto along = [&](std::size_t n) { return (static_cast<double>(n) + 0.5) * edge_; };
    return lower_ + Vec3{along(i % counts_[0]), along(i / counts_[0] % counts_[1]), along(i / counts_[0] / counts_[1])};
  }
  Box box_;
  Vec3 lower_{};
  double edge_ = 0, allowance_ = 0;
  std::array<std::size_t, 3> counts_{};
  std::vector<float> entries_;
};

struct MeshObstacle final : Obstacle {
  explicit MeshObstacle(const MeshView& mesh)
      : distance(mesh), solid(distance.has_volume()), grid(distance, solid, bounding_box(mesh)) {
    set_bounds(bounding_box(mesh));
  }
  bool touches(const Sphere& ball) const override {
    const DistanceBounds bound = grid.at(ball.center);
    if (bound.upper <= ball.radius) return true;
    if (bound.lower > ball.radius) return false;
    const double d = distance.at(ball.center, bound.largest()).distance;
    return (solid ? d : std::abs(d)) <= ball.radius;
  }
  bool is_clear_of(const Sphere& ball) const override { return grid.at(ball.center).lower > ball.radius * (1 + 1e-12); }
  DistanceBounds bounds_at(const Vec3& p) const override { return grid.at(p); }
  NearestObstacle nearest(const Vec3& p, double within) const override {
    // Within the bounds p may be inside, where also a negative `within` leaves something to find.
    const double outside = scaled_length(max(max(bounds.lower - p, p - bounds.upper), Vec3{}));
    if (outside > 0 && outside > within) return {};
    const DistanceBounds bound = grid.at(p);
    if (bound.lower > within) return {};
    const SignedDistance::Result result = distance.at(p, bound.largest());
    const bool inside = solid && result.distance < 0;
    const Vec3 offset = inside ? result.closest.point - p : p - result.closest.point;
    const Vec3 normal = distance.orientation() * area_vector(distance.bvh().triangle(result.closest.facet));
    return place_at(solid ? result.distance : std::abs(result.distance), normalized(offset, normalized(normal, up)),
                    within);
  }
  const SignedDistance distance;
  const bool solid;
  const DistanceGrid grid;
};

}  // namespace

RigidTransform exact_pose(const RigidTransform& pose, std::string_view what) {
  const RigidTransform rigid = rigid_or_throw(pose, what);
  // mutant robot-exact-pose: `1e-14` -> `1`
  return deviation_from_rigid(rigid) <= 1e-14 ? rigid : orthonormalized(rigid);
}

void Obstacle::set_bounds(const Box& box, double own_coordinates) {
  // Positions on the obstacle are products of a few numbers of at most this size.
  magnitude = largest_coordinate(box) + own_coordinates;
  const double more = 1e-12 * magnitude;
  const Vec3 all{more, more, more};
  bounds = {box.lower - all, box.upper + all};
}

SphereObstacle::SphereObstacle(const Sphere& sphere) : Obstacle(ObstacleKind::sphere), shape(sphere) {
  const Vec3 r{shape.radius, shape.radius, shape.radius};
  set_bounds({shape.center - r, shape.center + r});
}

bool SphereObstacle::touches(const Sphere& ball) const {
  const double reach = ball.radius + shape.radius;
  return squared_distance(ball.center, shape.center) <= reach * reach;
}

NearestObstacle SphereObstacle::nearest(const Vec3& p, double within) const {
  const Vec3 offset = p - shape.center;
  return place_at(length(offset) - shape.radius, normalized(offset, up), within);
}

BoxObstacle::BoxObstacle(const ObstacleBox& box) : Obstacle(ObstacleKind::box), shape(box) {
  Box corners;
  for (int k = 0; k < 8; ++k) {
    const Vec3& h = shape.half;
    corners.add(shape.pose(Vec3{(k & 1) != 0 ? h.x : -h.x, (k & 2) != 0 ? h.y : -h.y, (k & 4) != 0 ? h.z : -h.z}));
  }
  set_bounds(corners);
  deviation = deviation_from_rigid(shape.pose);
}

bool BoxObstacle::touches(const Sphere& ball) const {
  const Vec3 p = shape.pose.inverse_rotate(ball.center - shape.pose.translation);
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double beyond = std::max(0.0, std::abs(p[k]) - shape.half[k]);
    squared += beyond * beyond;
  }
  return squared <= ball.radius * ball.radius;
}

NearestObstacle BoxObstacle::nearest(const Vec3& p, double within) const {
  const Vec3 local = shape.pose.inverse_rotate(p - shape.pose.translation);
  const Vec3 beyond{std::abs(local.x) - shape.half.x, std::abs(local.y) - shape.half.y,
                    std::abs(local.z) - shape.half.z};
  Vec3 direction{};
  double distance = 0;
  if (beyond.x > 0 || beyond.y > 0 || beyond.z > 0) {
    const Vec3 out = max(beyond, Vec3{});
    distance = scaled_length(out);
    for (int k = 0; k < 3; ++k) direction[k] = std::copysign(out[k] / distance, local[k]);
  } else {
    // The nearest face; the first axis of equals.
    const int k = beyond.x >= beyond.y && beyond.x >= beyond.z ? 0 : beyond.y >= beyond.z ? 1 : 2;
    distance = beyond[k];
    direction[k] = std::copysign(1.0, local[k]);
  }
  return place_at(distance, shape.pose.rotate(direction), within);
}

ObstaclePointer capsule_obstacle(const Capsule& capsule) {
  return std::make_shared<CapsuleObstacle>(capsule);
}

ObstaclePointer mesh_obstacle(const MeshView& mesh) {
  return std::make_shared<MeshObstacle>(mesh);
}

}  // namespace morula::robot
