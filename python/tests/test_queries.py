# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Contacts, crossings, distance, rays, insides; measures; pairs of features: against formulas and brute force."""

import datetime
import itertools
import math
import subprocess
import sys

import numpy
import pytest

import morula


@pytest.fixture(scope="module")
def pair(limb):
    """A limb and a tool that crosses it."""
    tool = morula.sample_body("tool", 16)
    a = morula.Collider(morula.Body(limb, morula.build(limb, method="grid", depth=2)))
    b = morula.Collider(morula.Body(tool, morula.build(tool, method="grid", depth=2)))
    b.set_transform((0.0, 0.4, 0.0))
    return a, b


def triangles_meet(a, b):
    """By signs of volumes, for triangles in general position."""

    def side(p, q, r, s):
        return numpy.linalg.det(numpy.array([q - p, r - p, s - p])) > 0

    def crosses(p, q, t):
        if side(*t, p) == side(*t, q):
            return False
        return len({side(p, q, t[i], t[(i + 1) % 3]) for i in range(3)}) == 1

    return any(crosses(a[i], a[(i + 1) % 3], b) for i in range(3)) or any(crosses(b[i], b[(i + 1) % 3], a) for i in range(3))


def brute_crossings(mesh_a, at_a, mesh_b, at_b):
    boxes = [(at[mesh.facets].min(axis=1), at[mesh.facets].max(axis=1)) for mesh, at in ((mesh_a, at_a), (mesh_b, at_b))]
    near = ((boxes[0][0][:, None] <= boxes[1][1][None]) & (boxes[1][0][None] <= boxes[0][1][:, None])).all(axis=2)
    return [
        (int(f), int(g)) for f, g in zip(*numpy.nonzero(near)) if triangles_meet(at_a[mesh_a.facets[f]], at_b[mesh_b.facets[g]])
    ]


def test_crossings_are_those_of_brute_force(limb, pair):
    tool = morula.sample_body("tool", 16)
    found = morula.crossings(*pair)
    expected = brute_crossings(limb, limb.positions, tool, tool.positions + [0.0, 0.4, 0.0])
    assert list(zip(found.facet_a.tolist(), found.facet_b.tolist())) == expected and len(found) > 10
    exact = morula.collide(*pair, find_crossings=True)
    assert exact.crossings == found


def test_contacts_are_columns(pair):
    contacts = morula.collide(*pair, surfaces=True)
    assert len(contacts) == len(contacts.depth) > 0 and contacts.is_finished and contacts.finished.all()
    assert contacts.point.shape == contacts.normal.shape == (len(contacts), 3)
    assert numpy.allclose(numpy.linalg.norm(contacts.normal, axis=1), 1.0)
    row = contacts[0]
    assert row["depth"] == contacts.depth[0] and (row["point"] == contacts.point[0]).all()
    deep = contacts[contacts.depth > 0]
    assert len(deep["depth"]) == (contacts.depth > 0).sum()
    assert set(contacts[:2]) == {"pair", "node_a", "node_b", "finished", "point", "normal", "depth", "lens_volume", "error_bound"}
    assert contacts.to_dict()["surfaces"]["depth"].shape == (len(contacts),)
    depth = contacts.depth
    del contacts
    assert numpy.isfinite(depth).all()


def test_contacts_agree_with_their_spheres(limb, pair):
    contacts = morula.collide(*pair)
    body = morula.Body(limb, morula.build(limb, method="grid", depth=2))
    tool = morula.sample_body("tool", 16)
    other = morula.Body(tool, morula.build(tool, method="grid", depth=2))
    a, b = body.copy_spheres()[contacts.node_a], other.copy_spheres()[contacts.node_b]
    gap = numpy.linalg.norm(a[:, :3] - b[:, :3] - [0.0, 0.4, 0.0], axis=1)
    depth = numpy.minimum(a[:, 3] + b[:, 3] - gap, 2 * numpy.minimum(a[:, 3], b[:, 3]))
    assert numpy.allclose(contacts.depth, depth, atol=1e-5)


