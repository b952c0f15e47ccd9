# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""A tree is built once and follows a body that deforms; its cover is proven in every frame, its looseness measured."""

import numpy

import morula

mesh = morula.sample_body("limb")  # or morula.read_mesh("limb.obj"), or a trimesh.Trimesh
model = morula.build(mesh, quality="fast")
print(model)

body = morula.Body(mesh, model)
frames = morula.deform_frames(mesh, morula.Bend(90), morula.Twist(60), frame_count=13)  # stands for your solver
for number, positions in enumerate(frames):
    body.update(positions)  # your array as it is
    certificate = body.certify(positions)
    assert certificate, f"frame {number}: {certificate.worst_excess} outside node {certificate.worst_node}"
print(f"{len(frames)} frames, every level covers in each of them")

# The same in one call: (frames, nodes, 4), x y z radius.
spheres = body.follow(frames)
leaves = model.tree.level_set(model.level_count - 1)
middle = len(frames) // 2
for name, frame in (("rest", 0), ("bent", middle)):
    loose = morula.looseness(mesh, spheres[frame][leaves], frames[frame])
    print(f"{name}: the leaves' union is {1 + loose.looseness:.3f} times the body's volume")
assert numpy.array_equal(spheres[0], spheres[-1]), "back at rest, the spheres are those of rest"
