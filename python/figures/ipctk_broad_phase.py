# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Morula's broad phase for the IPC Toolkit beside the toolkit's own: python python/figures/ipctk_broad_phase.py

Milliseconds, medians over a motion: of the clock, and in brackets of all processors. The first two columns are the broad phase
alone; the others also what the toolkit does with the candidates.
"""

import statistics
import time

import ipctk
import numpy

import morula


def milliseconds(action, frames):
    walls, processors = [], []
    for i, (start, end) in enumerate(zip(frames, frames[1:])):
        wall, processor = time.perf_counter(), time.process_time()
        action(start, end)
        if i > 0:
            walls.append(1000 * (time.perf_counter() - wall))
            processors.append(1000 * (time.process_time() - processor))
    return f"{statistics.median(walls):7.2f} ({statistics.median(processors):6.2f})"


def report(name, phase, mesh, frames, radius):
    candidates = ipctk.Candidates()

    def still(start, end):
        candidates.build(mesh, start, radius, phase)

    def step(start, end):
        candidates.build(mesh, start, end, radius, phase)

    def collisions(start, end):
        ipctk.NormalCollisions().build(mesh, start, 2 * radius, broad_phase=phase)

    def free_step(start, end):
        step(start, end)
        candidates.compute_collision_free_stepsize(mesh, start, end)

    columns = [milliseconds(action, frames) for action in (still, step, collisions, free_step)]
    step(*frames[-2:])
    print(f"  {name:>20} | still {columns[0]} | step {columns[1]} | collisions {columns[2]} | free step {columns[3]} | {len(candidates)} candidates")


for resolution in (24, 48, 96):
    limb = morula.sample_body("limb", resolution)
    faces = limb.faces.astype(numpy.int32)
    edges = ipctk.edges(faces)
    mesh = ipctk.CollisionMesh(limb.vertices, edges, faces)
    frames = [numpy.asfortranarray(f) for f in morula.deform_frames(limb, morula.Bend(120), frame_count=25, and_back=False)]
    for radius in (0.002, 0.01):
        print(f"{limb.facet_count} facets, radius {radius}")
        phases = {
            "Morula": morula.ipctk.BroadPhase(), "Morula, boxes": morula.ipctk.BroadPhase(boxes=True), "LBVH (default)": ipctk.LBVH(),
            "HashGrid": ipctk.HashGrid(), "SpatialHash": ipctk.SpatialHash(),
        }
        for name, phase in phases.items():
            report(name, phase, mesh, frames, radius)
