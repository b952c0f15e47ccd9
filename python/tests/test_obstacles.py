# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Obstacles of surfaces against plain numpy; hulls, shared volume and modal certificates against others' answers."""

import gc
import pickle
import threading

import numpy
import pytest

import morula


@pytest.fixture(scope="module")
def surface(limb):
    surface = morula.SurfaceTree(limb)
    surface.update(limb.positions)
    return surface


def used(mesh):
    return numpy.unique(mesh.facets)


def points_on_facets(mesh, positions, each=40):
    """Samples: which facet, and where."""
    weights = numpy.random.default_rng(3).dirichlet([1, 1, 1], (mesh.facet_count, each))
    weights[:, 0] = 1 / 3
    return numpy.einsum("fsk,fkd->fsd", weights, positions[mesh.facets])


def test_vertices_below_a_floor_are_those_of_numpy(limb, surface):
    height = numpy.median(limb.positions[:, 2])
    query = morula.ObstacleQuery(features="vertices", margin=0.01)
    assert query.run(surface, morula.HalfSpace((0, 0, 2), 2 * height)).finished
    found = query.contacts()
    distances = limb.positions[:, 2] - height
    expected = [v for v in used(limb) if distances[v] <= 0.01]
    assert found.feature.tolist() == expected and len(expected) > 10
    numpy.testing.assert_allclose(found.distance, distances[expected], atol=1e-12)
    numpy.testing.assert_array_equal(found.point, limb.positions[expected])
    numpy.testing.assert_array_equal(found.normal, numpy.tile([0, 0, 1], (len(expected), 1)))
    assert found[0]["feature"] == expected[0] and len(found[found.distance < 0]["feature"]) < len(found)


@pytest.mark.parametrize("name", ["ball", "capsule", "hull", "field", "signed distance"])
def test_no_sample_of_a_facet_that_was_left_out_is_in_an_obstacle(limb, surface, name):
    middle = limb.positions.mean(axis=0)
    reach = 0.3 * numpy.ptp(limb.positions, axis=0).max()
    ball = (*middle, reach)
    p, q = middle - [0, reach, 0], middle + [0, reach, 0]
    hull = morula.ConvexHull.box(middle - reach / 2, middle + reach / 2)

    def from_ball(x):
        return numpy.linalg.norm(x - middle, axis=-1) - reach

    def from_capsule(x):
        t = numpy.clip((x - p) @ (q - p) / ((q - p) @ (q - p)), 0, 1)
        return numpy.linalg.norm(x - (p + t[..., None] * (q - p)), axis=-1) - reach / 3

    def from_hull(x):
        return (x @ hull.planes[:, :3].T - hull.planes[:, 3]).max(axis=-1)

    obstacle, inside = {
        "ball": (ball, from_ball),
        "capsule": (morula.Capsule(p, q, reach / 3), from_capsule),
        "hull": (hull, from_hull),
        "field": (morula.DistanceField(lambda x: float(from_ball(numpy.array(x)))), from_ball),
        "signed distance": (morula.DistanceField(morula.SignedDistance(hull)), from_hull),
    }[name]
    query = morula.ObstacleQuery()
    query.run(surface, obstacle)
    found = query.contacts()
    deepest = inside(points_on_facets(limb, limb.positions)).min(axis=1)
    missed = numpy.setdiff1d(numpy.flatnonzero(deepest < -1e-9), found.feature)
    assert missed.size == 0 and len(found) > 3
    # What is said to be the deepest point lies on the facet, where it says, and no sample is deeper.
    corners = limb.positions[limb.facets[found.feature]]
    numpy.testing.assert_allclose(numpy.einsum("nk,nkd->nd", found.weights, corners), found.point, atol=1e-12)
    slack = 0.2 * reach if "field" in name or "distance" in name else 1e-9
    assert (found.distance <= deepest[found.feature] + slack).all()
    if name in ("ball", "capsule"):
        numpy.testing.assert_allclose(found.distance, inside(found.point), atol=1e-9)


def test_a_budget_leaves_facets_open_and_the_query_goes_on(limb, surface):
    ball = (*limb.positions.mean(axis=0), 0.4)
    whole = morula.ObstacleQuery()
    whole.run(surface, ball)
    query = morula.ObstacleQuery(budget=20)
    status = query.run(surface, ball)
    assert not status.finished and status.box_tests > 0
    open_now = set(numpy.concatenate(query.open()).tolist())
    assert set(whole.contacts().feature.tolist()) - set(query.contacts().feature.tolist()) <= open_now
    query.set_budget(None)
    assert query.resume().finished and query.contacts() == whole.contacts() and query.open() == []
    surface.update(limb.positions)
    with pytest.raises(ValueError):
        query.resume()