def test_budgets_end_a_query_and_it_goes_on(pair):
    whole = morula.collide(*pair)
    query = morula.ContactQuery(budget=100)
    query.add(*pair)
    contacts = query.start()
    assert not contacts.is_finished
    for _ in range(1000):
        if contacts.is_finished:
            break
        contacts = query.resume()
    assert sorted(zip(contacts.node_a, contacts.node_b)) == sorted(zip(whole.node_a, whole.node_b))
    for budget in ("1s", datetime.timedelta(seconds=1), 10**9, None):
        assert len(morula.collide(*pair, budget=budget)) == len(whole)
    with pytest.raises(TypeError, match="budget: '5 minutes'"):
        morula.collide(*pair, budget="5 minutes")
    with pytest.raises(ValueError, match="budget: -1"):
        morula.collide(*pair, budget=-1)


def test_a_walk_sees_every_contact(pair):
    seen = []
    tests = morula.walk_pairs(*pair, lambda a, b, final: seen.append((a, b)) if final else None)
    contacts = morula.collide(*pair)
    assert sorted(seen) == sorted(zip(contacts.node_a.tolist(), contacts.node_b.tolist())) and tests > 0
    with pytest.raises(ZeroDivisionError):
        morula.walk_pairs(*pair, lambda a, b, final: 1 / 0)


def test_a_front_is_kept_and_taken_up_again(pair):
    whole = morula.ContactQuery()
    whole.add(*pair)
    expected = whole.run()
    query = morula.ContactQuery(budget=60)
    query.add(*pair)
    begun = query.start()
    assert not begun.is_finished
    front = query.front()
    assert front == query.front() and front.waiting_count > 0 and front.pair_count == 1 and "waiting" in repr(front)
    query.set_budget(None)
    assert query.resume().is_finished and query.front() != front
    # Another query goes on from where the first one stood.
    other = morula.ContactQuery()
    other.add(*pair)
    other.set_front(front)
    found = other.resume()
    assert found.is_finished and sorted(zip(found.node_a, found.node_b)) == sorted(zip(expected.node_a, expected.node_b))
    lonely = morula.ContactQuery()
    lonely.set_front(front)
    with pytest.raises(ValueError):
        lonely.resume()


def test_shapes_print_as_the_calls_that_make_them():
    floor, rod = morula.HalfSpace((0, 0, 2), 3), morula.Capsule((0, 0, 0), (1, 0, 0), 0.5)
    assert repr(floor) == "HalfSpace(normal=(0.0, 0.0, 2.0), offset=3.0)" and floor.normal == (0, 0, 2) and floor.offset == 3
    assert repr(rod) == "Capsule(p=(0.0, 0.0, 0.0), q=(1.0, 0.0, 0.0), radius=0.5)" and (rod.p, rod.q, rod.radius) == ((0, 0, 0), (1, 0, 0), 0.5)


def test_queries_compute_the_vertices_that_they_read(limb, model):
    skin, modes = morula.sample_skin(limb.positions), morula.sample_modes(limb.positions)
    skinned = morula.Body(limb, model, rules="skinned", skin=skin)
    modal = morula.Body(limb, model, rules="modal", modes=modes)
    exact = morula.Body(limb, model)
    origins = limb.positions + [0.01, 0.02, 9.0]
    directions = numpy.tile([0.0, 0.0, -1.0], (len(origins), 1))
    other = morula.Collider(morula.Body(limb, model))
    other.set_transform((0.1, 0.2, 0.0))
    for frame, transforms in enumerate(morula.sample_bones(limb.positions, 4)[1:]):
        coordinates = numpy.array([0.05 * frame, -0.03, 0.0, 0.02])
        skinned.update_skinned(transforms)
        modal.update_modal(coordinates)
        by_skin = morula.move_by_skin(skin, limb.positions, transforms)
        by_modes = morula.move_by_modes(modes, limb.positions, coordinates)
        for body, positions in ((skinned, by_skin), (modal, by_modes)):
            exact.update(positions)
            collider, expected = morula.Collider(body), morula.Collider(exact)
            assert collider.has_current_positions
            hits, expected_hits = (morula.first_hits(side, origins, directions) for side in (collider, expected))
            assert numpy.array_equal(hits.facet, expected_hits.facet) and numpy.array_equal(hits.t, expected_hits.t)
            assert numpy.array_equal(morula.crossings(collider, other).facet_a, morula.crossings(expected, other).facet_a)
            assert numpy.array_equal(morula.InsideQuery(collider).inside(by_skin), morula.InsideQuery(expected).inside(by_skin))
            assert morula.distance(collider, other).upper == morula.distance(expected, other).upper
            assert numpy.array_equal(collider.vertices(), positions)


