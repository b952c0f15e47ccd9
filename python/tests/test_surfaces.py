# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Queries of surfaces that a budget ends and that go on: nothing is missing but what they say is open, and all is there in the end."""

import numpy
import pytest

import morula


@pytest.fixture(scope="module")
def surfaces():
    """A limb that falls through a tool."""
    limb, tool = morula.sample_body("limb", 12), morula.sample_body("tool", 10)
    a, b = morula.SurfaceTree(limb), morula.SurfaceTree(tool)
    a.update(limb.positions + [0.02, 0.5, 0.03], limb.positions + [0.02, 0.1, 0.03])
    return a, b


queries = {
    "proximity": (morula.ProximityQuery, {"distance": 0.05}, lambda a, b: morula.proximity(a, b, distance=0.05)),
    "swept": (morula.SweptQuery, {}, morula.swept),
    "crossings": (morula.SurfaceCrossingQuery, {}, morula.surface_crossings),
}


def keys(pairs):
    return list(zip(pairs.kind.tolist(), pairs.a.tolist(), pairs.b.tolist()))


def facets_of(surface, kind, feature):
    """Facets that a feature belongs to."""
    facets = surface.facets
    if kind == "facet":
        return {feature}
    if kind == "vertex":
        return set(numpy.flatnonzero((facets == feature).any(axis=1)).tolist())
    edge = surface.edges[feature]
    return set(numpy.flatnonzero(numpy.isin(facets, edge).sum(axis=1) == 2).tolist())


sides = {
    int(morula.PairKind.vertex_facet): ("vertex", "facet"),
    int(morula.PairKind.facet_vertex): ("facet", "vertex"),
    int(morula.PairKind.edge_edge): ("edge", "edge"),
    int(morula.PairKind.facet_facet): ("facet", "facet"),
}


def test_directions_lead_from_one_to_the_other(surfaces):
    found = morula.proximity(*surfaces, distance=0.05)
    apart = found.distance > 0
    between = found.point_b - found.point_a
    numpy.testing.assert_allclose(found.direction[apart] * found.distance[apart, None], between[apart], atol=1e-12)
    assert not found.direction[~apart].any() and apart.any() and found[0]["direction"].shape == (3,)


