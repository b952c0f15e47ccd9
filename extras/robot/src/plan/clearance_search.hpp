// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The nearest pair of one configuration, by branch and bound over groups of spheres and obstacles.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "plan/clearance_rounding.hpp"

namespace morula::robot {

/// What all configurations of a call share.
class ClearancePlan {
 public:
  ClearancePlan(const ConfigurationQuery::Model& model, const World::Data& world, const ClearanceOptions& options);

  struct GroupSphere {
    Sphere sphere{};
    double reach = 0;  // greatest distance of its points from the center of the group's bound
  };
  const ConfigurationQuery::Model& model;
  const World::Data& world;
  const ClearanceOptions options;
  const PoseRounding rounding;
  std::vector<std::vector<GroupSphere>> groups{};  // by descending reach
  std::vector<Vec3> axes{};                        // of steps: unit vectors, or 0
};

/// Finds the clearance of configurations, one after the other; reuses its memory. For one thread.
class ClearanceSearch {
 public:
  explicit ClearanceSearch(const ClearancePlan& plan);
  Clearance operator()(std::span<const double> values);
  /// The derivatives of the last clearance by the coordinates; 0 if it has no pair. gradient: one number per
  /// coordinate.
  void gradient(std::span<double> gradient) const;

 private:
  struct Candidate {
    double bound = 0;   // no sphere of the pair is nearer, up to twice `error`
    double center = 0;  // signed distance of the bound's center from the obstacle; known for simple shapes
    double error = 0;
    std::uint32_t first = 0, second = 0;  // group and obstacle, or two groups
    bool is_world = false;
  };
  struct Best {
    double distance = 0;
    std::size_t candidate = none, sphere = none, other_sphere = none;
  };
  void place(std::span<const double> values);
  const std::vector<Sphere>& placed(std::size_t group);
  void list_world();
  void list_obstacle(std::size_t group, std::size_t number);
  void list_self();
  bool is_excluded(const Candidate& candidate) const;
  void visit(std::size_t index);
  void visit_obstacle(std::size_t index);
  void visit_group(std::size_t index);
  void add_motion(std::span<double> gradient, std::size_t link, std::size_t end, const Vec3& p,
                  const Vec3& direction) const;

  const ClearancePlan& plan_;
  std::vector<RigidTransform> poses_;
  std::vector<PoseRounding::Error> errors_;
  std::vector<Sphere> bounds_;                // of groups, in the world
  std::vector<std::vector<Sphere>> spheres_;  // of groups, in the world; see is_placed_
  std::vector<char> is_placed_;
  std::vector<Candidate> candidates_;
  std::vector<double> obstacle_errors_;
  double moved_ = 0, reach_ = 0, lower_ = 0;
  Best best_{};
};

}  // namespace morula::robot
