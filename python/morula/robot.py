# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Robots: URDF, MJCF and SDF in, spheres of their links out, and what these meet; docs/robots.md.

>>> robot = morula.robot.read_robot("arm.urdf")                                             # doctest: +SKIP
>>> spheres = morula.robot.fit_spheres(robot, spheres=16)                                   # doctest: +SKIP
>>> moving = morula.robot.SphereRobot(robot, spheres, morula.robot.find_ignored(robot, spheres))    # doctest: +SKIP
"""

from __future__ import annotations

from . import _morula

if not hasattr(_morula, "robot"):
    raise ImportError("morula.robot: this package was built without robots: it needs tinyxml2 (docs/python.md)")

from ._morula.robot import *  # noqa: E402, F403
