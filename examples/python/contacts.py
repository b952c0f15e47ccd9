# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The overlap of two bodies under a budget in every frame, and the force of its volume on one of them."""

import morula

stiffness = 1000.0
limb, tool = morula.sample_body("limb", 24), morula.sample_body("tool", 24)
limb_body = morula.Body(limb, morula.build(limb, quality="fast"))
tool_body = morula.Body(tool, morula.build(tool, quality="fast"))
a, b = morula.Collider(limb_body), morula.Collider(tool_body)  # once

# [contact_loop]
query = morula.ContactPatchQuery(a, b)  # once: it keeps its memory
force = [0.0, 0.0, 0.0]  # on the tool
for frame, positions in enumerate(morula.deform_frames(limb, morula.Bend(60), frame_count=7)):
    limb_body.update(positions)
    b.set_transform(morula.RigidTransform.from_axis((1, 0, 0), 0.1 * frame, translation=(0.0, 0.85 - 0.02 * frame, 0.0)))
    patches = query.run(max_points=0, depths=False, budget="500us")
    if patches.is_finished or len(patches.contacts) == 0:  # otherwise that of the last frame stays
        # The energy is stiffness / 2 * volume**2.
        force = -stiffness * patches.total_volume * patches.area_vector_b.sum(axis=0)
    state = "" if patches.is_finished else "; the budget ended the run"
    print(f"frame {frame}: {len(patches)} patches, volume {patches.total_volume:.5f}, force {force}{state}")
# [end]

# The area vectors are the derivative of the volume: that of a translation along y, by a difference.
exact = query.run().area_vector_b.sum(axis=0)[1]
small = 1e-6
volumes = []
for y in (0.73 - small, 0.73 + small):
    b.set_transform(morula.RigidTransform.from_axis((1, 0, 0), 0.6, translation=(0.0, y, 0.0)))
    volumes.append(query.run().total_volume)
measured = (volumes[1] - volumes[0]) / (2 * small)
print(f"derivative of the volume {exact:.6f}, measured {measured:.6f}")
assert exact < 0 and abs(measured - exact) < 1e-3 * abs(exact)
