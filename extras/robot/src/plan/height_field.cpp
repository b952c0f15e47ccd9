// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A terrain as an obstacle: everything below a surface of triangles over a grid.
#include <algorithm>
#include <cmath>
#include <morula/query/triangle_bvh.hpp>
#include <optional>

#include "plan/obstacle.hpp"

namespace morula::robot {
namespace {

Mesh terrain_surface(const HeightField& field) {
  Mesh mesh;
  const auto columns = static_cast<std::uint32_t>(field.columns), rows = static_cast<std::uint32_t>(field.rows);
  for (std::uint32_t k = 0; k < rows; ++k) {
    for (std::uint32_t i = 0; i < columns; ++i)
      mesh.positions.push_back({i * field.spacing, k * field.spacing, field.heights[k * columns + i]});
  }
  for (std::uint32_t k = 0; k + 1 < rows; ++k) {
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = k * columns + i, c = a + columns + 1;
      mesh.facets.push_back({a, a + 1, c});
      mesh.facets.push_back({a, c, c - 1});
    }
  }
  return mesh;
}

struct TerrainObstacle final : Obstacle {
  explicit TerrainObstacle(const HeightField& field)
      : pose(field.pose),
        columns(field.columns),
        rows(field.rows),
        spacing(field.spacing),
        heights(field.heights.begin(), field.heights.end()),
        surface(terrain_surface(field)) {
    Box box;
    const Box& local = surface.bounding_box();
    for (int k = 0; k < 8; ++k)
      box.add(pose(Vec3{(k & 1) != 0 ? local.upper.x : local.lower.x, (k & 2) != 0 ? local.upper.y : local.lower.y,
                        (k & 4) != 0 ? local.upper.z : local.lower.z}));
    set_bounds(box, largest_coordinate(local) + max_norm(pose.translation));
    deviation = deviation_from_rigid(pose);
    // It has no lower end.
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const Vec3 down = pose.rotate({0, 0, -1});
    for (int k = 0; k < 3; ++k) {
      if (down[k] < 0) bounds.lower[k] = -infinite;
      if (down[k] > 0) bounds.upper[k] = infinite;
    }
  }

  double width() const { return static_cast<double>(columns - 1) * spacing; }
  double length_of_rows() const { return static_cast<double>(rows - 1) * spacing; }

  // Height of the surface over a point of the grid.
  double height(double x, double y) const {
    const double u = x / spacing, v = y / spacing;
    const std::size_t i = std::min(static_cast<std::size_t>(u), columns - 2),
                      k = std::min(static_cast<std::size_t>(v), rows - 2);
    const double s = std::min(u - static_cast<double>(i), 1.0), t = std::min(v - static_cast<double>(k), 1.0);
    const double* cell = heights.data() + k * columns + i;
    const double h00 = cell[0], h10 = cell[1], h01 = cell[columns], h11 = cell[columns + 1];
    return s >= t ? h00 * (1 - s) + h10 * (s - t) + h11 * t : h00 * (1 - t) + h01 * (t - s) + h11 * s;
  }

  // The nearest place of the solid's border, in the axes of the grid. For a point above the surface, or next to the
  // grid and above the height of its border, that is on the surface; for one next to the grid and below that height, on
  // the wall; for one inside, on either.
  NearestObstacle local_nearest(const Vec3& p, double within) const {
    const Vec3 clamped{std::clamp(p.x, 0.0, width()), std::clamp(p.y, 0.0, length_of_rows()), p.z};
    const bool beside = clamped.x != p.x || clamped.y != p.y, below = p.z <= height(clamped.x, clamped.y);
    if (beside && below) {
      const double d = scaled_length(p - clamped);
      return place_at(d, (p - clamped) / d, within);
    }
    if (!below) {
      const std::optional<ClosestFacetPoint> closest = surface.closest_point(p, within);
      if (!closest) return {};
      return place_at(std::sqrt(closest->squared_distance), normalized(p - closest->point, Vec3{0, 0, 1}), within);
    }
    const ClosestFacetPoint closest = *surface.closest_point(p);
    NearestObstacle result{-std::sqrt(closest.squared_distance), normalized(closest.point - p, Vec3{0, 0, 1})};
    const auto wall = [&](const Vec3& foot, const Vec3& outward) {
      const double d = distance(p, foot);
      if (-d <= result.distance || !(p.z <= height(foot.x, foot.y))) return;
      result.distance = -d;
      result.direction = outward;
    };
    wall({0, p.y, p.z}, {-1, 0, 0}), wall({width(), p.y, p.z}, {1, 0, 0});
    wall({p.x, 0, p.z}, {0, -1, 0}), wall({p.x, length_of_rows(), p.z}, {0, 1, 0});
    return place_at(result.distance, result.direction, within);
  }

  bool touches(const Sphere& ball) const override {
    const Vec3 p = pose.inverse_rotate(ball.center - pose.translation);
    return local_nearest(p, ball.radius * (1 + 1e-12)).distance <= ball.radius;
  }
  NearestObstacle nearest(const Vec3& p, double within) const override {
    NearestObstacle result = local_nearest(pose.inverse_rotate(p - pose.translation), within);
    result.direction = pose.rotate(result.direction);
    return result;
  }

  const RigidTransform pose;
  const std::size_t columns, rows;
  const double spacing;
  const std::vector<double> heights;
  const TriangleBvh surface;
};

}  // namespace

ObstaclePointer height_obstacle(const HeightField& field) {
  return std::make_shared<TerrainObstacle>(field);
}

}  // namespace morula::robot