def test_components_are_inside_or_not():
    bar = morula.sample_body("bar", 8)
    body = morula.Body(bar, morula.build(bar, quality="fast"))
    lower, upper = map(numpy.array, morula.bounding_box(bar))
    small = numpy.array(bar.positions) * 0.2
    center = (lower + upper) / 2
    two = morula.Mesh(
        numpy.concatenate([small - small.mean(axis=0) + center, small + upper + 1]),
        numpy.concatenate([bar.facets, bar.facets + len(small)]),
    )
    other = morula.Body(two, morula.build(two, quality="fast"))
    inside = morula.InsideQuery(body).components_inside(other, morula.component_vertices(two))
    assert inside.inside == [True, False] and inside.certified and inside.any and not inside.all
    assert morula.InsideQuery(body).components_inside(body, morula.component_vertices(bar)).inside == [True]  # on its surface
    with pytest.raises(IndexError, match="vertices"):
        morula.InsideQuery(body).components_inside(other, numpy.array([two.vertex_count]))


def test_samplers_and_estimators_say_what_single_calls_say(limb, model, motion):
    spheres = model.level(1)
    sampled = morula.measure_spheres(limb, spheres, resolution=16, with_sampled_fit=True).sampled
    sampler = morula.FitSampler(limb)
    assert sampler.measure(spheres) == sampled == sampler.measure(spheres, morula.Workers(2))
    bare = spheres * [1, 1, 1, 0.6]
    assert morula.FitSampler(limb, seed=2).measure(bare).surface_gap_mean != sampler.measure(bare).surface_gap_mean > 0
    estimator = morula.LoosenessEstimator(limb)
    assert estimator.has_volume
    assert not morula.LoosenessEstimator(morula.Mesh(limb.positions, limb.facets[1:])).has_volume
    body = morula.Body(limb, model)
    for positions in motion[:3]:
        body.update(positions)
        assert numpy.array_equal(estimator.estimate(body, positions), morula.estimate_looseness(body, positions))
    with pytest.raises(ValueError, match="vertices"):
        estimator.estimate(body, motion[0][:-1])
    with pytest.raises(ValueError):
        morula.LoosenessEstimator(limb, 3)


def test_distance_lies_between_its_bounds(limb, model):
    tool = morula.sample_body("tool", 12)
    a, b = morula.Collider(morula.Body(limb, model)), morula.Collider(morula.Body(tool, morula.build(tool, quality="fast")))
    b.set_transform((0.0, 2.5, 0.0))
    bounds = morula.distance(a, b)
    points = morula.TriangleBvh(limb).closest_points(tool.positions + [0.0, 2.5, 0.0])
    assert bounds.lower <= bounds.upper <= points.distances.min() + 1e-12
    assert numpy.isclose(numpy.linalg.norm(numpy.subtract(bounds.a.point, bounds.b.point)), bounds.upper)
    assert morula.DistanceQuery().run(a, b).upper == bounds.upper and not morula.overlap(a, b)
    assert bounds.certified and bounds.complete and not bounds.crossing


