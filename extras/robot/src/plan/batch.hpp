// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// First contacts of many configurations: sixteen at a time in single precision, and doubtful cases in double.
#pragma once

#include "plan/filter.hpp"
#include "plan/model.hpp"

namespace morula::robot {

/// The memory of one thread for batches of a model's configurations against a world, which must outlive it.
class BatchCheck {
 public:
  /// world: null for the robot alone. self: whether pairs of links count.
  BatchCheck(const ConfigurationQuery::Model& model, const World::Data* world, bool self);
  /// Writes the first contacts of verdicts.size() configurations, at most filter_block: those of Model::first_contact.
  void run(std::span<const double> configurations, std::span<ConfigurationVerdict> verdicts);

 private:
  struct FilterObstacle {
    FilterBox box{};
    Spheref sphere{};
    float lower[3]{}, upper[3]{};
    double size = 0;  // its part of X
  };
  void list_obstacle(const Obstacle& obstacle);
  bool place(std::span<const double> configurations, std::size_t count);
  void check_world(std::span<ConfigurationVerdict> verdicts);
  void check_self(std::span<ConfigurationVerdict> verdicts);
  LaneSets near_obstacle(std::size_t group, std::size_t obstacle) const;
  std::span<const RigidTransform> poses_of(std::size_t lane) const;
  PlacedGroup placed(std::size_t group) const;

  const ConfigurationQuery::Model& model_;
  const World::Data* world_;
  bool self_;
  const FilterKernels& kernels_;
  std::vector<FilterObstacle> obstacles_;
  std::vector<std::size_t> first_;  // place of a group's first sphere, the one around it
  std::vector<Spheref> spheres_;
  std::vector<float> radii_;
  double extent_ = 0, base_size_ = 0;
  std::vector<RigidTransform> poses_;  // lane by lane
  std::vector<PlacedLink> links_;      // group by group
  std::vector<PlacedCenter> centers_;
  double size_ = 0;    // X of the robot
  unsigned open_ = 0;  // configurations without a contact so far
};

}  // namespace morula::robot
