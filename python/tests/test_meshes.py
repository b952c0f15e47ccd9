# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Meshes: what comes in, and what is refused with which words."""

import copy
import pickle

import numpy
import pytest

import morula


def test_positions_and_facets_come_back_as_they_were(limb):
    positions, facets = numpy.array(limb.positions), numpy.array(limb.facets)
    for dtype in (numpy.int8, numpy.int16, numpy.int32, numpy.int64, numpy.uint16, numpy.uint32, numpy.uint64):
        if numpy.iinfo(dtype).max < facets.max():
            continue
        mesh = morula.Mesh(positions, facets.astype(dtype))
        assert numpy.array_equal(mesh.facets, facets) and numpy.array_equal(mesh.positions, positions)
    assert mesh == limb and hash(mesh) == hash(limb) and mesh.hash() == morula.mesh_hash(limb)
    assert mesh.facets.dtype == numpy.uint32 and mesh.positions.dtype == numpy.float64


def test_any_layout_gives_the_same_mesh(limb):
    positions = numpy.array(limb.positions)
    wide = numpy.zeros((len(positions), 7))
    wide[:, 2:5] = positions
    for same in (numpy.asfortranarray(positions), wide[:, 2:5], positions[::-1][::-1]):
        assert morula.Mesh(same, limb.facets) == limb
    single = positions.astype(numpy.float32)
    assert numpy.array_equal(morula.Mesh(single, limb.facets).positions, single.astype(float))


def test_views_keep_their_mesh_and_cannot_be_written(limb):
    positions = morula.sample_body("bar", 12).positions
    assert numpy.isfinite(positions).all() and positions.shape[1] == 3
    with pytest.raises(ValueError):
        positions[0, 0] = 1.0
    # The same memory, not a copy.
    assert numpy.shares_memory(limb.positions, limb.vertices)


@pytest.mark.parametrize(
    "positions, facets, error, words",
    [
        ([[0, 0, 0]], numpy.zeros((1, 3), int), TypeError, ["positions", "list", "numpy.asarray(positions)"]),
        (numpy.zeros((4, 3), int), numpy.zeros((1, 3), int), ValueError, ["positions", "int64", "(4, 3)", "astype(float)"]),
        (numpy.zeros((4, 2)), numpy.zeros((1, 3), int), ValueError, ["positions", "(4, 2)"]),
        (numpy.zeros((4, 3), numpy.float16), numpy.zeros((1, 3), int), ValueError, ["positions", "float16"]),
        (numpy.zeros((4, 3)), numpy.zeros((1, 3)), ValueError, ["facets", "float64", "astype(numpy.uint32)"]),
        (numpy.zeros((4, 3)), numpy.zeros((1, 4), int), ValueError, ["facets", "(1, 4)", "quadrangles"]),
        (numpy.zeros((4, 3)), numpy.array([3, 0, 1, 2]), ValueError, ["facets", "(4,)", "reshape(-1, 4)[:, 1:]"]),
        (numpy.zeros((4, 3)), numpy.array([[0, 1, -1]]), ValueError, ["facets", "row 0", "-1"]),
        (numpy.zeros((4, 3)), numpy.array([[0, 1, 4]]), ValueError, ["4"]),
        (numpy.full((4, 3), numpy.nan), numpy.array([[0, 1, 2]]), ValueError, ["0"]),
        (None, numpy.zeros((1, 3), int), TypeError, ["positions", "None"]),
    ],
)
def test_what_is_no_mesh_is_refused_by_name_shape_type_and_remedy(positions, facets, error, words):
    with pytest.raises(error) as refusal:
        morula.Mesh(positions, facets)
    assert all(word in str(refusal.value) for word in words), str(refusal.value)


def test_what_has_vertices_and_faces_is_a_mesh(limb):
    class Other:
        vertices, faces = limb.positions, limb.facets.astype(numpy.int64)

    assert morula.Mesh.of(Other()) == limb
    assert morula.Mesh.of((limb.positions, limb.facets)) == limb
    assert morula.inspect(Other()).closed
    with pytest.raises(TypeError, match="mesh: an object of type dict"):
        morula.inspect({})


def test_pickle_and_copy(limb):
    assert pickle.loads(pickle.dumps(limb)) == limb
    assert copy.copy(limb) == limb and copy.deepcopy(limb) == limb
    assert limb != morula.sample_body("bar", 12) and limb != 3


def test_reports_are_records():
    report = morula.inspect(morula.sample_body("torus", 24))
    as_dict = report.to_dict()
    assert as_dict["closed"] is True and as_dict["component_count"] == 1
    # Pappus: a torus of radii 1 and 0.35.
    assert abs(report.volume - 2 * numpy.pi**2 * 0.35**2) < 0.05 * report.volume
    assert "component_count=1" in repr(report) and report == morula.inspect(morula.sample_body("torus", 24))


def test_repair_closes_and_turns():
    bar = morula.sample_body("bar", 4)
    facets = numpy.array(bar.facets)
    facets[3] = facets[3][::-1]
    mended, report = morula.repair((bar.positions, facets))
    assert report.turned_facets == 1 and morula.inspect(mended).oriented


def test_enclosing_sphere_contains_and_touches():
    points = numpy.random.default_rng(3).normal(size=(500, 3))
    x, y, z, radius = morula.enclosing_sphere(points)
    distances = numpy.linalg.norm(points - [x, y, z], axis=1)
    assert distances.max() <= radius * (1 + 1e-12) and (distances > radius * (1 - 1e-9)).sum() >= 2


def test_transforms_are_matrices():
    turn = morula.RigidTransform.from_axis((0, 0, 1), numpy.pi / 2, translation=(1, 2, 3))
    assert numpy.allclose(turn((1, 0, 0)), (1, 3, 3))
    assert numpy.allclose(turn.matrix @ [1, 0, 0, 1], [1, 3, 3, 1])
    assert morula.RigidTransform(turn.matrix) == turn and pickle.loads(pickle.dumps(turn)) == turn
    assert numpy.allclose((turn.inverse().matrix @ turn.matrix), numpy.eye(4))


def test_deformations_say_what_they_are():
    stretch, poke, noise = morula.Stretch(3, shrink=0.25, axis="y"), morula.Poke(radius=0.5), morula.Noise(0.1, 0.5, seed=7)
    assert (stretch.factor, stretch.shrink, stretch.axis) == (3, 0.25, "y")
    assert [(kind(30).degrees, kind(30).axis) for kind in (morula.Bend, morula.Twist, morula.Rotate)] == [(30, "automatic")] * 3
    assert (poke.center, poke.push, poke.radius) == ((0.5, 0.5, 1), (0, 0, -0.15), 0.5)
    assert (noise.amplitude, noise.wavelength, noise.seed) == (0.1, 0.5, 7)