def test_moving_spheres_contain_vertices_on_straight_lines(limb, model, motion):
    body = morula.Body(limb, model)
    moving = morula.MovingSpheres()
    with pytest.raises(ValueError, match="cover"):
        moving.set_end(body)
    moving.set_start(body)
    body.update(motion[1])
    moving.set_end(body)
    assert len(moving) == model.tree.node_count and moving.covers
    # Every vertex lies in a leaf's sphere, at any time.
    leaves = numpy.flatnonzero(numpy.asarray(model.tree.child_count) == 0)
    for t in (0.0, 0.3, 1.0):
        positions = limb.positions + t * (motion[1] - limb.positions)
        spheres = moving.spheres(t)
        assert spheres.shape == (len(moving), 4)
        away = numpy.linalg.norm(positions[:, None] - spheres[None, leaves, :3], axis=2) - spheres[leaves, 3]
        assert (away.min(axis=1) <= 0).all()
        swept, boxes = moving.swept_spheres(), moving.swept_boxes()
        assert (numpy.linalg.norm(swept[:, :3] - spheres[:, :3], axis=1) + spheres[:, 3] <= swept[:, 3]).all()
        assert (boxes[:, 0] <= spheres[:, :3] - spheres[:, 3:]).all() and (boxes[:, 1] >= spheres[:, :3] + spheres[:, 3:]).all()
    wide = moving.spheres(0.5)[:, 3]
    moving.widen(0.25)
    assert numpy.allclose(moving.spheres(0.5)[:, 3], wide + 0.25)
    moving.advance()
    assert numpy.array_equal(moving.spheres(0.0), moving.spheres(1.0))
    with pytest.raises(ValueError, match="t is not a number"):
        moving.spheres(float("nan"))
    assert morula.arc_deviation(numpy.array([0.8]), numpy.array([2.0])) == pytest.approx(0.8**2 * 2 / 8)


def test_the_earliest_touch_is_that_of_two_balls():
    ball = morula.sample_body("blob", 12)
    model = morula.build(ball, quality="fast")
    root = model.tree.spheres[0]
    a, b = morula.Collider(morula.Body(ball, model)), morula.Collider(morula.Body(ball, model))
    first, second = morula.MovingSpheres(), morula.MovingSpheres()
    b.set_transform((0.0, 0.0, 5 * root[3]))
    first.set_start(a)
    second.set_start(b)
    assert morula.earliest_touch(first, second).apart
    b.set_transform((0.0, 0.0, 0.0))
    second.set_end(b)
    touch = morula.earliest_touch(first, second)
    # They move five radii: the roots touch after three, the surfaces no earlier.
    assert not touch.apart and touch.certified and touch.complete and 0.6 <= touch.time < 1
    whole = morula.earliest_touch(first, second, distance=root[3]).time
    assert whole < touch.time
    cut = morula.earliest_touch(first, second, budget=1)
    assert not cut.complete and cut.time == pytest.approx(0.6, abs=1e-3) and cut.nodes == (0, 0)
    assert morula.earliest_touch(first, first).time == 0


def test_a_box_is_where_it_is():
    bar = morula.sample_body("bar", 8)
    body = morula.Body(bar, morula.build(bar, quality="fast"))
    lower, upper = map(numpy.array, morula.bounding_box(bar))
    top = upper[2]
    hit = morula.first_hit(body, (0.01, 0.02, 10.0), (0.0, 0.0, -1.0))
    assert hit and numpy.isclose(hit.first.t, 10.0 - top) and numpy.allclose(hit.first.normal, (0, 0, 1))
    assert not morula.first_hit(body, (100.0, 0.0, 10.0), (0.0, 0.0, -1.0))
    hits = morula.first_hits(body, numpy.array([[0.01, 0.02, 10.0], [100.0, 0.0, 0.0]]), numpy.array([[0, 0, -1.0], [0, 0, 1.0]]))
    assert numpy.isclose(hits.t[0], 10.0 - top) and numpy.isinf(hits.t[1]) and hits.facet[1] == morula.no_node

    touch = morula.touch(body, morula.HalfSpace((0, 0, -1), -top + 0.1))
    assert touch.touches and numpy.isclose(touch.deepest.depth, 0.1)
    assert morula.touch(body, (0.0, 0.0, top + 1.0, 0.5)).proven_clear
    assert morula.touch(body, morula.Capsule((0, 0, top + 1.0), (0, 0, top + 2.0), 1.01)).touches
    with pytest.raises(TypeError, match="shape"):
        morula.touch(body, "floor")

    points = numpy.random.default_rng(5).uniform(lower - 0.5, upper + 0.5, (300, 3))
    inside = ((points >= lower) & (points <= upper)).all(axis=1)
    query = morula.InsideQuery(body)
    assert numpy.array_equal(query.inside(points), inside)
    assert query.locate(points[0]).inside == inside[0] and query.probe((0, 0, 0, 0.1)).inside
    assert query.locate(points[0]).sphere_tests > 0
    distances = morula.SignedDistance(bar)(points)
    assert numpy.array_equal(morula.SignedDistance(bar).is_inside(points, morula.Workers(2)), inside)
    outside = numpy.linalg.norm(numpy.maximum(numpy.maximum(lower - points, points - upper), 0), axis=1)
    assert numpy.array_equal(distances < 0, inside) and numpy.allclose(distances[~inside], outside[~inside])
    with pytest.raises(ValueError, match="directions"):
        morula.first_hits(body, points, points[:3])


