// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// How far rounding moves the spheres of a robot: bounds for one configuration, from bounds of single operations.
#pragma once

#include <span>
#include <vector>

#include "plan/model.hpp"

namespace morula::robot {

/// Bounds for the poses that Model::place() computes. The exact pose of a link is the product of the matrices that the
/// robot gives, with exact sines and cosines of the exact joint values.
class PoseRounding {
 public:
  explicit PoseRounding(const ConfigurationQuery::Model& model);

  struct Error {
    double turned = 0, moved = 0;  // of the matrix, as a spectral norm; of the translation
  };
  /// Largest distance between the computed and the exact center of a sphere, over all groups, mesh units. values,
  /// poses: a configuration and what place() made of it. errors: one per link, for intermediate results.
  double largest(std::span<const double> values, std::span<const RigidTransform> poses, std::span<Error> errors) const;

 private:
  const ConfigurationQuery::Model& model_;
  std::vector<double> length_of_origin_, length_of_axis_, stretch_of_origin_;  // of steps
  std::vector<double> stretch_;   // of links: bound of the matrix's spectral norm, 1 or more
  std::vector<double> farthest_;  // of groups: greatest distance of a center from the link
};

}  // namespace morula::robot
