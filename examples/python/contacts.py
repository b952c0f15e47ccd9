# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Two bodies collide under a budget: what is found within it is sound, and the next frame goes on from there."""

import numpy

import morula

limb, tool = morula.sample_body("limb"), morula.sample_body("tool", 24)
limb_body = morula.Body(limb, morula.build(limb, quality="fast"))
tool_body = morula.Body(tool, morula.build(tool, quality="fast"))
a, b = morula.Collider(limb_body), morula.Collider(tool_body)  # once

# [contact_loop]
query = morula.ContactQuery(budget="300us", surfaces=True)
query.add(a, b)
for frame, positions in enumerate(morula.deform_frames(limb, morula.Bend(60), frame_count=7)):
    limb_body.update(positions)
    b.set_transform(morula.RigidTransform.from_axis((1, 0, 0), 0.1 * frame, translation=(0.0, 0.8 - 0.05 * frame, 0.0)))
    contacts = query.carry() if frame > 0 else query.start()
    # Arrays, one row per contact: a response sums over them.
    push = (contacts.normal * numpy.maximum(contacts.depth, 0)[:, None]).sum(axis=0)
    state = "all of them" if contacts.is_finished else "as far as the budget reaches"
    print(f"frame {frame}: {len(contacts)} contacts, {state}; push {numpy.round(push, 3).tolist()}")
# [end]

exact = morula.collide(a, b, find_crossings=True)
print(f"{len(exact.crossings)} pairs of facets really cross")
