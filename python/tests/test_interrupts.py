# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C ends long calls, and what it was asked of can be asked again.

Each call runs in a program of its own, which gets SIGINT in the middle of it. All of them take longer than the limit
without, so that a call which does not look at signals fails.
"""

import os
import signal
import subprocess
import sys
import time

import pytest

import morula

#: Seconds: from the signal to the exception. Calls answer within 0.2 s of a processor that is theirs alone.
LIMIT = 8.0
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
        "query = morula.ProximityQuery(distance=0.1)",
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
}
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


@pytest.mark.parametrize("name", CALLS)
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
        out, err = program.communicate(timeout=LIMIT)
        print(f"{name}: {time.monotonic() - begin:.2f} s")
        assert (out, program.returncode) == ("usable\n", 0), err
    finally:
        program.kill()
        program.communicate()
