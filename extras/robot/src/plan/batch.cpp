// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "plan/batch.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace morula::robot {
namespace {

template <class Function>
void each_lane(unsigned lanes, const Function& function) {
  for (; lanes != 0; lanes &= lanes - 1) function(static_cast<std::size_t>(std::countr_zero(lanes)));
}

}  // namespace

BatchCheck::BatchCheck(const ConfigurationQuery::Model& model, const World::Data* world, bool self)
    : model_(model),
      world_(world),
      self_(self),
      kernels_(filter_kernels()),
      base_size_(max_norm(model.base.translation)) {
  for (const MovingSpheres& group : model.groups) {
    first_.push_back(spheres_.size());
    spheres_.push_back(Spheref{Vec3f(group.bound.center), static_cast<float>(group.bound.radius)});
    extent_ = std::max(extent_, length(group.bound.center) + group.bound.radius);
    for (const Sphere& s : group.spheres) {
      spheres_.push_back(Spheref{Vec3f(s.center), static_cast<float>(s.radius)});
      extent_ = std::max(extent_, length(s.center) + s.radius);
    }
  }
  first_.push_back(spheres_.size());
  for (const Spheref& s : spheres_) radii_.push_back(s.radius);
  poses_.resize(filter_block * model.link_names.size());
  links_.resize(model.groups.size());
  centers_.resize(spheres_.size());
  if (world != nullptr) {
    obstacles_.reserve(world->obstacles.size());
    for (const ObstaclePointer& obstacle : world->obstacles) list_obstacle(*obstacle);
  }
}

void BatchCheck::list_obstacle(const Obstacle& obstacle) {
  FilterObstacle listed;
  const auto take = [&](const Vec3& v, float* numbers) {
    for (int k = 0; k < 3; ++k) numbers[k] = static_cast<float>(v[k]);
  };
  const Vec3 origin = model_.base.translation;
  if (obstacle.kind == ObstacleKind::box) {
    const ObstacleBox& box = static_cast<const BoxObstacle&>(obstacle).shape;
    const Vec3 center = box.pose.translation - origin;
    take(center, listed.box.center), take(box.half, listed.box.half);
    for (int k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < 3; ++i) listed.box.rows[k][i] = static_cast<float>(box.pose.rows[i][k]);
    }
    listed.size = max_norm(center) + max_norm(box.half);
  } else if (obstacle.kind == ObstacleKind::sphere) {
    const Sphere& sphere = static_cast<const SphereObstacle&>(obstacle).shape;
    const Vec3 center = sphere.center - origin;
    listed.sphere = {Vec3f(center), static_cast<float>(sphere.radius)};
    listed.size = max_norm(center) + sphere.radius;
  } else {
    const Vec3 lower = obstacle.bounds.lower - origin, upper = obstacle.bounds.upper - origin;
    take(lower, listed.lower), take(upper, listed.upper);
    for (int k = 0; k < 3; ++k) {
      if (std::isfinite(lower[k])) listed.size = std::max(listed.size, std::abs(lower[k]));
      if (std::isfinite(upper[k])) listed.size = std::max(listed.size, std::abs(upper[k]));
    }
  }
  obstacles_.push_back(listed);
}

std::span<const RigidTransform> BatchCheck::poses_of(std::size_t lane) const {
  const std::size_t links = model_.link_names.size();
  return std::span(poses_).subspan(lane * links, links);
}

PlacedGroup BatchCheck::placed(std::size_t group) const {
  const std::size_t first = first_[group];
  return {centers_.data() + first, radii_.data() + first, first_[group + 1] - first};
}

