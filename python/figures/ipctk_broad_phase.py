# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Morula's broad phase for the IPC Toolkit beside the toolkit's own: python python/figures/ipctk_broad_phase.py"""

import statistics
import time

import ipctk
import numpy

import morula


def milliseconds(phase, mesh, frames, radius):
    times = []
    candidates = None
    for start, end in zip(frames, frames[1:]):
        candidates = ipctk.Candidates()
        begin = time.perf_counter()
        candidates.build(mesh, start, end, radius, phase)
        times.append(1000 * (time.perf_counter() - begin))
    return statistics.median(times), len(candidates)


for resolution in (24, 48, 96):
    limb = morula.sample_body("limb", resolution)
    faces = limb.faces.astype(numpy.int32)
    edges = ipctk.edges(faces)
    mesh = ipctk.CollisionMesh(limb.vertices, edges, faces)
    frames = [numpy.asfortranarray(f) for f in morula.deform_frames(limb, morula.Bend(120), frame_count=13)]
    for phase in (morula.ipctk.BroadPhase(), ipctk.LBVH(), ipctk.HashGrid(), ipctk.SpatialHash()):
        for radius in (0.002,):
            median, count = milliseconds(phase, mesh, frames, radius)
            print(f"{limb.facet_count} facets, radius {radius}: {type(phase).__name__:>11} {median:8.2f} ms, {count} candidates")
