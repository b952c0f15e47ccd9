# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C ends every long call, and what it was asked of can be asked again.

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
    "with_known_poses": (
        "mesh = morula.sample_body('limb', 300); built = morula.build(mesh, method='octree')",
        "morula.with_known_poses(mesh, built, [('p', mesh.positions * [1, 2, 1])] * 20, quality='best', looser_by=1.0)",
        "built.validate(mesh) == []"),
    "Body.follow": (
        "body = morula.Body(small, morula.build(small, method='octree', depth=1)); "
        "frames = numpy.broadcast_to(small.positions, (30000000, *small.positions.shape))",
        "body.follow(frames)", "bool(body.update(small.positions)) or True"),
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
    "PenetrationQuery": (
        "mesh = morula.sample_body('limb', 60); body = morula.Body(mesh, morula.build(mesh, method='octree')); "
        "other = morula.Collider(morula.Body(mesh, morula.build(mesh, method='octree'))); other.place((0.05, 0.02, 0.01)); "
        "query = morula.PenetrationQuery(body, other)",
        "query.run(tolerance=1e-12, budget=None)", "query.run(budget=100).lower >= 0"),
    "ProximityQuery.run": (
        "mesh = morula.sample_body('limb', 150); surface = morula.SurfaceTree(mesh); "
        "query = morula.ProximityQuery(distance=0.5, rest_distance=9.0)",
        "query.run(surface)", "query.run(morula.SurfaceTree(small)) and len(query.pairs()) == 0"),
    "proximity with a filter": (
        "surface = morula.SurfaceTree(morula.sample_body('limb', 150))",
        "morula.proximity(surface, distance=0.5, keeps=lambda kind, a, b: False)", "len(morula.proximity(surface, distance=1e-9)) == 0"),
    "SweptQuery.run": (
        "mesh = morula.sample_body('limb', 150); surface = morula.SurfaceTree(mesh); "
        "surface.update(mesh.positions, mesh.positions[::-1].copy()); query = morula.SweptQuery(rest_distance=9.0)",
        "query.run(surface)", "surface.update(mesh.positions, mesh.positions) is None and len(query.pairs()) == 0"),
    "ObstacleQuery.run": (
        "surface = morula.SurfaceTree(morula.sample_body('limb', 200)); query = morula.ObstacleQuery(margin=1); "
        "field = morula.DistanceField(lambda p: (time.sleep(0.001), 0.5)[1])",
        "query.run(surface, field)", "query.run(surface, (9, 9, 9, 0.1)).finished"),
    "collide": (
        "mesh = morula.sample_body('limb', 200); built = morula.build(mesh, method='octree', depth=6); "
        "a, b = (morula.Collider(morula.Body(mesh, built)) for _ in range(2))",
        "morula.collide(a, b, margin=0.6)", "morula.overlap(a, b)"),
    "ContactQuery.run": (
        "mesh = morula.sample_body('limb', 200); built = morula.build(mesh, method='octree', depth=6); "
        "a, b = (morula.Collider(morula.Body(mesh, built)) for _ in range(2)); query = morula.ContactQuery(margin=0.6); query.add(a, b)",
        "query.run()", "query.set_budget(10) or len(query.run()) >= 0"),
    "rays": (
        "body = morula.Collider(morula.Body(small, morula.build(small, method='octree'))); "
        "rays = numpy.random.default_rng(1).random((8000000, 3)) - 0.5",
        "morula.first_hits(body, rays, rays)", "len(morula.first_hits(body, rays[:5], rays[:5])) == 5"),
    "InsideQuery.inside": (
        "query = morula.InsideQuery(morula.Body(small, morula.build(small, method='octree'))); "
        "points = numpy.random.default_rng(1).random((8000000, 3))",
        "query.inside(points)", "query.inside(points[:5]).shape == (5,)"),
    "measure": (
        "mesh = morula.sample_body('limb', 100); tree = morula.build(mesh, method='octree')",
        "morula.measure(mesh, tree, resolution=6000)", "len(morula.measure(small, morula.build(small, method='octree'))) > 1"),
    "protrusion": (
        "mesh = morula.sample_body('limb', 100); tree = morula.build(mesh, method='octree', depth=6); "
        "distance = morula.SignedDistance(mesh); spheres = tree.spheres",
        "morula.protrusion(distance, spheres, tolerance=1e-9)", "morula.protrusion(distance, spheres[:1]).worst > 0"),
    "inner balls": (
        "distance = morula.SignedDistance(small)", "morula.inner_ball_candidates(small, distance, candidates=30000000)",
        "len(morula.inner_ball_candidates(small, distance, candidates=100)) > 0"),
    "fullest balls": (
        "balls = numpy.random.default_rng(1).random((60000, 4))", "morula.fullest_balls(balls, 30000)",
        "len(morula.fullest_balls(balls[:10], 3)) == 3"),
    "union_mass": ("balls = morula.build(small, method='octree').spheres", "morula.union_mass(balls, resolution=20000)",
                   "morula.union_mass(balls, resolution=8).volume > 0"),
    "fit_clump": ("mesh = morula.sample_body('limb', 200)", "morula.fit_clump(mesh, spheres=3000, quality='best')",
                  "len(morula.fit_clump(small, spheres=2, quality='draft').spheres) > 0"),
    "ConvexHull": (
        "points = numpy.random.default_rng(1).normal(size=(60000, 3)); points /= numpy.linalg.norm(points, axis=1)[:, None]",
        "morula.ConvexHull(points)", "len(morula.ConvexHull(points[:9]).vertices) == 9"),
    "Scene.update": (
        "built = morula.build(small, method='octree'); scene = morula.Scene(margin=3.0); "
        "[scene.add(morula.Collider(morula.Body(small, built))) for _ in range(400)]",
        "[scene.update() for _ in range(1000)]", "scene.set_options(margin=0.0) or len(scene) == 400"),
    "ModalCertificate": (
        "mesh = morula.sample_body('limb', 150); modes = morula.sample_modes(mesh.positions)",
        "morula.ModalCertificate(mesh, modes, largest_norm=100.0, margin=0.3)",
        "morula.ModalCertificate(small, morula.sample_modes(small.positions)).free_norm >= 0"),
    "deform_frames": (
        "mesh = morula.sample_body('limb', 100)", "morula.deform_frames(mesh, morula.Noise(), frame_count=3000000)",
        "morula.deform_frames(mesh, morula.Noise(), frame_count=2).shape[0] == 2"),
    "sample_body": ("", "[morula.sample_body('limb', 2000) for _ in range(1000)]", "morula.sample_body('limb', 8).facet_count > 0"),
    "study": ("", "morula.study({'limb': morula.sample_body('limb', 150)})", "True"),
    "robot.fit_spheres": (
        "open('link.urdf', 'w').write(\"<robot name='r'><link name='l'><collision><geometry><mesh filename='l.obj'/></geometry>"
        "</collision></link></robot>\"); morula.write_mesh('l.obj', morula.sample_body('limb', 200)); "
        "robot = morula.robot.read_robot('link.urdf')",
        "morula.robot.fit_spheres(robot, spheres=3000, quality='best')",
        "morula.robot.fit_spheres(robot, spheres=1, quality='draft').sphere_count == 1"),
    "robot.fit_spheres with inner ones": (
        "open('link.urdf', 'w').write(\"<robot name='r'><link name='l'><collision><geometry><mesh filename='l.obj'/></geometry>"
        "</collision></link></robot>\"); morula.write_mesh('l.obj', morula.sample_body('limb', 200)); "
        "robot = morula.robot.read_robot('link.urdf')",
        "morula.robot.fit_spheres(robot, spheres=1, quality='draft', inner=20000)",
        "morula.robot.fit_spheres(robot, spheres=1, quality='draft').sphere_count == 1"),
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
    if "robot" in name and not hasattr(morula._morula, "robot"):
        pytest.skip("this package was built without robots")
    if name == "study" and not hasattr(morula._morula, "study_files"):
        pytest.skip("this package was built without the command")
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