def test_measures_of_a_ball_are_those_of_formulas():
    """One sphere of twice the radius around a ball has looseness 7."""
    capsule = morula.sample_body("capsule", 48)
    volume = morula.signed_volume(capsule)
    measured = morula.measure_spheres(capsule, numpy.array([[0.0, 0.0, 0.0, 2.0]]))
    expected = 4 / 3 * numpy.pi * 8 / volume - 1
    assert abs(measured.looseness.looseness - expected) < 0.02 * expected
    assert measured.coverage.covered and measured.coverage.uncovered_area == 0
    bare = morula.coverage(capsule, numpy.array([[0.0, 0.0, 0.0, 0.1]]))
    assert not bare.covered and bare.uncovered_area > 0.99 and bare.uncovered_distance <= bare.uncovered_distance_upper


def test_measures_are_those_of_the_command(command, tmp_path):
    import json

    command("sample", "limb", "--resolution", "12", "-o", "limb.obj")
    command("build", "limb.obj", "-o", "limb.morula", "--method", "grid", "--depth", "2")
    theirs = json.loads(command("measure", "limb.obj", "limb.morula", "--json"))
    mesh = morula.read_mesh(tmp_path / "limb.obj")
    ours = morula.measure(mesh, morula.read_tree(tmp_path / "limb.morula").tree)
    text = json.dumps(theirs)
    assert len(ours) == 3
    for level in ours:
        assert repr(level.looseness.looseness)[:12] in text


def test_pairs_of_features_are_those_of_brute_force():
    plate = morula.sample_body("plate", 6)
    surface = morula.SurfaceTree(plate)
    other = morula.SurfaceTree(plate)
    lifted = plate.positions + [0.13, 0.11, 0.07]
    other.update(lifted)
    found = morula.proximity(surface, other, distance=0.08)
    near = set()
    for vertex, facet in itertools.product(range(plate.vertex_count), range(plate.facet_count)):
        triangle = morula.TriangleBvh((lifted, plate.facets[facet : facet + 1]))
        if triangle.closest_points(plate.positions[vertex : vertex + 1]).distances[0] <= 0.08:
            near.add((vertex, facet))
    of_kind = found.kind == int(morula.PairKind.vertex_facet)
    assert set(zip(found.a[of_kind].tolist(), found.b[of_kind].tolist())) == near and near
    assert numpy.allclose(numpy.linalg.norm(found.point_b - found.point_a, axis=1), found.distance)
    # A filter in Python, and one that fails.
    chosen = morula.proximity(surface, other, distance=0.08, accepts=lambda kind, a, b: a == 0)
    assert set(chosen.a.tolist()) <= {0}
    with pytest.raises(ZeroDivisionError):
        morula.proximity(surface, other, distance=0.08, accepts=lambda kind, a, b: 1 / 0)


