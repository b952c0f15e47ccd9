# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Robots from URDF, MJCF and SDF: spheres for their links, and planners' queries; extras/robot/docs/planning.md.

>>> robot = morula.robot.read_robot("arm.urdf")                                             # doctest: +SKIP
>>> spheres = morula.robot.fit_spheres(robot, spheres=16)                                   # doctest: +SKIP
>>> ignored = morula.robot.find_ignored(robot, spheres)                                     # doctest: +SKIP
>>> query = morula.robot.ConfigurationQuery(robot, spheres, ignored)                        # doctest: +SKIP
>>> free = query.check(configurations, morula.robot.World()).free                           # doctest: +SKIP
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy

from . import _morula

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .pages import Page
    from .typing import FloatArray

from ._morula.robot import *  # noqa: E402, F403

__all__ = [name for name in dir(_morula.robot) if not name.startswith("_")] + ["float_spheres", "page"]


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


def float_spheres(spheres: FloatArray | _morula.robot.LinkSpheres) -> NDArray[numpy.float32]:
    """Spheres as (n, 4) float32, x y z radius, each of which contains the given one: for cuRobo's attachments, and PyTorch.

    spheres: (n, 4), x y z radius, or a LinkSpheres. Centers are rounded to the nearest float32, and a radius grows by the
    distance of its center and is rounded up, so that spheres that cover still do. ValueError for another shape, and for
    numbers that are not finite or beyond float32. Cost: n.
    """
    given = spheres.spheres if isinstance(spheres, _morula.robot.LinkSpheres) else spheres
    exact = numpy.asarray(given, dtype=numpy.float64)
    if exact.ndim != 2 or exact.shape[1] != 4:
        raise ValueError(f"spheres: shape {exact.shape}, but (n, 4) is needed: x, y, z, radius")
    with numpy.errstate(over="ignore"):
        rounded = exact.astype(numpy.float32)
    x, y, z = (exact[:, :3] - rounded[:, :3].astype(numpy.float64)).T
    moved = numpy.hypot(numpy.hypot(x, y), z)
    # A few units in the last place of a double are far below the step to the next float.
    radius = (exact[:, 3] + moved) * (1 + 4 * numpy.finfo(numpy.float64).eps)
    with numpy.errstate(over="ignore", invalid="ignore"):
        up = radius.astype(numpy.float32)
        rounded[:, 3] = numpy.where(up.astype(numpy.float64) < radius, numpy.nextafter(up, numpy.float32(numpy.inf)), up)
    if not numpy.isfinite(rounded).all():
        raise ValueError("spheres: numbers are not finite, or too large for float32")
    return rounded
