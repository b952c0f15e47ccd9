# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""A skinned body folds onto itself: which of its features come near each other, and how far a step may go."""

import numpy

import morula

mesh = morula.sample_body("limb", 32)
skin = morula.sample_skin(mesh.positions)
bones = morula.sample_bones(mesh.positions, 9)
surface = morula.SurfaceTree(mesh)

before = numpy.array(mesh.positions)
for transforms in bones[: len(bones) // 2 + 1]:
    positions = morula.move_by_skin(skin, mesh.positions, transforms)
    surface.update(before, positions)
    impacts = morula.swept(surface, rings=2)
    surface.update(positions)
    near = morula.proximity(surface, distance=0.05, rings=2, rest_distance=0.1)
    step = impacts.time.min() if len(impacts) else 1.0
    print(f"{len(near)} pairs within 0.05 that were not so at rest; {step:.2f} of the step is free of impacts")
    before = positions