def test_what_is_refused_leaves_the_query_where_it_stood(limb, surface):
    """What it stands at, which nobody else holds, is kept, too."""
    ball = (*limb.positions.mean(axis=0), 0.4)
    for kind, found, refused in (
        (morula.ObstacleQuery, lambda q: q.contacts(), (morula.HalfSpace((0, 0, 0)),)),
        (morula.SweptObstacleQuery, lambda q: q.impacts(), (ball, (numpy.inf, 0, 0))),
    ):
        whole = kind()
        whole.run(surface, ball)
        query = kind(budget=20)
        own = morula.SurfaceTree(limb)
        own.update(limb.positions)
        assert not query.run(own, ball).finished
        del own
        with pytest.raises(ValueError):
            query.run(morula.SurfaceTree(morula.sample_body("limb", 4)), *refused)
        gc.collect()
        query.set_budget(None)
        assert query.resume().finished and found(query) == found(whole) and len(found(whole)) > 10


def test_filters_and_fields_may_be_python_and_raise(limb, surface):
    floor = morula.HalfSpace((0, 0, 1), numpy.median(limb.positions[:, 2]))
    even = morula.ObstacleQuery(features="vertices", accepts=lambda v: v % 2 == 0)
    even.run(surface, floor)
    every = morula.ObstacleQuery(features="vertices")
    every.run(surface, floor, morula.Workers(2))
    assert even.contacts().feature.tolist() == [v for v in every.contacts().feature.tolist() if v % 2 == 0]

    def broken(point):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        every.run(surface, morula.DistanceField(broken))
    with pytest.raises(ValueError):
        every.resume()
    assert every.run(surface, floor).finished
    # A field that nobody else holds lives as long as the query goes on with it.
    query = morula.ObstacleQuery(budget=5)
    query.run(surface, morula.DistanceField(lambda x: x[2] - 0.1, gradient=lambda x: (0, 0, 1)))
    gc.collect()
    query.set_budget(None)
    assert query.resume().finished


def test_a_field_is_asked_while_other_threads_run(surface):
    field = morula.DistanceField(lambda x: x[2] - 0.1)
    queries = [morula.ObstacleQuery() for _ in range(3)]
    threads = [threading.Thread(target=q.run, args=(surface, field, morula.Workers(2))) for q in queries]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert queries[0].contacts() == queries[1].contacts() == queries[2].contacts()


def test_a_step_onto_a_floor_ends_where_the_lowest_vertex_meets_it(limb):
    surface = morula.SurfaceTree(limb)
    lowest = limb.positions[used(limb), 2].min()
    surface.update(limb.positions, limb.positions - [0, 0, 1.0])
    floor = morula.HalfSpace((0, 0, 1), lowest - 0.25)
    query = morula.SweptObstacleQuery(features="vertices")
    query.run(surface, floor)
    truth = 0.25 + limb.positions[used(limb), 2] - lowest
    impacts = query.impacts()
    assert impacts.feature.tolist() == used(limb)[truth <= 1].tolist()
    numpy.testing.assert_allclose(impacts.time, truth[truth <= 1], atol=1e-6)
    assert (impacts.time <= truth[truth <= 1]).all()
    assert query.collision_free_step() == impacts.time.min()
    # The same when the floor comes.
    surface.update(limb.positions)
    query.run(surface, floor, motion=(0, 0, 1))
    numpy.testing.assert_allclose(query.collision_free_step(), 0.25, atol=1e-6)


def test_what_is_no_obstacle_is_refused(surface):
    query = morula.ObstacleQuery()
    with pytest.raises(TypeError, match="obstacle: .*HalfSpace"):
        query.run(surface, "floor")
    with pytest.raises(ValueError):
        query.run(surface, (0, 0, 0, -1))
    with pytest.raises(ValueError, match="features"):
        morula.ObstacleQuery(features="edges")
    with pytest.raises(TypeError, match="value"):
        morula.DistanceField(3)
    with pytest.raises(TypeError, match="accepts"):
        morula.ObstacleQuery(accepts=3)


