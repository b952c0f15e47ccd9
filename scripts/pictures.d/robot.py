# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of a robot: its links, and the spheres that cover them."""
from __future__ import annotations

import pathlib

import morula
import numpy as np
from bodies import moved, moved_spheres, picture
from draw import Picture, View, balls, solids

URDF = pathlib.Path(__file__).resolve().parents[2] / "extras/robot/tests/robots/arm_description/urdf/arm.urdf"
VALUES = {"turn": 0.4, "lift": 0.3, "bend": 0.8, "reach": 0.05, "roll": 0.6}
KINDS = ("surface", "sphere", "other", "sphere_b", "proof", "contact")


@picture("robot.svg")
def robot():
    import morula.robot

    arm = morula.robot.read_robot(URDF)
    fit = morula.robot.fit_spheres(arm, max_total=90)
    assert fit.covered
    values = np.array(morula.robot.rest_values(arm))
    for k, joint in enumerate(arm.independent_joints):
        values[k] = VALUES.get(arm.joints[joint].name, values[k])
    poses = morula.robot.link_poses(arm, values)
    bodies, round_ones, rows, kinds = [], [], [], []
    for k, link in enumerate(fit.links):
        pose, kind = poses[link.link], KINDS[k % len(KINDS)]
        mesh = link.surface.mesh
        if mesh.facet_count:
            bodies.append((moved(pose, mesh.positions), mesh.facets, kind))
        round_ones += [(sphere, kind) for sphere in moved_spheres(pose, link.surface.spheres)] if len(link.surface.spheres) else []
        rows.append(moved_spheres(pose, link.spheres))
        kinds += [kind] * len(link.spheres)
    rows = np.concatenate(rows)
    page = Picture(400)
    every = np.concatenate([positions for positions, _, _ in bodies])
    for k, words in enumerate(("links", f"{len(rows)} spheres around them")):
        view = View(360 * k, 0, 360, 350, every, right=(0.62, 0.78, 0), up=(-0.27, 0.21, 0.94), margin=24)
        if k == 0:
            solids(page, view, *bodies)
            for sphere, kind in round_ones:
                balls(page, view, sphere, kind, style="o")
        else:
            balls(page, view, rows, kinds, style="o")
        page.text(360 * k + 180, 382, words, size=22)
    return page