@pytest.mark.parametrize("kind", queries)
@pytest.mark.parametrize("workers", [None, 2])
def test_what_a_budget_leaves_out_is_open_and_found_later(surfaces, kind, workers):
    make, options, at_once = queries[kind]
    a, b = surfaces
    whole = at_once(a, b)
    assert len(whole) > 20
    threads = morula.Workers(workers) if workers else None
    query = make(**options, budget=1000)
    status = query.run(a, b, threads)
    assert not status.finished and status.box_tests > 0 and len(query.open()) > 0
    found = set(keys(query.pairs()))
    missing = set(keys(whole)) - found
    assert missing and found <= set(keys(whole))
    parts = [(set(of_a.tolist()), set(of_b.tolist())) for of_a, of_b in query.open()]
    for pair_kind, i, j in sorted(missing)[:: max(1, len(missing) // 60)]:
        side_a, side_b = sides[pair_kind]
        of_i, of_j = facets_of(a, side_a, i), facets_of(b, side_b, j)
        assert any(of_i & open_a and of_j & open_b for open_a, open_b in parts)
    calls = 1
    while not status.finished:
        status = query.resume(threads)
        calls += 1
    assert calls > 2 and query.pairs() == whole and query.open() == []
    query.set_budget(None)
    assert query.run(a, b).finished and query.pairs() == whole
    query.set_budget("1s")
    assert query.run(a, b).finished
    with pytest.raises(ValueError, match="budget"):
        query.set_budget(-1)


def test_one_surface_with_itself():
    limb = morula.sample_body("limb", 10)
    surface = morula.SurfaceTree(limb)
    folded = numpy.array(limb.positions)
    folded[:, 0] = numpy.abs(folded[:, 0] - folded[:, 0].mean())
    surface.update(folded)
    whole = morula.surface_crossings(surface)
    query = morula.SurfaceCrossingQuery(budget=1000)
    status = query.run(surface)
    while not status.finished:
        status = query.resume()
    assert query.pairs() == whole and len(whole) > 0
    near = morula.ProximityQuery(distance=0.01)
    assert near.run(surface, surface).finished and near.pairs() == morula.proximity(surface, distance=0.01)
    surface.update(limb.positions)
    assert near.run(surface).finished
    assert numpy.array_equal(near.safe_distances(), morula.safe_distances(surface, distance=0.01))


def test_surfaces_that_follow_bodies(limb, model):
    rng = numpy.random.default_rng(3)
    bodies = [morula.Body(limb, model), morula.Body(limb, model)]
    colliders = [morula.Collider(body) for body in bodies]
    following = [morula.SurfaceTree(limb) for _ in bodies]
    updated = [morula.SurfaceTree(limb) for _ in bodies]
    colliders[1].set_transform((0.02, 0.01, 0.8 * numpy.ptp(limb.positions[:, 2])))
    for frame in range(3):
        for body, collider, surface, other in zip(bodies, colliders, following, updated):
            body.update(limb.positions + rng.uniform(-0.005, 0.005, limb.positions.shape))
            surface.follow(collider)
            assert surface.is_following and not surface.is_step
            other.update(collider.vertices())
        found = morula.surface_crossings(*following)
        assert found == morula.surface_crossings(*updated) and len(found) > 0
        assert morula.proximity(*following, distance=0.01) == morula.proximity(*updated, distance=0.01)
        assert [surface.hash() for surface in following] == [surface.hash() for surface in updated]
    # Positions are kept for as long as the surface reads them.
    query = morula.SurfaceCrossingQuery(budget=64)
    query.run(*following)
    bodies[1].update(numpy.array(limb.positions))
    with pytest.raises(ValueError, match="second surface follows a body that was updated"):
        morula.surface_crossings(*following)
    with pytest.raises(ValueError, match="follow"):
        following[1].hash()
    with pytest.raises(ValueError, match="updated"):
        query.resume()
    following[1].follow(bodies[1])
    assert len(morula.surface_crossings(*following)) > 0
    following[1].update(limb.positions)
    assert not following[1].is_following
    other = morula.sample_body("limb", 10)
    with pytest.raises(ValueError, match="vertex count"):
        following[0].follow(morula.Body(other, morula.build(other, method="octree")))


def test_masks_say_who_meets_whom(surfaces):
    a, b = surfaces
    whole = morula.surface_crossings(a, b)
    of_a = numpy.where(numpy.arange(len(a.facets)) % 2, 1, 2)
    of_b = numpy.full(len(b.facets), 3)
    query = morula.SurfaceCrossingQuery(masks_a=(of_a, of_a), masks_b=(of_b, numpy.ones(len(b.facets), int)))
    query.run(a, b)
    assert keys(query.pairs()) == [pair for pair in keys(whole) if pair[1] % 2] != []
    with pytest.raises(ValueError):
        morula.SurfaceCrossingQuery(masks_a=(of_a[:3], of_a[:3])).run(a, b)
    with pytest.raises(TypeError, match="masks_a"):
        morula.SurfaceCrossingQuery(masks_a=of_a)


def test_steps_and_candidates(surfaces):
    a, b = surfaces
    query = morula.SweptQuery()
    query.run(a, b)
    assert query.collision_free_step() == query.pairs().time.min() < 1
    broad = morula.SweptQuery(candidates_only=True, distance=0.01)
    broad.run(a, b)
    assert set(keys(query.pairs())) <= set(keys(broad.candidates()))
    assert keys(broad.candidates()) == keys(morula.swept_candidates(a, b, distance=0.01))


def test_filters_and_what_is_refused(surfaces):
    a, b = surfaces
    query = morula.ProximityQuery(distance=0.05, accepts=lambda kind, i, j: i == 7)
    query.run(a, b)
    assert set(query.pairs().a.tolist()) <= {7}
    failing = morula.ProximityQuery(distance=0.05, accepts=lambda kind, i, j: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        failing.run(a, b)
    with pytest.raises(ValueError):
        failing.resume()
    for wrong in (dict(distance=-1.0), dict(distance=numpy.nan), dict(distance=1.0, budget=-1)):
        with pytest.raises(ValueError):
            morula.ProximityQuery(**wrong)
    with pytest.raises(ValueError):
        morula.ProximityQuery(distance=1.0).resume()
    limb = morula.sample_body("limb", 8)
    # What is refused leaves the query where it stood, with its surfaces.
    ones = numpy.ones(len(a.facets), int)
    query = morula.ProximityQuery(distance=0.05, budget=10, masks_a=(ones, ones))
    assert not query.run(a, b).finished
    with pytest.raises(ValueError):
        query.run(morula.SurfaceTree(limb), b)
    query.set_budget(None)
    assert query.resume().finished and query.pairs() == morula.proximity(a, b, distance=0.05)
    assert len(query.safe_distances()) == a.vertex_count
    moving = morula.SurfaceTree(limb)
    query = morula.ProximityQuery(distance=0.2, budget=10)
    assert not query.run(moving).finished
    moving.update(limb.positions * 1.1)
    with pytest.raises(ValueError):
        query.resume()