def test_swept_pairs_come_no_later_than_they_touch():
    a_from, a_to = numpy.array([[0.2, 0.2, 1.0]]), numpy.array([[0.2, 0.2, -1.0]])
    triangle = numpy.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    time = morula.time_of_impact(a_from, a_to, triangle, triangle)
    assert 0.49 < time <= 0.5
    bar = morula.sample_body("bar", 4)
    falling, floor = morula.SurfaceTree(bar), morula.SurfaceTree(bar)
    falling.update(bar.positions + [0, 0, 3.0], bar.positions + [0, 0, 0.5])
    pairs = morula.swept(falling, floor)
    height = bar.positions[:, 2].max() - bar.positions[:, 2].min()
    expected = (3.0 - height) / 2.5
    assert len(pairs) > 0 and expected - 0.01 < pairs.time.min() <= expected + 1e-12


def test_a_folded_surface_crosses_itself(limb):
    surface = morula.SurfaceTree(limb)
    assert len(morula.surface_crossings(surface)) == 0
    bent = numpy.array(limb.positions)
    bent[:, 0] = numpy.abs(bent[:, 0] - bent[:, 0].mean())
    surface.update(bent)
    found = morula.surface_crossings(surface)
    assert len(found) > 0 and (found.a < found.b).all()


def test_medial_balls_hold_no_surface():
    capsule = morula.sample_body("capsule", 24)
    shape = morula.SignedDistance(capsule)
    points, facets = morula.sample_surface(capsule, 200)
    corners = capsule.positions[capsule.facets[facets]]
    normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= numpy.linalg.norm(normals, axis=1)[:, None]
    balls = morula.shrinking_balls(shape, points, normals).balls
    assert len(balls) > 50 and (-shape(numpy.array(balls[:, :3])) >= balls[:, 3] - 1e-6).all()
    tree = morula.tree_from_spheres(numpy.array(balls))
    assert tree.leaf_count == len(balls) and tree.validate() == []


def test_spheres_that_are_asked_in_one_thread_are_set_in_another():
    """In a program of its own, since what waits for ever here would stop all tests."""
    code = """
import threading, time
import morula, numpy
bar = morula.sample_body("bar", 8)
built = morula.build(bar, quality="fast")
spheres = morula.PosedSpheres(built.tree)
collider = morula.Collider(bar, built, spheres)
collider.set_positions(bar.positions)
rays = numpy.tile([[0.0, 0, 9]], (100000, 1)), numpy.tile([[0.0, 0, -1]], (100000, 1))
long = threading.Thread(target=morula.first_hits, args=(collider, *rays))
long.start()
time.sleep(0.01)
while long.is_alive():
    spheres.set(numpy.array(built.spheres))
print("done")
"""
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120).stdout == "done\n"


def test_posed_spheres_are_asked_as_bodies_are(model):
    spheres = morula.PosedSpheres(model.tree)
    collider = morula.Collider(spheres)
    assert morula.overlap(collider, collider) and not collider.has_surface
    far = numpy.array(model.tree.spheres)
    far[:, 0] += 100
    other = morula.PosedSpheres(model.tree)
    other.set(far)
    assert not morula.overlap(collider, other)
    with pytest.raises(ValueError):
        morula.crossings(collider, other)


