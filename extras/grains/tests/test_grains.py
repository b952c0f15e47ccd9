# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Clumps: what they promise, by sampling; masses, by formulas and dice."""

import json

import numpy
import pytest
from conftest import covers_by_sampling

import morula


@pytest.fixture(scope="module")
def grain():
    return morula.sample_body("blob", 12)


def test_the_mass_of_a_union_is_that_of_dice():
    spheres = numpy.array([[0, 0, 0, 1.0], [1, 0, 0, 0.8], [0.2, 0.9, 0.1, 0.5], [0.1, 0, 0, 0.2]])
    found = morula.converged_union_mass(spheres)
    points = numpy.random.default_rng(1).uniform([-1, -1, -1], [1.8, 1.4, 1], (400000, 3))
    inside = (numpy.linalg.norm(points[:, None] - spheres[:, :3], axis=2) <= spheres[:, 3]).any(axis=1)
    volume = inside.mean() * 2.8 * 2.4 * 2
    assert abs(found.solid.volume - volume) < 0.01 * volume and found.change <= 1e-4
    kept = points[inside]
    numpy.testing.assert_allclose(found.solid.center, kept.mean(axis=0), atol=0.01)
    about = kept - kept.mean(axis=0)
    tensor = volume * (numpy.eye(3) * (about**2).sum(axis=1).mean() - about.T @ about / len(about))
    xx, xy, xz, yy, yz, zz = found.solid.inertia
    numpy.testing.assert_allclose([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], tensor, atol=0.02 * volume)
    one = morula.union_mass(numpy.array([[3, 2, 1, 2.0]]))
    assert abs(one.volume - 4 / 3 * numpy.pi * 8) < 0.01 * one.volume


def test_a_cover_contains_the_grain_and_inner_spheres_are_in_it(grain):
    cover = morula.fit_clump(grain, spheres=10, density=2500)
    assert cover.kind == "cover" and cover.proven and len(cover) == len(cover.spheres) <= 10
    assert covers_by_sampling(grain, grain.positions, cover.spheres) and cover.uncovered_distance == 0
    assert numpy.isclose(cover.mass, 2500 * cover.solid.volume)
    inner = morula.fit_clump(grain, kind="inner", spheres=20)
    assert inner.kind == "inner" and inner.proven
    distances = morula.SignedDistance(grain)(inner.spheres[:, :3])
    assert (distances <= -inner.spheres[:, 3] + 1e-12).all()
    assert inner.solid.volume < inner.object_volume < cover.solid.volume
    assert morula.fit_clump(grain, spheres=10, density=2500, workers=morula.Workers(2)) == cover
    # Along principal axes the tensor is diagonal.
    xx, xy, xz, yy, yz, zz = cover.solid.inertia
    turn = cover.principal.matrix[:3, :3]
    turned = turn @ [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]] @ turn.T
    numpy.testing.assert_allclose(numpy.diag(turned), cover.principal_inertia, rtol=0.02)
    assert abs(turned - numpy.diag(numpy.diag(turned))).max() < 0.02 * numpy.trace(turned)


def test_a_cover_within_a_tolerance_is_near_every_point_and_thinner(grain):
    tight = morula.fit_clump(grain, spheres=8)
    loose = morula.fit_clump(grain, spheres=8, tolerance=0.05)
    assert tight.within == 0 < loose.within <= 0.05 and loose.proven
    assert loose.uncovered_distance <= loose.within and loose.outside_volume < tight.outside_volume
    corners = grain.positions[grain.facets].mean(axis=1)
    for points in (grain.positions, corners):
        gaps = numpy.linalg.norm(points[:, None] - loose.spheres[:, :3], axis=2) - loose.spheres[:, 3]
        assert gaps.min(axis=1).max() <= loose.within
    assert json.loads(loose.text("json"))["within"] == loose.within == loose.to_dict()["within"]
    for wrong in (-1, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="tolerance"):
            morula.fit_clump(grain, tolerance=wrong)
    with pytest.raises(ValueError, match="tolerance"):
        morula.fit_clump(grain, kind="inner", tolerance=0.1)


def test_inner_balls_are_inside(grain):
    object = morula.SignedDistance(grain)
    balls = morula.inner_ball_candidates(grain, object, candidates=300, margin=0.01)
    assert len(balls) > 20 and (object(balls[:, :3]) + balls[:, 3] <= -0.01 + 1e-9).all()
    few = morula.fullest_balls(balls, 5)
    assert len(few) <= 5 and {tuple(b) for b in few} <= {tuple(b) for b in balls}
    best_one = morula.fullest_balls(balls, 1)
    assert best_one[0, 3] > 0.9 * balls[:, 3].max()


def test_every_format_has_the_spheres(grain):
    clump = morula.fit_clump(grain, spheres=4)
    names = [f.name for f in morula.clump_formats()]
    assert len(names) == len(set(names)) >= 4
    for format in morula.clump_formats():
        text = clump.text(format.name, "pebble")
        assert text == format.text(clump, "pebble") and len(text) > 40 and format.program and format.axes
    with pytest.raises(ValueError, match="format: 'nonsense'.*" + names[0]):
        clump.text("nonsense")


def test_the_command_writes_the_same(grain, command, tmp_path):
    morula.write_mesh(tmp_path / "grain.obj", grain)
    formats = [f for f in morula.clump_formats() if f.extension]
    command("clump", "grain.obj", "--spheres", "6", "--format", formats[0].name, "-o", f"grain{formats[0].extension}")
    clump = morula.fit_clump(morula.read_mesh(tmp_path / "grain.obj"), spheres=6)
    assert (tmp_path / f"grain{formats[0].extension}").read_text() == clump.text(formats[0].name, "grain")


def test_progress_and_what_is_wrong(grain):
    told = []
    clump = morula.fit_clump(grain, spheres=6, progress=lambda p: told.append(p.share))
    assert told == sorted(told) and told[-1] == 1

    def stop(progress):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        morula.fit_clump(grain, spheres=6, progress=stop)
    with pytest.raises(ValueError, match="kind"):
        morula.fit_clump(grain, kind="outer")
    with pytest.raises(ValueError):
        morula.fit_clump(grain, density=-1)
    assert json.dumps(clump.to_dict()["notes"]) and "Clump(" in repr(clump)
