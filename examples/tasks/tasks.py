# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The tasks of docs/reference/c.md in Python; tasks.cpp and tasks.c do the same and print the same numbers. Run it in a folder
with limb.obj, tool.obj and their trees, limb.morula and tool.morula."""

import numpy

import morula


# [build]
def build():
    mesh = morula.read_mesh("limb.obj")  # or trimesh.load("limb.obj")
    model = morula.build(mesh)
    morula.write_tree("built.morula", model)
    print(f"build: {model.tree.node_count} spheres on {model.tree.level_count} levels")
# [end]


# [update]
def update():
    mesh = morula.read_mesh("limb.obj")
    body = morula.Body(mesh, morula.read_covered_tree("limb.morula", mesh))
    positions = numpy.array(mesh.positions)
    for _ in range(10):
        positions[:, 0] *= 1.0625
        body.update(positions)
    covered = body.certify(positions).covered
    print(f"update: root radius {body.spheres[0, 3]:.9g}, {'covered' if covered else 'not covered'}")
# [end]


# [contacts]
def contacts():
    limb, tool = morula.read_mesh("limb.obj"), morula.read_mesh("tool.obj")
    a = morula.Collider(morula.Body(limb, morula.read_covered_tree("limb.morula", limb)))
    b = morula.Collider(morula.Body(tool, morula.read_covered_tree("tool.morula", tool)))
    b.set_transform((0, 0.75, 0))
    found = morula.collide(a, b)  # budget="200us" ends it early
    print(f"contacts: {len(found)}, deepest {found.depth.max():.9g}")
# [end]


# [distance]
def distance():
    limb, tool = morula.read_mesh("limb.obj"), morula.read_mesh("tool.obj")
    a = morula.Collider(morula.Body(limb, morula.read_covered_tree("limb.morula", limb)))
    b = morula.Collider(morula.Body(tool, morula.read_covered_tree("tool.morula", tool)))
    b.set_transform((0, 2, 0))
    bounds = morula.distance(a, b)
    print(f"distance: {bounds.upper:.9g}, facets {bounds.a.facet} and {bounds.b.facet}")
# [end]


# [self_contact]
def self_contact():
    mesh = morula.read_mesh("limb.obj")
    folded = numpy.array(mesh.positions)
    folded[folded[:, 0] < 0, 0] *= -0.875
    surface = morula.SurfaceTree(mesh)
    surface.update(folded)
    pairs = morula.surface_crossings(surface)
    print(f"self-contact: {len(pairs)} pairs of facets")
# [end]


# [scene]
def scene():
    mesh = morula.read_mesh("limb.obj")
    body = morula.Body(mesh, morula.read_covered_tree("limb.morula", mesh))
    scene = morula.Scene()
    for i in range(5):
        collider = morula.Collider(body)
        collider.set_transform((0, 0.75 * i, 0))
        scene.add(collider)
    scene.update()
    pairs = scene.pairs()
    print(f"scene: {len(pairs)} pairs of bodies, {sum(len(pair.contacts) for pair in pairs)} contacts")
# [end]


if __name__ == "__main__":
    for task in build, update, contacts, distance, self_contact, scene:
        task()