def test_the_surface_of_tetrahedra_has_their_outer_faces_and_the_numbers_of_their_points():
    points = numpy.array([(0, 0, 0), (9, 9, 9), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1)], float)
    tetrahedra = numpy.array([(0, 2, 3, 4), (0, 2, 3, 5)])
    mesh, index = morula.solid_surface(points, tetrahedra)
    assert index.tolist() == [0, 2, 3, 4, 5]
    assert {tuple(sorted(facet)) for facet in index[mesh.facets].tolist()} == {
        (0, 2, 4), (0, 3, 4), (2, 3, 4), (0, 2, 5), (0, 3, 5), (2, 3, 5)}
    assert morula.signed_volume(mesh) == pytest.approx(1 / 3)
    cube = numpy.array([(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float)
    assert morula.signed_volume(morula.solid_surface(cube, hexahedra=numpy.arange(8).reshape(1, 8))[0]) == 1
    for bad, text in (([(0, 2, 3, 6)], "there are 6 points"), ([(0, 2, 3, 3)], "twice"), ([(0, 2, 3, 4)] * 2, "same side")):
        with pytest.raises(ValueError, match=text):
            morula.solid_surface(points, numpy.array(bad))
    with pytest.raises(ValueError, match="no tetrahedra"):
        morula.solid_surface(points)


def test_a_haptic_probe_stays_outside_while_the_device_goes_through():
    plate = morula.sample_body("plate")
    body = morula.Body(plate, morula.build(plate, quality="draft"))
    axis = int(numpy.argmin(numpy.ptp(plate.positions, axis=0)))
    thickness = plate.positions[:, axis].max()
    probe = morula.HapticProbe(radius=0.01, skin=1e-6, stiffness=100)
    device = numpy.zeros(3)
    device[axis] = 1
    assert tuple(probe.step(body, device).proxy) == tuple(device)
    device[axis] = -1
    step = probe.step(body, device)
    assert step.touches and step.settled and step.certified and not step.jammed
    assert step.proxy[axis] == pytest.approx(thickness + 0.01, abs=1e-5)
    assert step.force[axis] == pytest.approx(100 * (thickness + 0.01 + 1), rel=1e-4)
    assert step.normal[axis] == pytest.approx(1) and step.contact.facet < plate.facet_count
    assert probe.path().shape == (step.moves + 2, 3)
    probe.reset()
    assert tuple(probe.step(body, device).proxy) == tuple(device)
    with pytest.raises(ValueError, match="not finite"):
        probe.step(body, (math.nan, 0, 0))
    with pytest.raises(ValueError, match="radius"):
        morula.HapticProbe(radius=-1)


def test_a_haptic_tool_lies_on_a_plate_while_the_device_goes_through():
    plate = morula.sample_body("plate")
    body = morula.Body(plate, morula.build(plate, quality="draft"))
    axis = int(numpy.argmin(numpy.ptp(plate.positions, axis=0)))
    along = (axis + 1) % 3
    thickness = plate.positions[:, axis].max()
    balls = numpy.zeros((3, 4))
    balls[:, along], balls[:, 3] = (-0.1, 0, 0.1), 0.02
    tool = morula.HapticTool(balls, skin=1e-4, stiffness=100)
    assert tool.center == pytest.approx((0, 0, 0))
    device = numpy.eye(4)
    device[axis, 3] = 1
    assert not tool.step(body, device).jammed
    device[axis, 3] = -0.1
    for _ in range(20):
        step = tool.step(body, morula.RigidTransform(device))
    assert step.touches and step.settled and step.certified and not step.jammed
    height = thickness + 0.02 + 1e-4
    assert step.proxy.translation[axis] == pytest.approx(height, abs=1e-4)
    assert step.force[axis] == pytest.approx(100 * (height + 0.1), rel=1e-2)
    assert numpy.linalg.norm(step.torque) < 1e-2 * step.force[axis]
    assert sorted({contact.ball for contact in step.contacts}) == [0, 1, 2]
    for contact in step.contacts:
        assert contact.normal[axis] == pytest.approx(1) and contact.point.facet < plate.facet_count
        assert contact.distance == pytest.approx(0.02, abs=2e-4)
    assert len(tool.path()) == step.moves + 2
    tool.reset()
    device[axis, 3] = thickness
    assert tool.step(body, device).jammed
    with pytest.raises(ValueError, match="skin"):
        morula.HapticTool(balls, skin=-1)
    with pytest.raises(ValueError, match="ball"):
        morula.HapticTool(numpy.zeros((0, 4)))


def test_leaf_spheres_are_those_of_the_leaves():
    mesh = morula.sample_body("limb", 12)
    model = morula.build(mesh, method="octree")
    body = morula.Body(mesh, model)
    leaves = numpy.array(model.tree.child_count) == 0
    spheres = numpy.array(body.spheres, float)[leaves]
    spheres[:, :3] += body.origin
    assert numpy.allclose(morula.leaf_spheres(body), spheres)
