// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The distance of the surfaces of two links with all joints at rest.
#pragma once

#include <memory>
#include <morula/robot/fit.hpp>
#include <span>

namespace morula::robot {

class RestSurfaces {
 public:
  /// Prepares the links of `used`, as places in spheres.links. poses: one per link of the robot. Borrows nothing.
  RestSurfaces(const Robot& robot, const RobotSpheres& spheres, std::span<const RigidTransform> poses,
               std::span<const std::size_t> used, Workers& workers);
  ~RestSurfaces();
  RestSurfaces(const RestSurfaces&) = delete;
  RestSurfaces& operator=(const RestSurfaces&) = delete;

  /// The distance of the surfaces of two of these links, mesh units; 0 where they cross, touch, or come as near as a
  /// millionth of the larger link's size, which files in single precision do not distinguish from touching. Balls count
  /// as solid. If one of the links has cylinders, capsules or ellipsoids, 0 means that polyhedra inside of them touch,
  /// so that the true shapes also touch. The spheres of a link replace an unknown surface. Safe to call from several
  /// threads at a time.
  double distance(std::size_t a, std::size_t b) const;

 private:
  struct Placed;
  std::vector<std::unique_ptr<Placed>> around_, inside_;  // one per link of the fit; inside_: with round shapes alone
};

}  // namespace morula::robot
