# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Whatever is wrong with a call, the message is in Python's words: function, argument, what was given, what is taken."""

import copy
import errno
import os
import pickle
import subprocess
import sys

import numpy
import pytest

import morula


@pytest.fixture(scope="module")
def body():
    mesh = morula.sample_body("limb", 12)
    return morula.Body(mesh, morula.build(mesh, method="octree", depth=1))


def message(function, *given, error=TypeError, **named):
    with pytest.raises(error) as caught:
        function(*given, **named)
    return str(caught.value)


def test_the_argument_is_named(body):
    mesh = body.mesh
    said = message(body.update, None)
    assert said.startswith("Body.update(): positions: None, but an array of float32 or float64 is needed")
    assert "It takes (positions: FloatArray" in said
    said = message(morula.build, mesh, workers=2)
    assert said.startswith("build(): workers: 2, but Workers, such as morula.Workers(2), or None is needed")
    said = message(morula.build, mesh, metod="grid")
    assert said.startswith("build(): there is no argument 'metod', but there is 'method'")
    assert message(morula.build).startswith("build(): mesh is missing")
    assert "depth: 'deep', but an integer, or None is needed" in message(morula.build, mesh, depth="deep")
    assert "method: 3, but one of octree, " in message(morula.build, mesh, method=3)
    assert "at most 1 may have none" in message(morula.build, mesh, "grid")
    assert message(morula.Collider(body).set_transform, "there").startswith("Collider.set_transform(): transform: ")
    assert "seed: -1 is out of range" in message(morula.build, mesh, seed=-1)
    assert message(morula.Body, mesh).startswith("Body(): model is missing")
    # Where several are wrong, all are told.
    said = message(morula.build, mesh, depth="deep", seed="x")
    assert "depth: 'deep'" in said and "seed: 'x'" in said


def test_errors_of_callbacks_are_theirs(body):
    surface = morula.SurfaceTree(body.mesh)
    with pytest.raises(TypeError, match="^mine$"):
        morula.proximity(surface, distance=0.1, accepts=lambda *pair: (_ for _ in ()).throw(TypeError("mine")))
    assert "accepts: an object of type int, but None" in message(morula.proximity, surface, distance=0.1, accepts=3)


def test_rows_are_counted(body):
    count = body.vertex_count
    short = body.mesh.positions[1:]
    wanted = f"positions: {count} × 3 expected (the body's vertices), {count - 1} × 3 given"
    assert message(body.update, short, error=ValueError) == wanted
    large = morula.sample_body("limb", 24)
    large = morula.Body(large, morula.build(large, method="octree", depth=1))
    thousands = f"{large.vertex_count:,}"
    said = message(large.update, large.mesh.positions[1:], error=ValueError)
    assert said == f"positions: {thousands} × 3 expected (the body's vertices), {large.vertex_count - 1:,} × 3 given"
    assert "," in thousands or large.vertex_count < 1000
    assert "frames: " in message(body.follow, short[None], error=ValueError)


def test_tensors_that_need_a_gradient_are_told_the_way(body):
    class Tensor:
        requires_grad = True

        def __dlpack__(self, **options):
            raise BufferError("Can't export tensors that require gradient, use tensor.detach()")

        def __dlpack_device__(self):
            return (1, 0)

    assert "positions.detach()" in message(body.update, Tensor())


def test_spheres_are_exchanged_by_dlpack(body):
    rows = numpy.from_dlpack(body.spheres)
    assert (rows == numpy.asarray(body.spheres)).all() and rows.dtype == numpy.float32
    before = rows.copy()
    body.update(body.mesh.positions * 2)
    assert (rows == before).all()
    rows[:] = 0
    assert (numpy.asarray(body.spheres) != 0).any()
    stale = body.spheres
    body.update(body.mesh.positions)
    with pytest.raises(RuntimeError, match="older frame"):
        numpy.from_dlpack(stale)


def test_copies_are_writable(body):
    for rows in (body.copy_spheres(), body.follow(body.mesh.positions[None]), morula.deform(body.mesh, morula.Bend(10)),
                 numpy.array(body.spheres), morula.Collider(body).vertices()):
        assert rows.flags.writeable
        rows[:] = 0
    for rows in (body.mesh.positions, body.rest_tree.spheres):
        assert not rows.flags.writeable


def test_bodies_are_copied(body):
    for copied in (copy.copy(body), copy.deepcopy(body), copy.deepcopy({"a": [body]})["a"][0]):
        moved = copied.mesh.positions * 1.5
        at_rest = body.copy_spheres()
        assert copied.update(moved) and bool(copied.certify(moved))
        assert (body.copy_spheres() == at_rest).all()
        del moved


def test_a_copy_keeps_the_positions_that_it_borrows(body):
    mesh = body.mesh
    one = morula.Body(mesh, morula.build(mesh, method="octree", depth=1))
    one.update(numpy.array(mesh.positions) * 1.25)
    other = copy.copy(one)
    one.update(mesh.positions)
    numpy.zeros((500, 3)), numpy.zeros((1000, 3))
    del one
    assert (morula.Collider(other).vertices() == numpy.array(mesh.positions) * 1.25).all()


