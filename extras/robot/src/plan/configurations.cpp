// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/robot/configurations.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "plan/batch.hpp"

namespace morula::robot {

using detail::StandardFloats;

namespace {

constexpr std::size_t chunk_of_configurations = 16 * filter_block;

void check_all(const ConfigurationQuery::Model& model, const World::Data* world, std::span<const double> configurations,
               std::span<ConfigurationVerdict> verdicts, Workers& workers) {
  parallel_for(workers, verdicts.size(), chunk_of_configurations, [&](std::size_t begin, std::size_t end) {
    const StandardFloats standard;
    BatchCheck batch(model, world, true);
    for (std::size_t i = begin; i < end; i += filter_block) {
      detail::check_interrupt();
      const std::size_t count = std::min(filter_block, end - i);
      batch.run(configurations.subspan(i * model.coordinates, count * model.coordinates), verdicts.subspan(i, count));
    }
  });
}

std::vector<std::size_t> ascending(std::span<const std::size_t> numbers) {
  std::vector<std::size_t> sorted(numbers.begin(), numbers.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

}  // namespace

ConfigurationQuery::ConfigurationQuery(const Robot& robot, const RobotSpheres& spheres,
                                       const SelfCollision& self_collision) {
  const StandardFloats standard;
  model_ = std::make_shared<const Model>(robot, spheres, self_collision);
}

ConfigurationQuery::~ConfigurationQuery() = default;
ConfigurationQuery::ConfigurationQuery(const ConfigurationQuery&) = default;
ConfigurationQuery& ConfigurationQuery::operator=(const ConfigurationQuery&) = default;
// A query that was moved from is still that query.
ConfigurationQuery::ConfigurationQuery(ConfigurationQuery&& other) noexcept : model_(other.model_) {}
ConfigurationQuery& ConfigurationQuery::operator=(ConfigurationQuery&& other) noexcept {
  model_ = other.model_;
  return *this;
}

std::size_t ConfigurationQuery::coordinates() const {
  return model_->coordinates;
}

void ConfigurationQuery::set_base(const RigidTransform& base) {
  const StandardFloats standard;
  const RigidTransform rigid = exact_pose(base, "ConfigurationQuery::set_base");
  if (!(max_norm(rigid.translation) <= greatest_usable_scale))
    throw std::invalid_argument("ConfigurationQuery::set_base: the position is beyond greatest_usable_scale");
  auto changed = std::make_shared<Model>(*model_);
  changed->base = rigid;
  model_ = changed;
}

void ConfigurationQuery::allow_contacts(std::string_view link, std::span<const std::size_t> obstacles) {
  const StandardFloats standard;
  const std::size_t index = model_->link_index(link, "allow_contacts");
  auto changed = std::make_shared<Model>(*model_);
  for (MovingSpheres& group : changed->own) {
    if (group.link == index) group.allowed = ascending(obstacles);
  }
  changed->arrange();
  model_ = changed;
}

void ConfigurationQuery::attach(std::string_view link, std::span<const Sphere> spheres,
                                std::span<const std::string> touching,
                                std::span<const std::size_t> touching_obstacles) {
  const StandardFloats standard;
  MovingSpheres group{.link = model_->link_index(link, "attach"), .is_held = true};
  for (const std::string& name : touching) group.touching.push_back(model_->link_index(name, "attach"));
  group.allowed = ascending(touching_obstacles);
  auto changed = std::make_shared<Model>(*model_);
  std::erase_if(changed->held, [&](const MovingSpheres& other) { return other.link == group.link; });
  if (!spheres.empty()) {
    group.bound = tree_from_spheres(spheres).spheres[0];
    group.spheres.assign(spheres.begin(), spheres.end());
    changed->held.push_back(std::move(group));
  }
  changed->arrange();
  model_ = changed;
}

void ConfigurationQuery::check(std::span<const double> configurations, const World& world,
                               std::span<ConfigurationVerdict> verdicts, WorkersOrAll workers) const {
  model_->require_configurations(configurations, verdicts.size(), "check");
  check_all(*model_, &world.data(), configurations, verdicts, workers);
}

void ConfigurationQuery::check_self(std::span<const double> configurations, std::span<ConfigurationVerdict> verdicts,
                                    WorkersOrAll workers) const {
  model_->require_configurations(configurations, verdicts.size(), "check_self");
  check_all(*model_, nullptr, configurations, verdicts, workers);
}

}  // namespace morula::robot
