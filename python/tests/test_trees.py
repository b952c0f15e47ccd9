# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Building, trees, covers, files: the same bits as the command's."""

import copy
import pickle

import numpy
import pytest

import morula
from conftest import covers_by_sampling


@pytest.mark.parametrize(
    "options, arguments",
    [
        ({"method": "grid", "depth": 2}, ["--method", "grid", "--depth", "2"]),
        ({"method": "octree", "branching": 4, "depth": 3}, ["--method", "octree", "--branching", "4", "--depth", "3"]),
        ({"quality": "fast", "depth": 2, "nested": True}, ["--quality", "fast", "--depth", "2", "--nested"]),
        ({"spheres": 20, "quality": "fast"}, ["--spheres", "20", "--quality", "fast"]),
    ],
)
def test_trees_are_those_of_the_command(command, tmp_path, options, arguments):
    command("sample", "limb", "--resolution", "16", "-o", "limb.obj")
    command("build", "limb.obj", "-o", "theirs.morula", *arguments)
    mesh = morula.read_mesh(tmp_path / "limb.obj")
    model = morula.build(mesh, **options)
    morula.write_tree(tmp_path / "ours.morula", model)
    assert (tmp_path / "ours.morula").read_bytes() == (tmp_path / "theirs.morula").read_bytes()
    assert morula.read_covered_tree(tmp_path / "theirs.morula", mesh) == model


def test_workers_change_no_bit(limb, model):
    assert morula.build(limb, method="grid", depth=2, workers=morula.Workers(2)) == model


def test_every_level_covers(limb, model):
    assert model.validate(limb) == []
    for level in range(model.level_count):
        assert covers_by_sampling(limb, limb.positions, model.level(level))


def test_arrays_of_a_tree_agree(model):
    tree = model.tree
    assert tree.spheres.shape == (len(tree), 4) and tree.level_begin[-1] == len(tree)
    inner = tree.child_count > 0
    assert (tree.parent[tree.first_child[inner]] == numpy.flatnonzero(inner)).all()
    assert tree.leaf_count == (~inner).sum() and tree.parent[0] == morula.no_node
    assert numpy.array_equal(tree.level(1), tree.spheres[tree.level_set(1)])
    assert tree.is_leaf(len(tree) - 1) and tree.level_of(0) == 0
    with pytest.raises(IndexError):
        tree.is_leaf(len(tree))
    with pytest.raises(ValueError):
        tree.level_set(9)


def test_views_of_a_tree_outlive_it(limb):
    spheres = morula.build(limb, method="octree", depth=1).tree.spheres
    patches = morula.build(limb, method="octree", depth=1).cover.patch_facet
    assert (spheres[:, 3] > 0).all() and patches.max() < limb.facet_count


def test_pickle_copy_and_equality(model, limb):
    for value in (model, model.tree, model.cover, model.report):
        again = pickle.loads(pickle.dumps(value))
        assert again == value and type(again) is type(value)
    assert copy.deepcopy(model) == model and copy.copy(model.tree) == model.tree
    other = morula.build(limb, method="octree", depth=2)
    assert other != model and model.tree != other.tree and model.cover != other.cover
    body = morula.Body(limb, pickle.loads(pickle.dumps(model)))
    assert body.hash() == morula.Body(limb, model).hash()


def test_what_is_no_tree_is_refused(model):
    tree = model.tree
    arrays = [tree.spheres, tree.first_child, tree.child_count, tree.parent, tree.level_begin]
    assert morula.SphereTree(*arrays, branching=tree.branching) == tree
    broken = numpy.array(tree.parent)
    broken[-1] = 0
    with pytest.raises(ValueError):
        morula.SphereTree(*arrays[:3], broken, arrays[4], branching=tree.branching)
    with pytest.raises(ValueError, match="spheres"):
        morula.SphereTree(tree.spheres[:, :3], *arrays[1:])


def test_options_that_there_are_not_are_refused(limb):
    with pytest.raises(ValueError, match="method: 'grit', but there are only octree, grid"):
        morula.build(limb, method="grit")
    with pytest.raises(ValueError):
        morula.build(limb, branching=1)
    with pytest.raises(TypeError):
        morula.build(limb, dept=2)
    with pytest.raises(ValueError, match="reducers: 'x'"):
        morula.build(limb, method="medial", reducers=["x"])


def test_progress_goes_up_to_one_and_may_end_the_build(limb):
    shares = []
    morula.build(limb, quality="fast", progress=lambda progress: shares.append(progress.share))
    assert shares == sorted(shares) and shares[-1] == 1.0

    class Enough(Exception):
        pass

    def stop(progress):
        raise Enough

    with pytest.raises(Enough):
        morula.build(limb, quality="fast", progress=stop)


def test_imported_spheres_are_made_to_cover(limb, model):
    shrunk = numpy.array(model.tree.spheres)
    shrunk[:, 3] *= 0.8
    tree = model.tree
    bare = morula.SphereTree(shrunk, tree.first_child, tree.child_count, tree.parent, tree.level_begin, tree.branching)
    again = morula.cover(limb, bare)
    assert again.report.method == "imported" and again.validate(limb) == []
    assert morula.certify(again.cover, limb.positions, again.spheres)
    assert not morula.certify(model.cover, limb.positions, shrunk)
    nested = morula.make_nested(model.tree)
    assert morula.certify_nesting(nested).nested and nested.nested


def test_files_round_trip(tmp_path, limb, model, motion):
    morula.write_tree(tmp_path / "tree.sph", model.tree)
    assert morula.read_tree(tmp_path / "tree.sph").cover is None
    moved = morula.Body(limb, model).follow(motion)
    morula.write_sphere_frames(tmp_path / "spheres.npz", model.tree, moved)
    assert numpy.array_equal(morula.read_sphere_frames(tmp_path / "spheres.npz").spheres, moved)
    assert numpy.array_equal(numpy.load(tmp_path / "spheres.npz")["spheres"], moved)
    morula.write_motion(tmp_path / "motion.npy", limb, motion)
    assert numpy.array_equal(morula.read_motion(tmp_path / "motion.npy", limb), motion)
    morula.write_mesh(tmp_path / "bent.ply", limb, motion[4])
    assert numpy.array_equal(morula.read_mesh(tmp_path / "bent.ply").positions, motion[4])
    with pytest.raises(OSError, match="nowhere.obj"):
        morula.read_mesh(tmp_path / "nowhere.obj")
    with pytest.raises(OSError, match="limb.txt"):
        morula.write_mesh(tmp_path / "limb.txt", limb)


def test_a_tree_shows_itself_in_a_notebook(model):
    shown = model._repr_html_()
    assert shown.count("<circle") == sum(len(model.level(level)) for level in range(model.level_count))
    assert "<table>" in shown and "grid" in shown