// Returns whether the numbers suit the filter.
bool BatchCheck::place(std::span<const double> configurations, std::size_t count) {
  const std::size_t links = model_.link_names.size(), coordinates = model_.coordinates;
  for (std::size_t lane = 0; lane < count; ++lane)
    model_.place(configurations.subspan(lane * coordinates, coordinates),
                 std::span(poses_).subspan(lane * links, links));
  size_ = 0;
  const Vec3 origin = model_.base.translation;
  for (std::size_t g = 0; g < model_.groups.size(); ++g) {
    for (std::size_t lane = 0; lane < filter_block; ++lane) {
      // Lanes beyond the last configuration repeat it.
      const RigidTransform& at = poses_of(std::min(lane, count - 1))[model_.groups[g].link];
      const Vec3 position = at.translation - origin;
      size_ = std::max(size_, max_norm(position));
      for (std::size_t row = 0; row < 3; ++row) {
        for (int k = 0; k < 3; ++k)
          links_[g].entries[4 * row + static_cast<std::size_t>(k)][lane] = static_cast<float>(at.rows[row][k]);
        links_[g].entries[4 * row + 3][lane] = static_cast<float>(position[static_cast<int>(row)]);
      }
      if (!is_finite(position)) return false;
    }
  }
  size_ += extent_;
  if (!(size_ <= filter_largest)) return false;
  for (std::size_t g = 0; g < model_.groups.size(); ++g)
    kernels_.place(links_[g], spheres_.data() + first_[g], first_[g + 1] - first_[g], centers_.data() + first_[g]);
  return true;
}

LaneSets BatchCheck::near_obstacle(std::size_t group, std::size_t number) const {
  const FilterObstacle& listed = obstacles_[number];
  const double size = size_ + listed.size;
  if (!(size <= filter_largest)) return {.near = open_};
  const float allowance = filter_allowance(size, size + base_size_);
  switch (world_->obstacles[number]->kind) {
    case ObstacleKind::box:
      return kernels_.box(placed(group), listed.box, allowance, open_);
    case ObstacleKind::sphere:
      return kernels_.sphere(placed(group), listed.sphere, allowance, open_);
    default:
      return {.near = kernels_.bounds(placed(group), listed.lower, listed.upper, allowance, open_)};
  }
}

void BatchCheck::check_world(std::span<ConfigurationVerdict> verdicts) {
  const std::vector<MovingSpheres>& groups = model_.groups;
  for (std::size_t g = 0; g < groups.size() && open_ != 0;) {
    std::size_t end = g + 1;
    while (end < groups.size() && groups[end].link == groups[g].link) ++end;
    for (std::size_t i = 0; i < obstacles_.size() && open_ != 0; ++i) {
      for (std::size_t part = g; part < end; ++part) {
        if (groups[part].may_touch(i)) continue;
        const LaneSets sets = near_obstacle(part, i);
        unsigned contacts = sets.contacts;
        each_lane(sets.near & ~contacts, [&](std::size_t lane) {
          if (touches_obstacle(groups[part], poses_of(lane)[groups[part].link], *world_->obstacles[i]))
            contacts |= 1u << lane;
        });
        each_lane(contacts & open_, [&](std::size_t lane) {
          verdicts[lane] = {.link = static_cast<std::uint32_t>(groups[g].link),
                            .obstacle = static_cast<std::uint32_t>(i)};
        });
        open_ &= ~contacts;
      }
    }
    g = end;
  }
}

void BatchCheck::check_self(std::span<ConfigurationVerdict> verdicts) {
  const float allowance = filter_allowance(size_, size_ + base_size_);
  for (const GroupPair& pair : model_.pairs) {
    if (open_ == 0) return;
    const MovingSpheres &a = model_.groups[pair.a], &b = model_.groups[pair.b];
    const LaneSets sets = kernels_.groups(placed(pair.a), placed(pair.b), allowance, open_);
    unsigned contacts = sets.contacts;
    each_lane(sets.near & ~contacts, [&](std::size_t lane) {
      if (groups_touch(a, poses_of(lane)[a.link], b, poses_of(lane)[b.link])) contacts |= 1u << lane;
    });
    each_lane(contacts, [&](std::size_t lane) {
      verdicts[lane] = {.link = static_cast<std::uint32_t>(a.link), .other_link = static_cast<std::uint32_t>(b.link)};
    });
    open_ &= ~contacts;
  }
}

void BatchCheck::run(std::span<const double> configurations, std::span<ConfigurationVerdict> verdicts) {
  const std::size_t count = verdicts.size();
  if (count == 0) return;
  if (!place(configurations, count)) {
    for (std::size_t lane = 0; lane < count; ++lane)
      verdicts[lane] = model_.first_contact(poses_of(lane), world_, self_);
    return;
  }
  std::fill(verdicts.begin(), verdicts.end(), ConfigurationVerdict{});
  open_ = (1u << count) - 1;
  check_world(verdicts);
  if (self_) check_self(verdicts);
}

}  // namespace morula::robot
