# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Robots from URDF, MJCF and SDF: spheres for their links, and collisions of these; extras/robot/docs/robots.md.

>>> robot = morula.robot.read_robot("arm.urdf")                                             # doctest: +SKIP
>>> spheres = morula.robot.fit_spheres(robot, spheres=16)                                   # doctest: +SKIP
>>> moving = morula.robot.SphereRobot(robot, spheres, morula.robot.find_ignored(robot, spheres))    # doctest: +SKIP
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import _morula

if TYPE_CHECKING:
    from .pages import Page

from ._morula.robot import *  # noqa: E402, F403


def page(robot: _morula.robot.Robot, spheres: _morula.robot.RobotSpheres, self_collision: _morula.robot.SelfCollision | None = None) -> Page:
    """The page of a robot, whose joints the reader can move; it names links whose spheres overlap, except ignored pairs.

    RuntimeError, with the remedy, if the package was built without the page.
    """
    if not hasattr(_morula.robot, "page_html"):
        raise RuntimeError("no page: this package was built without the extra `page`")
    if not _morula.has_page():
        raise RuntimeError(f"no page: {_morula.why_no_page()}")
    from .pages import Page

    return Page(_morula.robot.page_html(robot, spheres, self_collision))
