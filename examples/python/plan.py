# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""RRT-Connect for an arm of seven joints among obstacles, with certified edges; the path is then tested on the meshes."""

import pathlib

import numpy

import morula
from morula import robot as robots

urdf = pathlib.Path(__file__).parents[1] / "plan" / "arm.urdf"
# [query]
arm = robots.read_robot(urdf)
spheres = robots.fit_spheres(arm, spheres=16)
ignored = robots.find_ignored(arm, spheres)
query = robots.ConfigurationQuery(arm, spheres, ignored)
# [end]
boxes = [((0.45, 0, 0.25), (0.25, 0.02, 0.25)), ((0.45, 0, 0.95), (0.25, 0.02, 0.1))]  # center and half lengths
world = robots.World()
for center, half in boxes:
    world.add(robots.ObstacleBox(half, pose=morula.RigidTransform(translation=center)))


def plan(start, goal, lower, upper, step=0.5, rounds=10_000, seed=1):
    """Two trees grow toward each other. (J. J. Kuffner, S. M. LaValle: RRT-Connect, ICRA 2000.)"""
    random = numpy.random.default_rng(seed)
    workers = morula.Workers(1)

    def extend(tree, target):
        """Adds a node one step from the nearest node toward the target, if the edge is free."""
        nodes, parents = tree
        away = numpy.linalg.norm(numpy.array(nodes) - target, axis=1)
        nearest = int(away.argmin())
        node = target if away[nearest] <= step else nodes[nearest] + step / away[nearest] * (target - nodes[nearest])
        edge = query.check_motions(nodes[nearest][None], node[None], world, workers=workers)
        if edge.result[0] != robots.MotionResult.free:
            return False
        nodes.append(node)
        parents.append(nearest)
        return True

    def branch(tree):
        """From the last node to the root."""
        nodes, parents = tree
        path, at = [nodes[-1]], len(nodes) - 1
        while at != 0:
            at = parents[at]
            path.append(nodes[at])
        return path

    first, second = a, b = ([start], [0]), ([goal], [0])
    for _ in range(rounds):
        if extend(a, random.uniform(lower, upper)):
            target = a[0][-1]
            while extend(b, target):
                if b[0][-1] is target:
                    return numpy.array(branch(first)[::-1] + branch(second)[1:])
        a, b = b, a
    return None


limits = numpy.array([(arm.joints[j].lower, arm.joints[j].upper) for j in arm.independent_joints])
start, goal = numpy.array([-0.7, 1, 0, 0.9, 0, 0.5, 0]), numpy.array([0.7, 1, 0, 0.9, 0, 0.5, 0])
path = plan(start, goal, *limits.T)
assert path is not None and (path[0] == start).all() and (path[-1] == goal).all()


# The facets of the links and of the boxes, at places along the path: no sphere of the robot takes part.
def collider(mesh):
    return morula.Collider(morula.Body(mesh, morula.build(mesh, spheres=1)))


links = {link.link: collider(link.surface.mesh) for link in spheres.links if len(link.surface.mesh.facets)}
walls = []
for center, half in boxes:
    signs = numpy.array([[k & 1, k >> 1 & 1, k >> 2] for k in range(8)]) * 2 - 1
    facets = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]]
    walls.append(collider(morula.Mesh(center + signs * half, numpy.array(facets))))


def crosses(values):
    poses = robots.link_poses(arm, values)
    for link, body in links.items():
        body.set_transform(poses[link])
    return any(len(morula.crossings(body, wall)) for body in links.values() for wall in walls)


def places(path, fine=0.02):
    for p, q in zip(path, path[1:]):
        yield from numpy.linspace(p, q, int(abs(q - p).max() / fine) + 2)


contacts = sum(map(crosses, places(path)))
straight = sum(map(crosses, places([start, goal])))
print(f"{spheres.sphere_count} spheres; a path of {len(path)} configurations; meshes cross in {contacts} places of it, on the straight line in {straight}")
assert contacts == 0 and straight > 0
