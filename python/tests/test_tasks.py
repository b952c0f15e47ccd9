# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The tasks of docs/reference/c.md: the three languages print the same, and what they print is right by oracles that share no
code with the library."""

import contextlib
import importlib.util
import io
import itertools
import os
import pathlib
import re
import shutil
import subprocess

import numpy
import pytest
from conftest import covers_by_sampling

import morula

sources = pathlib.Path(__file__).resolve().parents[2] / "examples" / "tasks"
programs = pathlib.Path(os.environ.get("MORULA_PROGRAMS", "nowhere"))
tasks = ["build", "update", "contacts", "distance", "self-contact", "scene"]
has_robots = hasattr(morula, "robot")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What the commands of the page write."""
    made = tmp_path_factory.mktemp("tasks")
    for name in "limb", "tool":
        mesh = morula.sample_body(name, 24)
        morula.write_mesh(made / f"{name}.obj", mesh)
        mesh = morula.read_mesh(made / f"{name}.obj")
        morula.write_tree(made / f"{name}.morula", morula.build(mesh))
    shutil.copy(sources / "arm.urdf", made)
    return made


def printed_by_python(name, folder):
    spec = importlib.util.spec_from_file_location(name, sources / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    printed = io.StringIO()
    with in_folder(folder), contextlib.redirect_stdout(printed):
        for task in [module.robot] if name == "robot" else [getattr(module, name.replace("-", "_")) for name in tasks]:
            task()
    return printed.getvalue()


@contextlib.contextmanager
def in_folder(folder):
    before = pathlib.Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def printed_by(program, folder):
    path = programs / program
    if not path.exists():
        pytest.skip(f"{program} is not built")
    return subprocess.run([path], cwd=folder, capture_output=True, text=True, timeout=600, check=True).stdout


@pytest.fixture(scope="module")
def text(folder):
    return printed_by_python("tasks", folder)


@pytest.fixture(scope="module")
def robot_text(folder):
    return printed_by_python("robot", folder)


@pytest.fixture(scope="module")
def printed(text):
    lines = text.splitlines()
    assert [line.partition(":")[0] for line in lines] == tasks
    return {line.partition(": ")[0]: line.partition(": ")[2] for line in lines}


@pytest.mark.parametrize("program", ["tasks_cpp", "tasks_c"])
def test_every_language_prints_the_same(program, folder, text):
    assert printed_by(program, folder) == text


@pytest.mark.skipif(not has_robots, reason="built without robots")
def test_the_robot_is_the_same_in_cpp(folder, robot_text):
    assert printed_by("tasks_robot", folder) == robot_text


@pytest.mark.parametrize("source", ["tasks.cpp", "tasks.c", "tasks.py", "robot.cpp", "robot.py"])
def test_a_task_has_at_most_15_lines(source):
    text = (sources / source).read_text(encoding="utf-8")
    parts = re.findall(r"(?ms)^(?://|#|/\*) \[(\w+)\](?: \*/)?\n(.*?)^(?://|#|/\*) \[end\]", text)
    assert {name for name, _ in parts} - {"helpers"} == ({"robot"} if "robot" in source else {t.replace("-", "_") for t in tasks})
    for name, code in parts:
        if name == "helpers":
            continue
        body = code.strip().splitlines()[1 : None if source.endswith(".py") else -1]
        assert 3 <= len(body) <= 15, f"{source}: {name}"


def mesh_and_spheres(folder, name, y=0.0):
    """Positions, facets and the spheres of the leaves of a body at rest, as the library moves them, placed."""
    mesh = morula.read_mesh(folder / f"{name}.obj")
    model = morula.read_covered_tree(folder / f"{name}.morula", mesh)
    body = morula.Body(mesh, model)
    leaves = numpy.flatnonzero(numpy.asarray(model.tree.child_count) == 0)
    shift = numpy.array([0, y, 0])
    spheres = numpy.asarray(body.copy_spheres())[leaves]
    return numpy.array(mesh.positions) + shift, numpy.array(mesh.facets), spheres + numpy.append(shift, 0)


def overlaps(a, b):
    """Depths of all pairs of spheres that overlap, each against each. The library leaves out a few of them: a leaf's sphere
    may stick out of its parent's, and what overlaps out there owns no surface there."""
    depth = a[:, None, 3] + b[None, :, 3] - numpy.linalg.norm(a[:, None, :3] - b[None, :, :3], axis=2)
    return depth[depth >= 0]


def test_built_spheres_are_as_many_as_printed_and_cover(folder, printed):
    mesh = morula.read_mesh(folder / "limb.obj")
    tree = morula.read_tree(folder / "built.morula").tree
    assert printed["build"] == f"{len(tree.spheres)} spheres on {len(tree.level_begin) - 1} levels"
    leaves = numpy.asarray(tree.spheres)[numpy.asarray(tree.child_count) == 0]
    assert covers_by_sampling(mesh, numpy.array(mesh.positions), leaves)


def test_the_root_of_the_stretched_limb_contains_it_closely(folder, printed):
    positions, _, _ = mesh_and_spheres(folder, "limb")
    positions[:, 0] *= 1.0625**10
    radius = float(re.fullmatch(r"root radius (\S+), covered", printed["update"])[1])
    low, high = positions.min(axis=0), positions.max(axis=0)
    about_the_middle = numpy.linalg.norm(positions - (low + high) / 2, axis=1).max()
    assert (high - low).max() / 2 <= radius <= 1.2 * about_the_middle


def test_contacts_are_those_of_brute_force(folder, printed):
    depth = overlaps(mesh_and_spheres(folder, "limb")[2], mesh_and_spheres(folder, "tool", 0.75)[2])
    count, deepest = re.fullmatch(r"(\d+), deepest (\S+)", printed["contacts"]).groups()
    assert 0.95 * len(depth) <= int(count) <= len(depth)
    assert float(deepest) == pytest.approx(depth.max(), rel=1e-6)


def test_pairs_of_the_scene_are_those_of_brute_force(folder, printed):
    row = [mesh_and_spheres(folder, "limb", 0.75 * i)[2] for i in range(5)]
    counts = [len(overlaps(a, b)) for a, b in itertools.combinations(row, 2)]
    pairs, contacts = re.fullmatch(r"(\d+) pairs of bodies, (\d+) contacts", printed["scene"]).groups()
    assert 0 < int(pairs) == sum(c > 0 for c in counts) < len(counts)
    assert 0.95 * sum(counts) <= int(contacts) <= sum(counts)


def test_the_distance_is_that_of_facets(folder, printed):
    (p, f, _), (q, g, _) = mesh_and_spheres(folder, "limb"), mesh_and_spheres(folder, "tool", 2)
    distance, facet_a, facet_b = re.fullmatch(r"(\S+), facets (\d+) and (\d+)", printed["distance"]).groups()

    def nearest(a, b):
        return min(numpy.linalg.norm(part[:, None] - b[None], axis=2).min() for part in numpy.array_split(a, 20))

    # Other points of the surfaces are no nearer, and points of a lattice on the two facets named hardly farther.
    def some_points(positions, facets):
        return numpy.concatenate([positions, positions[facets].mean(axis=1)])

    assert float(distance) <= nearest(some_points(p, f), some_points(q, g)) + 1e-9
    weights = numpy.array([(i, j, 12 - i - j) for i in range(13) for j in range(13 - i)]) / 12
    own = nearest(weights @ p[f[int(facet_a)]], weights @ q[g[int(facet_b)]])
    assert own <= 1.1 * float(distance)
    assert float(distance) <= own + 1e-9


def test_self_contacts_are_those_of_brute_force(folder, printed):
    p, f, _ = mesh_and_spheres(folder, "limb")
    p[p[:, 0] < 0, 0] *= -0.875
    corners = p[f]
    low, high = corners.min(axis=1), corners.max(axis=1)
    near = ((low[:, None] <= high[None]) & (low[None] <= high[:, None])).all(axis=2)
    a, b = numpy.nonzero(numpy.triu(near, 1))
    apart = ~(f[a][:, :, None] == f[b][:, None, :]).any(axis=(1, 2))
    a, b = a[apart], b[apart]

    def volume(o, u, v, w):
        return numpy.einsum("ni,ni->n", u - o, numpy.cross(v - o, w - o))

    def side_pierces(one, other):
        """Does a side of one facet cross the other, in general position?"""
        crosses = numpy.zeros(len(one), bool)
        x, y, z = other[:, 0], other[:, 1], other[:, 2]
        for k in range(3):
            s, t = one[:, k], one[:, (k + 1) % 3]
            around = numpy.stack([volume(s, t, x, y), volume(s, t, y, z), volume(s, t, z, x)])
            parted = volume(s, x, y, z) * volume(t, x, y, z) < 0
            crosses |= parted & ((around > 0).all(axis=0) | (around < 0).all(axis=0))
        return crosses

    crossing = side_pierces(corners[a], corners[b]) | side_pierces(corners[b], corners[a])
    assert int(printed["self-contact"].partition(" ")[0]) == crossing.sum() > 0


@pytest.mark.skipif(not has_robots, reason="built without robots")
def test_the_spheres_of_the_robot_cover_its_boxes(folder, robot_text):
    count, covered, meets = re.fullmatch(r"robot: (\d+) spheres, (\w+), (.*)\n", robot_text).groups()
    arm = morula.robot.read_robot(folder / "arm.urdf")
    spheres = morula.robot.fit_spheres(arm, spheres=8)
    assert int(count) == sum(len(link.spheres) for link in spheres.links) <= 8 * 3 and covered == "covered"
    generator = numpy.random.default_rng(1)
    boxes = {"base": ((0.3, 0.3, 0.1), 0.05), "upper": ((0.1, 0.1, 0.5), 0.25), "fore": ((0.08, 0.08, 0.4), 0.2)}
    for link in spheres.links:
        size, z = boxes[arm.links[link.link].name]
        points = generator.uniform(-0.5, 0.5, (2000, 3))
        points[numpy.arange(2000), generator.integers(0, 3, 2000)] = generator.choice([-0.5, 0.5], 2000)
        points = points * size + (0, 0, z)
        own = numpy.asarray(link.spheres)
        assert (numpy.linalg.norm(points[:, None] - own[None, :, :3], axis=2) <= own[:, 3]).any(axis=1).all()
    # The elbow is at (0, 0, 0.6); bent by 1.25 about y, then turned by 0.5 about z, the fore arm passes the ball.
    along = numpy.array([numpy.sin(1.25) * numpy.cos(0.5), numpy.sin(1.25) * numpy.sin(0.5), numpy.cos(1.25)])
    axis = numpy.array([0, 0, 0.6]) + numpy.linspace(0, 0.4, 100)[:, None] * along
    half_its_edge = 0.04
    assert numpy.linalg.norm(axis - (0.25, 0, 0.75), axis=1).min() - half_its_edge < 0.125
    assert meets == "meets the ball"
