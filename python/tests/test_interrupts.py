# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C ends long calls, and what it was asked of can be asked again.

How soon a call answers is told by a timer of processor time: its handler runs where the call looks at signals. So a
busy machine changes nothing. Each call takes longer than the limit without, so that one which does not look fails.
"""

import itertools
import os
import signal
import subprocess
import sys
import time

import numpy
import pytest

import morula

#: Seconds of processor time, of each thread that works: a call looks at signals at least that often. It is twice what
#: calls take with the caches to themselves.
LIMIT = 0.4
#: Calls that look later: while millions of points are read, a surface is sorted, a front is freed.
LATER = {"SignedDistance": 1.0, "closest points": 1.0, "rays": 1.0, "SurfaceTree": 1.2, "ContactQuery.run": 0.8,
         "Body.follow": 0.8}
#: Seconds from the signal to the end of the program, however busy the machine is.
PATIENCE = 30.0
#: By name: what is made, the call, and what is asked of the same objects afterwards.
CALLS = {
    "build": ("mesh = morula.sample_body('limb', 300)", "morula.build(mesh, quality='best')", "morula.build(small).validate(small) == []"),
    "build with workers": (
        "mesh, workers = morula.sample_body('limb', 300), morula.Workers(2)", "morula.build(mesh, quality='best', workers=workers)",
        "morula.build(small, workers=workers) == morula.build(small)"),
    "SignedDistance": (
        "distance = morula.SignedDistance(morula.sample_body('limb', 100), 'winding_number'); points = numpy.random.default_rng(1).random((8000000, 3))", "distance(points)",
        "distance(points[:5]).shape == (5,)"),
    "SignedDistance with workers": (
        "distance = morula.SignedDistance(morula.sample_body('limb', 100), 'winding_number'); workers = morula.Workers(2); "
        "points = numpy.random.default_rng(1).random((8000000, 3))", "distance(points, workers=workers)",
        "(distance(points[:5], workers=workers) == distance(points[:5])).all()"),
    "SignedDistance.is_inside": (
        "distance = morula.SignedDistance(morula.sample_body('limb', 100), 'winding_number'); points = numpy.random.default_rng(1).random((8000000, 3))",
        "distance.is_inside(points)", "distance.is_inside(points[:5]).shape == (5,)"),
    "winding numbers": (
        "tree = morula.TriangleBvh(morula.sample_body('limb', 200)); points = numpy.random.default_rng(1).random((8000000, 3))",
        "tree.winding_numbers(points)", "tree.winding_numbers(points[:5]).shape == (5,)"),
    "closest points": (
        "tree = morula.TriangleBvh(morula.sample_body('limb', 200)); points = numpy.random.default_rng(1).random((8000000, 3))",
        "tree.closest_points(points)", "len(tree.closest_points(points[:5])) == 5"),
    "ProximityQuery.run": (
        "mesh = morula.sample_body('limb', 150); surface = morula.SurfaceTree(mesh); "
        "query = morula.ProximityQuery(distance=0.05)",
        "query.run(surface)", "query.run(morula.SurfaceTree(small)) and len(query.pairs()) == 0"),
    "ObstacleQuery.run": (
        "surface = morula.SurfaceTree(morula.sample_body('limb', 200)); query = morula.ObstacleQuery(margin=1); "
        "field = morula.DistanceField(lambda p: (time.sleep(0.001), 0.5)[1])",
        "query.run(surface, field)", "query.run(surface, (9, 9, 9, 0.1)).finished"),
    "rays": (
        "body = morula.Collider(morula.Body(small, morula.build(small, method='octree'))); "
        "rays = numpy.random.default_rng(1).random((8000000, 3)) - 0.5",
        "morula.first_hits(body, rays, rays)", "len(morula.first_hits(body, rays[:5], rays[:5])) == 5"),
    "fullest balls": (
        "balls = numpy.random.default_rng(1).random((60000, 4))", "morula.fullest_balls(balls, 30000)",
        "len(morula.fullest_balls(balls[:10], 3)) == 3"),
    "union_mass": ("balls = morula.build(small, method='octree').spheres", "morula.union_mass(balls, resolution=20000)",
                   "morula.union_mass(balls, resolution=8).volume > 0"),
    "fit_clump": ("mesh = morula.sample_body('limb', 200)", "morula.fit_clump(mesh, spheres=3000, quality='best')",
                  "len(morula.fit_clump(small, spheres=2, quality='draft').spheres) > 0"),
    "Scene.update": (
        "built = morula.build(small, method='octree'); scene = morula.Scene(margin=3.0); "
        "[scene.add(morula.Collider(morula.Body(small, built))) for _ in range(400)]",
        "[scene.update() for _ in range(1000)]", "scene.set_options(margin=0.0) or len(scene) == 400"),
    "proximity with a filter": (
        "surface = morula.SurfaceTree(morula.sample_body('limb', 60))",
        "morula.proximity(surface, distance=0.2, keeps=lambda kind, a, b: a % 2 == 0)",
        "len(morula.proximity(morula.SurfaceTree(small), distance=0.01, rings=3)) == 0"),
    "proximity": (
        "surface = morula.SurfaceTree(morula.sample_body('limb', 100))", "morula.proximity(surface, distance=0.06)",
        "len(morula.proximity(morula.SurfaceTree(small), distance=0.01, rings=3)) == 0"),
    "a table of excluded pairs": (
        "mesh = morula.sample_body('limb', 110)",
        "morula.surface_crossings(morula.SurfaceTree(mesh), rest_distance=0.3)",
        "len(morula.surface_crossings(morula.SurfaceTree(small), rest_distance=0.001)) == 0"),
    "SweptQuery.run": (
        "mesh = morula.sample_body('limb', 130); surface = morula.SurfaceTree(mesh); query = morula.SweptQuery(); "
        "surface.update(mesh.positions, numpy.asarray(mesh.positions) * (-1, 1, 1))",
        "query.run(surface)", "query.run(morula.SurfaceTree(small)) and len(query.pairs()) == 0"),
    "SurfaceTree": ("mesh = morula.sample_body('limb', 500)", "morula.SurfaceTree(mesh)", "morula.SurfaceTree(small)"),
    "collide": (
        "mesh = morula.sample_body('limb', 128); built = morula.build(mesh, method='octree', depth=4); "
        "a, b = (morula.Collider(morula.Body(mesh, built)) for _ in range(2))",
        "[morula.collide(a, b, margin=2.5) for _ in range(2)]", "len(morula.collide(a, b, level=0).node_a) == 1"),
    "ContactQuery.run": (
        "mesh = morula.sample_body('limb', 128); built = morula.build(mesh, method='octree', depth=4); "
        "query = morula.ContactQuery(margin=2.5); "
        "query.add(*(morula.Collider(morula.Body(mesh, built)) for _ in range(2)))",
        "[query.run() for _ in range(2)]", "len(query.run().finished) > 0"),
    "PenetrationQuery.run": (
        "mesh = morula.sample_body('limb', 64); body = morula.Body(mesh, morula.build(mesh, method='octree')); "
        "query = morula.PenetrationQuery(morula.Collider(body), morula.Collider(body))",
        "query.run(tolerance=1e-5, budget=100000)", "query.run(budget=100).upper > 0"),
    "InsideQuery.inside": (
        "mesh = morula.sample_body('limb', 64); points = numpy.random.default_rng(1).random((500000, 3)); "
        "query = morula.InsideQuery(morula.Collider(morula.Body(mesh, morula.build(mesh, method='octree'))))",
        "query.inside(points)", "query.inside(points[:5]).shape == (5,)"),
    "Body.follow": (
        "mesh = morula.sample_body('limb', 150); body = morula.Body(mesh, morula.build(mesh, method='octree')); "
        "rest = numpy.asarray(mesh.positions); frames = numpy.broadcast_to(rest, (6000, *rest.shape))",
        "body.follow(frames)", "len(body.follow(frames[:2])) == 2"),
    "deform_frames": (
        "mesh = morula.sample_body('limb', 200)", "morula.deform_frames(mesh, morula.Bend(90), frame_count=200)",
        "morula.deform_frames(small, morula.Bend(90), frame_count=3).shape[0] == 3"),
    "sample_body": ("", "morula.sample_body('limb', 3000)", "morula.sample_body('limb', 16) == small"),
    "ConvexHull": (
        "points = numpy.random.default_rng(1).normal(size=(6000, 3)); points /= numpy.linalg.norm(points, axis=1)[:, None]",
        "morula.ConvexHull(points)", "len(morula.ConvexHull(points[:50]).vertices) == 50"),
    "ModalCertificate": (
        "mesh = morula.sample_body('limb', 40); modes = morula.sample_modes(mesh.positions)",
        "morula.ModalCertificate(mesh, modes, largest_norm=3.0)",
        "morula.ModalCertificate(small, morula.sample_modes(small.positions), largest_norm=1e-3).free_norm > 0"),
    "with_known_poses": (
        "mesh = morula.sample_body('limb', 24); built = morula.build(mesh, method='octree', depth=2); "
        "poses = [(str(i), numpy.asarray(mesh.positions) * (1, 1 + i, 1)) for i in range(1, 4)]",
        "morula.with_known_poses(mesh, built, poses, looser_by=1.01)",
        "morula.with_known_poses(mesh, built, [])[0] == built"),
    "measure": (
        "mesh = morula.sample_body('limb', 200); built = morula.build(mesh, method='octree', depth=4)",
        "[morula.measure(mesh, built.tree) for _ in range(4)]", "len(morula.measure(mesh, built.tree)) == 5"),
    "inner balls": (
        "mesh = morula.sample_body('limb', 100); distance = morula.SignedDistance(mesh)",
        "morula.inner_ball_candidates(mesh, distance, candidates=40000)",
        "len(morula.inner_ball_candidates(mesh, distance, candidates=10)) > 0"),
}
#: Calls of several threads, whose processor time adds up.
THREADS = {name: 2 for name in CALLS if name.endswith("with workers")}


class Clock:
    """Calls a function at every few milliseconds of processor time, wherever Python looks at signals."""

    def __init__(self, look):
        self.look = look

    def __enter__(self):
        self.before = signal.signal(signal.SIGVTALRM, lambda *_: self.look(time.process_time()))
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.004, 0.004)

    def __exit__(self, *_):
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, self.before)


def end_the_call():
    """Once: the handler may run where the clock is being stopped."""
    signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    raise KeyboardInterrupt


@pytest.mark.parametrize("name", CALLS)
def test_a_call_looks_at_signals_often_and_can_be_ended(name):
    made, call, again = CALLS[name]
    names = {"morula": morula, "numpy": numpy, "time": time, "small": morula.sample_body("limb", 16)}
    exec(made, names)
    looks = []

    def look(now):
        looks.append(now)
        # Long calls are ended: what they look like goes on.
        if now - looks[0] > 1.5:
            end_the_call()

    began = time.process_time()
    looks.append(began)
    ended = False
    try:
        with Clock(look):
            exec(call, names)
    except KeyboardInterrupt:
        ended = True
    looks.append(time.process_time())
    took = looks[-1] - began
    worst = max(after - before for before, after in itertools.pairwise(looks)) / THREADS.get(name, 1)
    print(f"{name}: {took:.2f} s, looks at signals every {worst:.3f} s at least")
    assert took > LIMIT, "the call is too short for this test"
    assert worst < LATER.get(name, LIMIT)
    if not ended:

        def end(now):
            if now - begins > took / 3:
                end_the_call()

        begins = time.process_time()
        with pytest.raises(KeyboardInterrupt), Clock(end):
            exec(call, names)
    assert eval(again, names)


# What a body reads later are the positions of the frame that it ended in, whatever has become of the others.
def test_follow_keeps_the_positions_that_the_body_ends_in():
    mesh = morula.sample_body("limb", 100)
    built = morula.build(mesh, method="octree")
    body, other = morula.Body(mesh, built), morula.Body(mesh, built)
    frames = numpy.repeat(numpy.asarray(mesh.positions)[None], 200, axis=0) * numpy.linspace(1, 3, 200)[:, None, None]
    begins = time.process_time()

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


#: One of each kind: with the handler that Python has, and with threads.
PROGRAMS = ("build", "SignedDistance with workers", "proximity with a filter")
PROGRAM = """
import sys, time, numpy, morula
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
    made, call, again = CALLS[name]
    program = subprocess.Popen(
        [sys.executable, "-c", PROGRAM.format(made=made, call=call, again=again)], cwd=tmp_path, env=os.environ,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )
    try:
        assert program.stdout.readline() == "begins\n", program.stderr.read()
        time.sleep(1.0)
        assert program.poll() is None, "the call is too short for this test"
        begin = time.monotonic()
        program.send_signal(signal.SIGINT)
        out, err = program.communicate(timeout=PATIENCE)
        print(f"{name}: {time.monotonic() - begin:.2f} s")
        assert (out, program.returncode) == ("usable\n", 0), err
    finally:
        program.kill()
        program.communicate()
