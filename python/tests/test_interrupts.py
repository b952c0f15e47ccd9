# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C ends long calls, and what it was asked of can be asked again.

A timer of user time tells how long a call goes on without a look at signals: its handler runs where the call looks.
No machine is too slow or too busy for these tests: the longest stretch without a look is compared with the whole call.
"""

import functools
import itertools
import os
import resource
import signal
import subprocess
import sys
import time

import numpy
import pytest

import morula

#: The longest stretch without a look at signals takes at most this share of a call's user time. Polls stand at fixed
#: counts of work, so that a phase without polls has about the same share of its call on every machine.
SHARE = 0.2
#: Seconds of user time without a look that are never too many: calls look every 20 ms, and timers tick every 4 to 10.
FLOOR = 0.06
#: A stretch counts when it is there each time: the system may give one thread's time late.
TRIES = 3
#: Seconds from the signal to the end of the program, however busy the machine is.
PATIENCE = 30.0


@functools.cache
def limb(resolution):
    return morula.sample_body("limb", resolution)


@functools.cache
def rows(count, columns=3):
    return numpy.random.default_rng(1).random((count, columns))


#: By name: what is made, the call, and what is asked of the same objects afterwards.
CALLS = {
    "build": ("mesh = limb(64)", "morula.build(mesh, quality='best', depth=2)", "morula.build(small).validate(small) == []"),
    "build with workers": (
        "mesh, workers = limb(64), morula.Workers(2)", "morula.build(mesh, quality='best', depth=2, workers=workers)",
        "morula.build(small, workers=workers) == morula.build(small)"),
    "SignedDistance": (
        "distance = morula.SignedDistance(limb(100), 'winding_number'); points = rows(250000)", "distance(points)",
        "distance(points[:5]).shape == (5,)"),
    "SignedDistance with workers": (
        "distance = morula.SignedDistance(limb(100), 'winding_number'); workers = morula.Workers(2); "
        "points = rows(250000)", "distance(points, workers=workers)",
        "(distance(points[:5], workers=workers) == distance(points[:5])).all()"),
    "SignedDistance.is_inside": (
        "distance = morula.SignedDistance(limb(100), 'winding_number'); points = rows(250000)",
        "distance.is_inside(points)", "distance.is_inside(points[:5]).shape == (5,)"),
    "winding numbers": (
        "tree = morula.TriangleBvh(limb(200)); points = rows(2000000)",
        "tree.winding_numbers(points)", "tree.winding_numbers(points[:5]).shape == (5,)"),
    "closest points": (
        "tree = morula.TriangleBvh(limb(200)); points = rows(250000)",
        "tree.closest_points(points)", "len(tree.closest_points(points[:5])) == 5"),
    "ProximityQuery.run": (
        "mesh = limb(100); surface = morula.SurfaceTree(mesh); "
        "query = morula.ProximityQuery(distance=0.05)",
        "query.run(surface)", "query.run(morula.SurfaceTree(small)) and len(query.pairs()) == 0"),
    "ObstacleQuery.run": (
        "surface = morula.SurfaceTree(limb(110)); query = morula.ObstacleQuery(margin=1); "
        "field = morula.DistanceField(lambda p: 0.5)",
        "query.run(surface, field)", "query.run(surface, (9, 9, 9, 0.1)).finished"),
    "rays": (
        "body = morula.Collider(morula.Body(small, morula.build(small, method='octree'))); "
        "rays = rows(250000) - 0.5",
        "morula.first_hits(body, rays, rays)", "len(morula.first_hits(body, rays[:5], rays[:5])) == 5"),
    "fullest balls": (
        "balls = rows(20000, 4)", "morula.fullest_balls(balls, 10000)",
        "len(morula.fullest_balls(balls[:10], 3)) == 3"),
    "union_mass": ("balls = morula.build(small, method='octree').spheres", "morula.union_mass(balls, resolution=5000)",
                   "morula.union_mass(balls, resolution=8).volume > 0"),
    "fit_clump": ("mesh = limb(50)", "morula.fit_clump(mesh, spheres=20, quality='best')",
                  "len(morula.fit_clump(small, spheres=2, quality='draft').spheres) > 0"),
    "Scene.update": (
        "built = morula.build(small, method='octree'); "
        "colliders = [morula.Collider(morula.Body(small, built)) for _ in range(100)]",
        "scene = morula.Scene(margin=3.0); [scene.add(collider) for collider in colliders]; scene.update()",
        "scene.set_options(margin=0.0) or len(scene) == 100"),
    "proximity with a filter": (
        "surface = morula.SurfaceTree(limb(56))",
        "morula.proximity(surface, distance=0.2, accepts=lambda kind, a, b: a % 2 == 0)",
        "len(morula.proximity(morula.SurfaceTree(small), distance=0.01, rings=3)) == 0"),
    "proximity": (
        "surface = morula.SurfaceTree(limb(95))", "morula.proximity(surface, distance=0.06)",
        "len(morula.proximity(morula.SurfaceTree(small), distance=0.01, rings=3)) == 0"),
    "a table of excluded pairs": (
        "mesh = limb(90)",
        "morula.surface_crossings(morula.SurfaceTree(mesh), rest_distance=0.3)",
        "len(morula.surface_crossings(morula.SurfaceTree(small), rest_distance=0.001)) == 0"),
    "SweptQuery.run": (
        "mesh = limb(95); surface = morula.SurfaceTree(mesh); query = morula.SweptQuery(); "
        "surface.update(mesh.positions, numpy.asarray(mesh.positions) * (-1, 1, 1))",
        "query.run(surface)", "query.run(morula.SurfaceTree(small)) and len(query.pairs()) == 0"),
    "SurfaceTree": ("mesh = limb(450)", "morula.SurfaceTree(mesh)", "morula.SurfaceTree(small)"),
    "collide": (
        "mesh = limb(128); built = morula.build(mesh, method='octree', depth=4); "
        "a, b = (morula.Collider(morula.Body(mesh, built)) for _ in range(2))",
        "morula.collide(a, b, margin=2.5)", "len(morula.collide(a, b, level=0).node_a) == 1"),
    "ContactQuery.run": (
        "mesh = limb(128); built = morula.build(mesh, method='octree', depth=4); "
        "query = morula.ContactQuery(margin=2.5); "
        "query.add(*(morula.Collider(morula.Body(mesh, built)) for _ in range(2)))",
        "query.run()", "len(query.run().finished) > 0"),
    "PenetrationQuery.run": (
        "mesh = limb(64); body = morula.Body(mesh, morula.build(mesh, method='octree')); "
        "query = morula.PenetrationQuery(morula.Collider(body), morula.Collider(body))",
        "query.run(tolerance=1e-5, budget=30000)", "query.run(budget=100).upper > 0"),
    "InsideQuery.inside": (
        "mesh = limb(64); points = rows(250000); "
        "query = morula.InsideQuery(morula.Collider(morula.Body(mesh, morula.build(mesh, method='octree'))))",
        "query.inside(points)", "query.inside(points[:5]).shape == (5,)"),
    "Body.follow": (
        "mesh = limb(150); body = morula.Body(mesh, morula.build(mesh, method='octree')); "
        "rest = numpy.asarray(mesh.positions); frames = numpy.broadcast_to(rest, (5000, *rest.shape))",
        "body.follow(frames)", "len(body.follow(frames[:2])) == 2"),
    "deform_frames": (
        "mesh = limb(200)", "morula.deform_frames(mesh, morula.Bend(90), frame_count=80)",
        "morula.deform_frames(small, morula.Bend(90), frame_count=3).shape[0] == 3"),
    "sample_body": ("", "morula.sample_body('limb', 1800)", "morula.sample_body('limb', 16) == small"),
    "ConvexHull": (
        "points = numpy.random.default_rng(1).normal(size=(5000, 3)); points /= numpy.linalg.norm(points, axis=1)[:, None]",
        "morula.ConvexHull(points)", "len(morula.ConvexHull(points[:50]).vertices) == 50"),
    "ModalCertificate": (
        "mesh = limb(24); modes = morula.sample_modes(mesh.positions)",
        "morula.ModalCertificate(mesh, modes, largest_norm=3.0)",
        "morula.ModalCertificate(small, morula.sample_modes(small.positions), largest_norm=1e-3).free_norm > 0"),
    "with_known_poses": (
        "mesh = limb(16); built = morula.build(mesh, method='octree', depth=2); "
        "poses = [(str(i), numpy.asarray(mesh.positions) * (1, 1 + i, 1)) for i in range(1, 2)]",
        "morula.with_known_poses(mesh, built, poses, pose_threshold=1.01)",
        "morula.with_known_poses(mesh, built, [])[0] == built"),
    "measure": (
        "mesh = limb(100); built = morula.build(mesh, method='octree', depth=4)",
        "[morula.measure(mesh, built.tree) for _ in range(4)]", "len(morula.measure(mesh, built.tree)) == 5"),
    "inner balls": (
        "mesh = limb(100); distance = morula.SignedDistance(mesh)",
        "morula.inner_ball_candidates(mesh, distance, candidates=16000)",
        "len(morula.inner_ball_candidates(mesh, distance, candidates=10)) > 0"),
    "Mesh": (
        "positions, facets = (numpy.array(part) for part in (limb(1800).positions, limb(1800).facets))",
        "morula.Mesh(positions, facets)", "morula.Mesh(small.positions, small.facets) == small"),
    "repair": ("mesh = limb(500)", "morula.repair(mesh)", "morula.repair(small)[0] == small"),
    "inspect": ("mesh = limb(700)", "morula.inspect(mesh)", "morula.inspect(small).closed"),
    "write_tree": (
        "tree = morula.tree_from_spheres(rows(400000, 4) + 0.1); path = folder / 'a.json'",
        "morula.write_tree(path, tree)", "[file.name for file in folder.iterdir()] == ['a.json']"),
    "read_tree": (
        "tree = morula.tree_from_spheres(rows(400000, 4) + 0.1); path = folder / 'a.json'; morula.write_tree(path, tree)",
        "morula.read_tree(path)", "len(morula.read_tree(path).tree.spheres) > 400000"),
    "write_motion": (
        "mesh = limb(200); path = folder / 'a.npy'; "
        "frames = numpy.broadcast_to(mesh.positions, (1000, *mesh.positions.shape))",
        "morula.write_motion(path, mesh, frames)", "list(folder.iterdir()) in ([], [path])"),
    "write_motion of meshes": (
        "mesh = limb(100); path = folder / 'frames'; "
        "frames = numpy.broadcast_to(mesh.positions, (50, *mesh.positions.shape))",
        "morula.write_motion(path, mesh, frames)",
        "morula.write_motion(path, mesh, frames) or len(morula.read_motion(path, mesh)) == 50"),
    "read_motion": (
        "mesh = limb(100); path = folder / 'frames'; "
        "morula.write_motion(path, mesh, numpy.broadcast_to(mesh.positions, (50, *mesh.positions.shape)))",
        "morula.read_motion(path, mesh)", "len(morula.read_motion(path, mesh)) == 50"),
}
for extension in (".obj", ".off", ".ply", ".stl", ".vtp"):
    CALLS[f"read_mesh of {extension}"] = (
        f"path = folder / 'a{extension}'; morula.write_mesh(path, limb(700))", "morula.read_mesh(path)",
        "morula.write_mesh(path, small) or morula.read_mesh(path).facet_count == small.facet_count")
for extension in (".obj", ".off", ".ply", ".stl", ".vtp"):
    CALLS[f"write_mesh of {extension}"] = (
        f"mesh, path = limb(900), folder / 'a{extension}'", "morula.write_mesh(path, mesh)",
        f"[file.name for file in folder.iterdir()] == ['a{extension}']")


def user_seconds():
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime


class Clock:
    """Calls a function at every few milliseconds of user time, wherever Python looks at signals."""

    def __init__(self, look):
        self.look = look

    def __enter__(self):
        self.before = signal.signal(signal.SIGVTALRM, lambda *_: self.look(user_seconds()))
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.004, 0.004)

    def __exit__(self, *_):
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, self.before)


def end_the_call():
    """Once: the handler may run where the clock is being stopped."""
    signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    raise KeyboardInterrupt


def scope(folder):
    """The names that calls use."""
    return {"morula": morula, "numpy": numpy, "limb": limb, "rows": rows, "small": limb(16), "folder": folder}


def time_of(call, names):
    """The user seconds of a call, and of its longest stretch without a look at signals."""
    looks = [user_seconds()]
    with Clock(looks.append):
        exec(call, names)
    looks.append(user_seconds())
    return looks[-1] - looks[0], max(after - before for before, after in itertools.pairwise(looks))


if not hasattr(morula, "fit_clump"):  # built without clumps
    del CALLS["fit_clump"]


@pytest.mark.parametrize("name", CALLS)
def test_a_call_looks_at_signals_often_and_can_be_ended(name, tmp_path):
    made, call, again = CALLS[name]
    names = scope(tmp_path)
    exec(made, names)
    for _ in range(TRIES):
        took, worst = time_of(call, names)
        print(f"{name}: {took:.2f} s, at most {worst:.3f} s ({worst / took:.0%}) without a look at signals")
        if worst <= max(SHARE * took, FLOOR):
            break
    else:
        pytest.fail(f"{name}: {worst:.3f} of {took:.2f} s pass without a look at signals")

    def end(now):
        if now - begins > took / 4:
            end_the_call()

    begins = user_seconds()
    with pytest.raises(KeyboardInterrupt), Clock(end):
        exec(call, names)
    assert eval(again, names)


# What a body reads later are the positions of the frame that it ended in, whatever has become of the others.
def test_follow_keeps_the_positions_that_the_body_ends_in():
    mesh = limb(100)
    model = morula.build(mesh, method="octree")
    body, other = morula.Body(mesh, model), morula.Body(mesh, model)
    frames = numpy.repeat(numpy.asarray(mesh.positions)[None], 200, axis=0) * numpy.linspace(1, 3, 200)[:, None, None]
    begins = user_seconds()

    def end(now):
        if now - begins > 0.05:
            end_the_call()

    with pytest.raises(KeyboardInterrupt), Clock(end):
        for _ in range(1000):
            body.follow(frames)
    # Root spheres grow from frame to frame.
    sizes = []
    for frame in frames:
        other.update(frame)
        sizes.append(numpy.array(other.spheres[0]))
    [reached] = [i for i, sphere in enumerate(sizes) if (sphere == numpy.asarray(body.spheres[0])).all()]
    kept = frames[reached].copy()
    del frames, frame
    other.update(kept)
    point = (0.3, 0.2, 0.1, 0.05)
    found, expected = (morula.InsideQuery(morula.Collider(b)).probe(point) for b in (body, other))
    assert found.distance == expected.distance


#: A call with Python's own handler of signals, and one with threads: what is made first, and the call, which would go on
#: much longer than the half second after which it is ended.
PROGRAMS = {
    "build": ("mesh = morula.sample_body('limb', 300)", "morula.build(mesh, quality='best')"),
    "SignedDistance with workers": (
        "distance = morula.SignedDistance(morula.sample_body('limb', 100), 'winding_number'); workers = morula.Workers(2); "
        "points = numpy.random.default_rng(1).random((16000000, 3))", "distance(points, workers=workers)"),
    "proximity with a filter": (
        "surface = morula.SurfaceTree(morula.sample_body('limb', 200))",
        "morula.proximity(surface, distance=0.2, accepts=lambda kind, a, b: a % 2 == 0)"),
}
PROGRAM = """
import sys, numpy, morula
small = morula.sample_body('limb', 16)
{made}
print('begins', flush=True)
try:
    {call}
    print('ended by itself')
    sys.exit(3)
except KeyboardInterrupt:
    pass
assert {again}
print('usable')
"""


@pytest.mark.parametrize("name", PROGRAMS)
def test_interrupt_ends_a_call(name, tmp_path):
    (made, call), again = PROGRAMS[name], CALLS[name][2]
    program = subprocess.Popen(
        [sys.executable, "-c", PROGRAM.format(made=made, call=call, again=again)], cwd=tmp_path, env=os.environ,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )
    try:
        assert program.stdout.readline() == "begins\n", program.stderr.read()
        time.sleep(0.5)
        begin = time.monotonic()
        program.send_signal(signal.SIGINT)
        out, err = program.communicate(timeout=PATIENCE)
        print(f"{name}: {time.monotonic() - begin:.2f} s")
        assert (out, program.returncode) == ("usable\n", 0), err
    finally:
        program.kill()
        program.communicate()
