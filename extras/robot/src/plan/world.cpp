// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/geometry/scale.hpp>
#include <morula/robot/world.hpp>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"
#include "plan/obstacle.hpp"

namespace morula::robot {
namespace {

using detail::StandardFloats;

void require_obstacle(bool condition, const char* text) {
  if (!condition) throw std::invalid_argument(std::string("World::add") + text);
}

RigidTransform require_pose(const RigidTransform& pose, const char* what) {
  const RigidTransform rigid = exact_pose(pose, what);
  require_obstacle(has_usable_size(rigid.translation), ": the position of an obstacle is beyond greatest_usable_scale");
  return rigid;
}

// Copies of a world share its list until one of them changes.
std::size_t add_to(std::shared_ptr<World::Data>& data, ObstaclePointer obstacle) {
  if (data.use_count() > 1) data = std::make_shared<World::Data>(*data);
  data->obstacles.push_back(std::move(obstacle));
  return data->obstacles.size() - 1;
}

}  // namespace

World::World() : data_(std::make_shared<Data>()) {}
World::World(const World&) = default;
World& World::operator=(const World&) = default;
// The world that was moved from is empty.
World::World(World&& other) noexcept : data_(std::make_shared<Data>()) {
  data_.swap(other.data_);
}
World& World::operator=(World&& other) noexcept {
  World taken(std::move(other));
  data_.swap(taken.data_);
  return *this;
}
World::~World() = default;

std::size_t World::add(const Sphere& sphere) {
  const StandardFloats standard;
  require_obstacle(has_usable_scale(sphere), ": a sphere needs a usable center and a radius of 0 or more");
  return add_to(data_, std::make_shared<SphereObstacle>(sphere));
}

std::size_t World::add(const ObstacleBox& box) {
  const StandardFloats standard;
  const Vec3& half = box.half;
  require_obstacle(has_usable_size(half) && half.x >= 0 && half.y >= 0 && half.z >= 0,
                   ": a box needs usable half lengths of 0 or more");
  return add_to(data_, std::make_shared<BoxObstacle>(ObstacleBox{require_pose(box.pose, "World::add: a box"), half}));
}

std::size_t World::add(const Capsule& capsule) {
  const StandardFloats standard;
  require_obstacle(has_usable_scale(Sphere{capsule.p, capsule.radius}) && has_usable_size(capsule.q),
                   ": a capsule needs usable ends and a radius of 0 or more");
  return add_to(data_, capsule_obstacle(capsule));
}

std::size_t World::add(const MeshView& mesh, const RigidTransform& pose) {
  const StandardFloats standard;
  require_usable(mesh);
  const RigidTransform at = require_pose(pose, "World::add: the pose of a mesh");
  Mesh placed = to_mesh(mesh);
  if (at != RigidTransform{}) {
    for (Vec3& p : placed.positions) p = at(p);
  }
  require_usable_scale(placed);
  return add_to(data_, mesh_obstacle(placed));
}

std::size_t World::add(const HeightField& field) {
  const StandardFloats standard;
  require_obstacle(field.columns >= 2 && field.rows >= 2 && field.columns <= 0xffff && field.rows <= 0xffff &&
                       field.heights.size() == field.columns * field.rows,
                   ": a height field needs 2 to 65535 columns and rows, and columns x rows heights");
  require_obstacle(
      field.spacing > 0 &&
          has_usable_size({field.spacing * static_cast<double>(std::max(field.columns, field.rows)), 0, 0}),
      ": a height field needs a usable spacing above 0");
  for (const double height : field.heights)
    require_obstacle(has_usable_size({0, 0, height}), ": a height is not usable");
  HeightField placed = field;
  placed.pose = require_pose(field.pose, "World::add: the pose of a height field");
  return add_to(data_, height_obstacle(placed));
}

std::size_t World::add_points(std::span<const Vec3> points, double radius) {
  std::vector<Sphere> spheres;
  spheres.reserve(points.size());
  for (const Vec3& p : points) spheres.push_back({p, radius});
  return add_spheres(spheres);
}

std::size_t World::add_spheres(std::span<const Sphere> spheres) {
  const StandardFloats standard;
  require_obstacle(!spheres.empty() && spheres.size() < 0x7fffffff, ": an obstacle of spheres needs 1 to 2^31 of them");
  const auto bad = std::find_if(spheres.begin(), spheres.end(), [](const Sphere& s) { return !has_usable_scale(s); });
  if (bad != spheres.end()) {
    throw std::invalid_argument("World::add: sphere or point number " + std::to_string(bad - spheres.begin()) +
                                " needs finite coordinates of usable size and a radius of 0 or more; leave out points "
                                "that a camera did not measure");
  }
  return add_to(data_, spheres_obstacle(spheres));
}

std::size_t World::size() const {
  return data_->obstacles.size();
}

NearestObstacle World::nearest(const Vec3& p, double within) const {
  const StandardFloats standard;
  if (!has_usable_size(p)) throw std::invalid_argument("World::nearest: a point needs usable coordinates");
  NearestObstacle best;
  double limit = within;
  for (std::size_t i = 0; i < data_->obstacles.size(); ++i) {
    NearestObstacle found = data_->obstacles[i]->nearest(p, limit);
    if (!(found.distance < best.distance)) continue;
    best = found;
    best.obstacle = i;
    limit = found.distance;
  }
  return best;
}

}  // namespace morula::robot
