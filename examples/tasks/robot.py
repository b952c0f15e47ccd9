# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The task "robot" of docs/reference/c.md in Python; robot.cpp does the same and prints the same numbers. Run it in a folder
with arm.urdf."""

import numpy

import morula


# [robot]
def robot():
    arm = morula.robot.read_robot("arm.urdf")
    spheres = morula.robot.fit_spheres(arm, spheres=8)
    ignored = morula.robot.find_ignored(arm, spheres, samples=2000)
    moving = morula.robot.SphereRobot(arm, spheres, ignored)
    moving.set_joint_values(numpy.array([0.5, 1.25]))
    meets = moving.collides((0.25, 0, 0.75, 0.125))
    covered = "covered" if spheres.covered else "not covered"
    print(f"robot: {moving.sphere_count} spheres, {covered}, {'meets the ball' if meets else 'free'}")
# [end]


if __name__ == "__main__":
    robot()
