# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The bodies and trees that several pictures show, each made once."""
from __future__ import annotations

import functools

import morula
import numpy as np

TITLES: dict[str, str] = {}  # file -> alternative text, from docs/pictures/pictures.tsv
PICTURES = {}  # name -> function that returns a draw.Picture, or None when it has written its files itself


def picture(name):
    def keep(function):
        PICTURES[name] = function
        return function
    return keep


@functools.cache
def limb(resolution=24):
    return morula.sample_body("limb", resolution)


@functools.cache
def model(name="limb", resolution=24, **options):
    options = {"branching": 8, "depth": 3} | options
    return morula.build(morula.sample_body(name, resolution), **options)


@functools.cache
def bent(resolution=24, degrees=90.0):
    return morula.deform(limb(resolution), morula.Bend(degrees))


def turned(degrees, axis, translation=(0.0, 0.0, 0.0)):
    return morula.RigidTransform.from_axis(axis, np.radians(degrees), translation)


def moved(transform, points):
    matrix = transform.matrix
    return np.asarray(points, float) @ matrix[:3, :3].T + matrix[:3, 3]


def moved_spheres(transform, spheres):
    return np.column_stack([moved(transform, spheres[:, :3]), spheres[:, 3]])