def test_hulls_are_those_of_scipy():
    spatial = pytest.importorskip("scipy.spatial")
    points = numpy.random.default_rng(5).normal(size=(200, 3))
    ours, theirs = morula.ConvexHull(points), spatial.ConvexHull(points)
    assert numpy.array_equal(ours.vertices, points[numpy.sort(theirs.vertices)])
    assert len(ours.facets) == len(theirs.simplices)
    volume = numpy.linalg.det(ours.vertices[ours.facets]).sum() / 6
    assert numpy.isclose(volume, theirs.volume) and numpy.isclose(morula.signed_volume(ours), theirs.volume)
    assert (ours.planes[:, :3] @ points.T - ours.planes[:, 3:] < 1e-12).all()
    again = pickle.loads(pickle.dumps(ours))
    assert numpy.array_equal(again.vertices, ours.vertices) and numpy.array_equal(again.facets, ours.facets)
    turn = morula.RigidTransform.from_axis((1, 2, 3), 0.7, (1, 0, 0))
    numpy.testing.assert_allclose(ours.placed(turn).vertices, [turn(v) for v in ours.vertices])
    with pytest.raises(ValueError):
        morula.ConvexHull(points * [1, 1, 0])


def test_bodies_touch_hulls_as_they_touch_the_half_spaces_of_a_box(limb, model):
    body = morula.Body(limb, model)
    top = limb.positions[used(limb), 2].max()
    box = morula.ConvexHull.box((-50, -50, top - 0.1), (50, 50, 50))
    floor = morula.HalfSpace((0, 0, -1), -(top - 0.1))
    of_box, of_floor = morula.touch(body, box), morula.touch(body, floor)
    assert of_box.touches and of_floor.touches and numpy.isclose(of_box.deepest.depth, of_floor.deepest.depth)
    scene = morula.Scene()
    scene.add(body)
    scene.update()
    assert len(scene.touch(box)) == 1
    assert not morula.touch(body, morula.ConvexHull.box((-50, -50, top + 1), (50, 50, 50))).touches


def test_the_volume_that_two_boxes_share_is_between_the_bounds():
    points = morula.ConvexHull.box((0, 0, 0), (1, 1, 1))
    box = morula.Mesh(points.vertices, points.facets)
    a, b = (morula.Collider(morula.Body(box, morula.build(box, method="octree", depth=2))) for _ in range(2))
    b.set_transform((0.5, 0.25, 0.0))
    query = morula.PenetrationQuery(a, b)
    truth = 0.5 * 0.75 * 1.0
    coarse = query.run(budget=500)
    assert coarse.lower <= truth <= coarse.upper and not coarse.finished and coarse.certified
    fine = query.resume(tolerance=0.05, budget=200000)
    assert coarse.lower <= fine.lower <= truth <= fine.upper <= coarse.upper and fine.finished
    assert abs(fine.estimate - truth) < 0.03 * truth
    numpy.testing.assert_allclose(fine.center, (0.75, 0.625, 0.5), atol=0.02)
    b.set_transform((3, 0, 0))
    with pytest.raises(ValueError):
        query.resume()
    apart = query.run()
    assert apart.lower == apart.upper == 0
    with pytest.raises(ValueError):
        query.run(tolerance=-1)


def test_a_modal_certificate_says_what_surface_crossings_say():
    limb = morula.sample_body("limb", 12)
    modes = morula.sample_modes(limb.positions, 3)
    certificate = morula.ModalCertificate(limb, modes, largest_norm=12.0, rest_distance=0.2)
    assert 0 < certificate.free_norm <= 12 and certificate.tested_facet_pairs > 0
    surface = morula.SurfaceTree(limb)
    generator = numpy.random.default_rng(2)
    some = 0
    for norm in (0.3, 0.9, 6, 11.9):
        for _ in range(4):
            q = generator.normal(size=3)
            q *= norm / numpy.linalg.norm(q)
            assert numpy.isclose(certificate.norm(q), norm) and certificate.is_known(q)
            moved = morula.move_by_modes(modes, limb.positions, q)
            surface.update(moved)
            truth = morula.surface_crossings(surface, rest_distance=0.2)
            assert certificate.crossings(q, moved) == truth
            assert certificate.is_free(q) == (norm <= certificate.free_norm)
            open_pairs = certificate.open(q)
            pairs = set(zip(open_pairs.a.tolist(), open_pairs.b.tolist()))
            assert set(zip(truth.a.tolist(), truth.b.tolist())) <= pairs
            assert not (certificate.is_free(q) and len(truth))
            some += len(truth)
    assert some > 0
    assert not certificate.is_known(q * 2) and certificate.crossings(q * 2, moved) is None
    with pytest.raises(ValueError, match="coordinates"):
        certificate.norm(numpy.zeros(4))
    with pytest.raises(ValueError, match="positions"):
        certificate.crossings(q, moved[:5])