def test_placements_are_matrices_of_any_precision(body):
    angle = 0.3
    matrix = numpy.array([[numpy.cos(angle), -numpy.sin(angle), 0, 0.1], [numpy.sin(angle), numpy.cos(angle), 0, 0.2],
                          [0, 0, 1, 0.3], [0, 0, 0, 1]])
    collider = morula.Collider(body)
    for given in (matrix, matrix[:3], morula.RigidTransform(matrix)):
        collider.set_transform(given)
        assert (collider.transform.matrix == matrix).all()
    collider.set_transform(matrix.astype(numpy.float32))
    assert morula.deviation_from_rigid(collider.transform) < 1e-15
    assert numpy.abs(collider.transform.matrix - matrix).max() < 1e-7
    collider.set_transform((1, 2, 3))
    assert collider.transform.translation == (1, 2, 3)
    assert "transform.T" in message(collider.set_transform, matrix.T, error=ValueError)
    assert "not finite" in message(collider.set_transform, numpy.full((4, 4), numpy.nan), error=ValueError)
    bent = matrix.copy()
    bent[0, 0] *= 1.001
    said = message(collider.set_transform, bent, error=ValueError)
    assert "0.000000" not in said and "deviate by 0.00" in said
    assert collider.transform.translation == (1, 2, 3)


def test_tables_are_iterable(body):
    other = morula.Collider(body)
    other.set_transform((0.01, 0, 0))
    contacts = morula.collide(body, other)
    assert len(contacts) > 0
    rows = list(contacts)
    assert [row["node_a"] for row in rows] == list(contacts.node_a) and [row["depth"] for row in rows] == list(contacts.depth)
    pairs = morula.proximity(morula.SurfaceTree(body.mesh), distance=0.05)
    assert [row["a"] for row in pairs] == list(pairs.a)
    assert list(morula.proximity(morula.SurfaceTree(body.mesh), distance=1e-12)) == []


def test_files_that_are_not_there_are_of_their_kind(tmp_path):
    for read in (morula.read_mesh, morula.read_tree):
        path = tmp_path / ("nowhere.obj" if read is morula.read_mesh else "nowhere.sph")
        with pytest.raises(FileNotFoundError) as caught:
            read(path)
        assert (caught.value.filename, caught.value.errno) == (str(path), errno.ENOENT)
        assert str(path) in str(caught.value) and "check the name" in str(caught.value)
    folder = tmp_path / "folder.obj"
    folder.mkdir()
    with pytest.raises(IsADirectoryError):
        morula.read_mesh(folder)
    with pytest.raises(FileNotFoundError):
        morula.write_mesh(tmp_path / "no" / "x.obj", morula.sample_body("limb", 8))
    bad = tmp_path / "bad.obj"
    bad.write_text("v 1 2\n")
    with pytest.raises(OSError, match=r"bad\.obj:1") as caught:
        morula.read_mesh(bad)
    assert type(caught.value) is OSError
    again = pickle.loads(pickle.dumps(FileNotFoundError(errno.ENOENT, "x", "y")))
    assert again.filename == "y"


def test_files_whose_names_are_not_utf8_are_told_as_others_are(tmp_path):
    folder = tmp_path / os.fsdecode(b"n\xff")
    folder.mkdir()
    missing = folder / "missing.obj"
    for path in (missing, str(missing), os.fsencode(missing)):
        with pytest.raises(FileNotFoundError) as caught:
            morula.read_mesh(path)
        assert (caught.value.filename, caught.value.errno) == (str(missing), errno.ENOENT)
    bad = folder / "bad.obj"
    bad.write_text("v 1 2\n")
    with pytest.raises(OSError) as caught:
        morula.read_mesh(bad)
    assert str(caught.value).startswith(f"{bad}:1: ")
    with pytest.raises(OSError) as caught:
        morula.read_tree(folder / "tree.txt")
    assert str(caught.value).startswith(f"{folder / 'tree.txt'}: ")
    noted = folder / "noted.obj"
    noted.write_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n\xe9tat 1\n")
    with pytest.warns(UserWarning) as told:
        assert morula.read_mesh(noted).facet_count == 1
    assert str(told[0].message).startswith(f"{noted}: ")


def test_programs_that_end_with_all_they_have_made_print_nothing():
    program = """
import morula
mesh = morula.sample_body("blob", 6)
body = morula.Body(mesh, morula.build(mesh, method="octree", depth=1))
body.update(mesh.positions)
surface = morula.SurfaceTree(mesh)
surface.update(mesh.positions)
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    assert run.stdout == run.stderr == b""


def test_choices_of_type_checkers_are_those_of_the_library():
    choices = morula._morula._choices
    assert choices["Method"] == morula.all_methods() and choices["Quality"] == morula.all_qualities()
    assert choices["Rule"] == morula.all_rules() and choices["Reduction"] == morula.all_reductions()
    assert choices["Optimizer"] == morula.all_optimizers()
    if hasattr(morula, "clump_formats"):
        assert choices["ClumpFormatName"] == [written.name for written in morula.clump_formats()]
    assert set(choices) <= set(morula.typing.__all__)
    # Each is what its argument takes, and no more.
    arguments = {
        "Axis": lambda axis: morula.Bend(90, axis), "SignMethod": lambda name: morula.SignedDistance(morula.sample_body("limb", 8), name),
        "Priority": lambda name: morula.ContactQuery(priority=name), "Features": lambda name: morula.ObstacleQuery(features=name),
    }
    for kind, make in arguments.items():
        for word in choices[kind]:
            make(word)
        said = message(make, "nothing", error=ValueError)
        assert "there are only " + ", ".join(choices[kind]) in said
