# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Meshes whose corners are vertices of their own, welded: positions, labels, motions and skins, against NumPy."""

import warnings

import numpy
import pytest

import morula

TETRAHEDRON = numpy.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]], dtype=float)
FACETS = numpy.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


@pytest.fixture
def corners():
    """Three vertices for each facet."""
    return morula.Mesh(TETRAHEDRON[FACETS.ravel()], numpy.arange(12).reshape(4, 3))


def first_of_equals(rows):
    """For each row the first one that is equal to it."""
    return numpy.array([next(w for w in range(v + 1) if numpy.array_equal(rows[w], rows[v])) for v in range(len(rows))])


def test_equal_vertices_become_the_first_one(corners):
    weld = morula.weld_vertices(corners)
    first = first_of_equals(corners.positions)
    assert numpy.array_equal(weld.old_vertex, numpy.unique(first))
    assert numpy.array_equal(weld.old_vertex[weld.new_vertex], first)
    assert weld.merged_count == 8 and weld.kept_apart == 0 and "kept_apart=0" in repr(weld)
    whole = morula.welded(corners, weld)
    assert whole.vertex_count == 4 and morula.inspect(whole).closed
    assert numpy.array_equal(whole.positions[whole.facets], corners.positions[corners.facets])
    moved = numpy.random.default_rng(5).normal(size=(4, 3))[weld.new_vertex]
    assert numpy.array_equal(morula.welded_positions(moved, weld)[weld.new_vertex], moved)


def test_labels_keep_vertices_apart(corners):
    labels = numpy.zeros(12, dtype=numpy.uint32)
    labels[11] = 7
    weld = morula.weld_vertices(corners, labels)
    first = first_of_equals(numpy.column_stack([corners.positions, labels]))
    assert numpy.array_equal(weld.old_vertex[weld.new_vertex], first)
    assert weld.merged_count == 7 and weld.kept_apart == 1
    assert morula.weld_vertices(corners, labels=None) == morula.weld_vertices(corners)


def test_what_does_not_fit_is_refused(corners):
    weld = morula.weld_vertices(corners)
    whole = morula.welded(corners, weld)
    for call in (
        lambda: morula.weld_vertices(corners, [0] * 12),
        lambda: morula.weld_vertices(corners, numpy.zeros(11, dtype=numpy.uint32)),
        lambda: morula.welded(whole, weld),
        lambda: morula.welded_positions(whole.positions, weld),
    ):
        with pytest.raises((ValueError, TypeError)):
            call()
    with pytest.raises(TypeError):
        morula.welded(corners, "weld")


def test_files_are_read_welded_with_motion_and_skin(corners, tmp_path):
    morula.write_mesh(tmp_path / "corners.obj", corners)
    whole, weld = morula.read_welded_mesh(tmp_path / "corners.obj")
    assert weld == morula.weld_vertices(corners) and whole == morula.welded(corners, weld)
    frames = numpy.stack([corners.positions, 3 * corners.positions + 1])
    numpy.save(tmp_path / "moved.npy", frames)
    motion = morula.Motion(tmp_path / "moved.npy", whole, weld=weld)
    for frame, given in enumerate(frames):
        assert numpy.array_equal(motion[frame][weld.new_vertex], given)
    frames[1, 11, 0] += 1e-9
    numpy.save(tmp_path / "torn.npy", frames)
    with pytest.raises(OSError, match="vertices 5 and 11 of the unwelded mesh are merged"):
        morula.Motion(tmp_path / "torn.npy", whole, weld=weld)[1]
    second = corners.positions[:, 0] / 4
    weights = numpy.column_stack([1 - second, second])
    numpy.save(tmp_path / "skin.npy", weights)
    skin = morula.read_skin(tmp_path / "skin.npy", whole, weld)
    assert skin.vertex_count == 4
    modes = numpy.stack([corners.positions, 2 * corners.positions])
    numpy.save(tmp_path / "modes.npy", modes)
    assert numpy.array_equal(
        morula.read_modes(tmp_path / "modes.npy", whole, weld).displacements[:, weld.new_vertex], modes)
    # Arrays of transforms have no morph targets.
    numpy.save(tmp_path / "bones.npy", numpy.tile(numpy.eye(4)[:3], (5, 2, 1, 1)))
    transforms, morphs = morula.read_bone_frames(tmp_path / "bones.npy", 2, 0)
    assert transforms.shape == (5, 2, 3, 4) and morphs.shape == (5, 0)
    assert numpy.array_equal(transforms, morula.read_bone_frames(tmp_path / "bones.npy", 2))
    with pytest.raises(OSError, match="has 0 morph targets, but 2 are needed"):
        morula.read_bone_frames(tmp_path / "bones.npy", 2, 2)
    modes[1, 11] += 1
    numpy.save(tmp_path / "torn_modes.npy", modes)
    with pytest.raises(OSError, match="moves them apart"):
        morula.read_modes(tmp_path / "torn_modes.npy", whole, weld)
    weights[11] = 0.25, 0.75
    numpy.save(tmp_path / "odd.npy", weights)
    with pytest.raises(OSError, match="different weights"):
        morula.read_skin(tmp_path / "odd.npy", whole, weld)


def test_surfaces_count_corners_that_only_touch(corners):
    cut = morula.SurfaceTree(corners)
    whole = morula.SurfaceTree(morula.welded(corners, morula.weld_vertices(corners)))
    assert (cut.duplicate_vertices, whole.duplicate_vertices) == (8, 0)
    with pytest.warns(UserWarning, match="8 vertices at the position of another vertex.*read_welded_mesh"):
        assert len(morula.proximity(cut, distance=0.01)) > 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Once per surface, and not where they are left out, or no pair of one surface is wanted.
        assert len(morula.proximity(cut, distance=0.01)) > 0
        assert len(morula.proximity(whole, distance=0.01)) == 0
        other = morula.SurfaceTree(corners)
        morula.proximity(other, distance=0.01, rest_distance=0.001)
        morula.proximity(other, whole, distance=0.01)
    query = morula.ProximityQuery(distance=0.01)
    with pytest.warns(UserWarning, match="another vertex"):
        query.run(other)


def test_names_say_what_they_do():
    for said in (
        morula.MeshWeld, morula.weld_vertices, morula.welded, morula.welded_positions, morula.read_welded_mesh,
        morula.MeshWeld.new_vertex, morula.MeshWeld.old_vertex, morula.MeshWeld.kept_apart, morula.MeshWeld.merged_count,
        morula.SurfaceTree.duplicate_vertices,
    ):
        assert said.__doc__ and len(said.__doc__) > 30, said
