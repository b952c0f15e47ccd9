// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The task "robot" of docs/reference/c.md in C++; robot.py does the same and prints the same numbers. Run it in a
// folder with arm.urdf.
#include <cstdio>
#include <morula/robot/sphere_robot.hpp>

namespace {

// [robot]
void robot() {
  const morula::robot::Robot arm = morula::robot::read_robot("arm.urdf");
  const morula::robot::RobotSpheres spheres = morula::robot::fit_spheres(arm, {.spheres = 8});
  const morula::robot::SelfCollision ignored = morula::robot::find_ignored(arm, spheres, {.samples = 2000});
  morula::robot::SphereRobot moving(arm, spheres, ignored);
  moving.set_joint_values(std::vector<double>{0.5, 1.25});
  const bool meets = moving.collides(morula::Sphere{{0.25, 0, 0.75}, 0.125});
  std::printf("robot: %zu spheres, %s, %s\n", moving.sphere_count(), spheres.covered() ? "covered" : "not covered",
              meets ? "meets the ball" : "free");
}
// [end]

}  // namespace

int main() {
  robot();
}
