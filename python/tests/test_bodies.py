# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Bodies: the same bits as the command's, views and their frames, threads, Ctrl-C."""

import copy
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy
import pytest

import morula
from conftest import covers_by_sampling


@pytest.mark.parametrize("rule", ["traditional", "weighted", "approach1", "approach2", "exact", "wrapped"])
def test_spheres_are_those_of_the_command(command, tmp_path, rule):
    command("sample", "limb", "--resolution", "12", "-o", "limb.obj")
    command("build", "limb.obj", "-o", "limb.morula", "--method", "grid", "--depth", "2")
    command("deform", "limb.obj", "-o", "motion.npy", "--bend", "90", "--frames", "5")
    command("update", "limb.obj", "limb.morula", "motion.npy", "-o", "theirs.npz", "--rule", rule)
    mesh = morula.read_mesh(tmp_path / "limb.obj")
    body = morula.Body(mesh, morula.read_covered_tree(tmp_path / "limb.morula", mesh), rules=rule)
    frames = morula.deform_frames(mesh, morula.Bend(90), frame_count=5)
    assert numpy.array_equal(frames, numpy.load(tmp_path / "motion.npy"))
    assert numpy.array_equal(body.follow(frames), numpy.load(tmp_path / "theirs.npz")["spheres"])


def test_a_motion_in_one_call_is_one_update_after_the_other(limb, model, motion):
    one, all_at_once = morula.Body(limb, model), morula.Body(limb, model)
    moved = all_at_once.follow(motion[:5])
    for positions, spheres in zip(motion[:5], moved):
        one.update(positions)
        assert numpy.array_equal(one.copy_spheres(), spheres)
        assert covers_by_sampling(limb, positions, spheres[model.tree.level_set(2)])
        assert one.certify(positions)
    assert all_at_once.hash() == one.hash() and all_at_once.frame == one.frame == 5


def test_layouts_and_types_give_the_same_spheres(limb, model, motion):
    body = morula.Body(limb, model)
    positions = motion[3].astype(numpy.float32)
    body.update(positions)
    expected = body.hash()
    records = numpy.zeros(len(positions), dtype=[("mass", "f4"), ("x", "f4", 3), ("v", "f4", 3)])
    records["x"] = positions
    wide = numpy.zeros((len(positions), 5))
    wide[:, 1:4] = positions
    for same in (positions.astype(float), numpy.asfortranarray(positions), records["x"], wide[:, 1:4], positions[:, ::-1][:, ::-1]):
        body.update(limb.positions)
        body.update(same)
        assert body.hash() == expected
    frames = motion.astype(numpy.float32)
    for same in (frames, numpy.asfortranarray(frames), frames.astype(float), frames[::-1][::-1]):
        assert numpy.array_equal(body.follow(same), morula.Body(limb, model).follow(frames))


def test_back_at_rest_the_spheres_are_those_of_rest(limb, model, motion):
    body = morula.Body(limb, model)
    rest = body.hash()
    body.update(motion[4])
    assert body.hash() != rest
    body.update(limb.positions)
    assert body.hash() == rest


def test_what_is_refused_changes_nothing(limb, model, motion):
    body = morula.Body(limb, model)
    body.update(motion[2])
    before = body.hash()
    broken = numpy.array(motion[3])
    broken[7, 1] = numpy.nan
    with pytest.raises(ValueError, match="7"):
        body.update(broken)
    assert not body.is_current
    with pytest.raises(ValueError):
        body.update(motion[3][:-1])
    with pytest.raises(ValueError, match=r"positions: an array of float64, shape \(.*, 2\)"):
        body.update(motion[3][:, :2])
    with pytest.raises(ValueError, match="frame 1"):
        body.follow(numpy.stack([motion[2], broken]))
    assert body.hash() == before
    body.update(motion[3])
    assert body.is_current


def test_a_view_knows_its_frame(limb, model, motion):
    body = morula.Body(limb, model)
    body.update(motion[1])
    view = body.spheres
    copied = numpy.array(view)
    assert copied.shape == view.shape == (len(model), 4) and copied.dtype == numpy.float32
    assert numpy.allclose(copied[:, :3] + view.origin, body.copy_spheres()[:, :3])
    assert numpy.array_equal(view[3], copied[3]) and len(view) == len(copied) and view.is_current
    assert numpy.shares_memory(view.memory, body.spheres.memory)
    body.update(motion[2])
    assert not view.is_current and "no longer current" in repr(view)
    for read in (lambda: numpy.asarray(view), lambda: view[0], lambda: view.origin, lambda: view.memory):
        with pytest.raises(RuntimeError, match="older frame"):
            read()
    # Copies stay.
    assert (copied[:, 3] > 0).all()


def test_a_view_keeps_its_body(limb, model, motion):
    view = morula.Body(limb, model).spheres
    memory = morula.Body(limb, model).spheres.memory
    assert numpy.array_equal(numpy.asarray(view), memory)


def test_only_what_moved(limb, model):
    body, whole = morula.Body(limb, model), morula.Body(limb, model)
    positions = numpy.array(limb.positions)
    body.update(positions)
    positions[10:20] += 0.01
    part = body.update(positions, changed=[(10, 20)])
    full = whole.update(positions)
    assert body.hash() == whole.hash() and part.vertices_read < full.vertices_read


def test_modes_and_bones(limb, model):
    modes = morula.sample_modes(limb.positions)
    coordinates = morula.sample_coordinates(modes.mode_count, 6)
    body = morula.Body(limb, model, rules="modal", modes=modes)
    same = morula.Body(limb, model, rules=["modal"], modes=modes.displacements)
    moved = body.follow_modal(coordinates)
    for q, spheres in zip(coordinates, moved):
        same.update_modal(q)
        assert numpy.array_equal(same.copy_spheres(), spheres)
        assert same.certify(morula.move_by_modes(modes, limb.positions, q))
    # The formula, written again.
    by_hand = limb.positions + numpy.einsum("j,jvd->vd", coordinates[3], modes.displacements)
    assert numpy.allclose(morula.move_by_modes(modes, limb.positions, coordinates[3]), by_hand)
    with pytest.raises(ValueError):
        body.update(limb.positions)

    skin = morula.sample_skin(limb.positions)
    bones = morula.sample_bones(limb.positions, 5)
    skinned = morula.Body(limb, model, rules="exact", skin=skin)
    follower = morula.Body(limb, model)
    for transforms in bones:
        skinned.update_skinned(transforms)
        follower.update(morula.move_by_skin(skin, limb.positions, transforms))
        assert skinned.hash() == follower.hash()


def test_nodes_that_bend_most_are_measured_within_a_budget(limb, model):
    skin = morula.sample_skin(limb.positions)
    training, motion = morula.sample_bones(limb.positions, 9), morula.sample_bones(limb.positions, 12)
    options = dict(rules="skinned", skin=skin)
    alone = morula.Body(limb, model, **options)
    body = morula.Body(limb, model, skinned_measured=0.3, training=training, **options)
    assert alone.bind_report.nodes_measured == 0 < body.bind_report.nodes_measured
    for transforms in motion:
        alone.update_skinned(transforms)
        assert body.update_skinned(transforms).vertices_read < limb.vertex_count
        assert (body.copy_spheres()[:, 3] <= alone.copy_spheres()[:, 3]).all()
        positions = morula.move_by_skin(skin, limb.positions, transforms)
        assert morula.certify(body.cover, positions, body.copy_spheres())
    rows = numpy.concatenate([training, numpy.broadcast_to([0, 0, 0, 1.0], training.shape[:2] + (1, 4))], axis=2)
    again = morula.Body(limb, model, skinned_measured=0.3, training=rows, **options)
    again.update_skinned(transforms)
    assert again.hash() == body.hash()
    with pytest.raises(ValueError, match=r"training: .*\(frames, 2, 3, 4\)"):
        morula.Body(limb, model, skinned_measured=0.3, training=training[:, :1], **options)
    with pytest.raises(ValueError, match="needs poses"):
        morula.Body(limb, model, skinned_measured=0.3, **options)
    with pytest.raises(ValueError, match="skinned_measured"):
        morula.Body(limb, model, skinned_measured=1.5, training=training, **options)


def test_morph_targets_move_vertices_before_the_bones_do(limb, model):
    modes, skin = morula.sample_modes(limb.positions, 3), morula.sample_skin(limb.positions)
    bones, morphs = morula.sample_bones(limb.positions, 5)[3], numpy.array([0.4, 0.0, -0.2])
    moved = morula.move_by_skin(skin, limb.positions, bones, modes, morphs)
    morphed = morula.move_by_modes(modes, limb.positions, morphs)
    assert numpy.array_equal(moved, morula.move_by_skin(skin, morphed, bones))
    for rules in ("exact", "skinned"):
        body = morula.Body(limb, model, rules=rules, modes=modes, skin=skin)
        rest = body.hash()
        body.update_skinned(bones, morphs)
        assert body.certify(moved)
        body.update_skinned(bones)
        assert body.certify(morula.move_by_skin(skin, limb.positions, bones))
        body.update_skinned(bones, morphs=numpy.zeros(3))
        assert body.certify(morula.move_by_skin(skin, limb.positions, bones))
        body.update_skinned(numpy.tile(numpy.eye(4), (skin.bone_count, 1, 1)), numpy.zeros(3))
        assert body.hash() == rest
        with pytest.raises(ValueError):
            body.update_skinned(bones, numpy.array([0.1]))
    with pytest.raises(ValueError, match="belong together"):
        morula.move_by_skin(skin, limb.positions, bones, modes)


def test_a_bone_takes_the_weight_that_is_missing(limb, model):
    weights = numpy.random.default_rng(1).uniform(0, 0.6, (limb.vertex_count, 3))
    loose = morula.Skin(weights)
    with pytest.raises(ValueError):
        morula.Body(limb, model, rules="skinned", skin=loose)
    skin = morula.complete_weights(loose)
    assert skin.bone_count == 4
    transforms = numpy.random.default_rng(2).normal(size=(4, 3, 4))
    transforms[3] = 0  # as libigl blends
    homogeneous = numpy.column_stack([limb.positions, numpy.ones(limb.vertex_count)])
    expected = numpy.einsum("vb,bij,vj->vi", weights, transforms[:3], homogeneous)
    moved = morula.move_by_skin(skin, limb.positions, transforms)
    assert numpy.allclose(moved, expected, atol=1e-12)
    body = morula.Body(limb, model, rules="skinned", skin=skin)
    body.update_skinned(transforms)
    assert body.certify(moved)
    with pytest.raises(ValueError, match="tolerance"):
        morula.complete_weights(loose, tolerance=1)
def test_bounds_of_skinned_clusters_contain_their_vertices(limb):
    skin = morula.sample_skin(limb.positions)
    bones = morula.sample_bones(limb.positions, 5)
    clusters = numpy.arange(len(limb.facets)) // 64
    bounds = morula.SkinBounds(limb, skin, clusters)
    spheres, boxes, whole_spheres, whole_boxes = bounds.bounds(bones)
    assert spheres.shape == (5, bounds.cluster_count, 4) and boxes.shape == (5, bounds.cluster_count, 2, 3)
    assert bounds.clusters.shape == (bounds.cluster_count, 12) and bounds.rows.shape[1] == 8
    for frame, transforms in enumerate(bones):
        positions = morula.move_by_skin(skin, limb.positions, transforms)
        for cluster in range(bounds.cluster_count):
            points = positions[numpy.unique(limb.facets[clusters == cluster])]
            sphere, box = spheres[frame, cluster].astype(float), boxes[frame, cluster]
            assert (numpy.linalg.norm(points - sphere[:3], axis=1) <= sphere[3]).all()
            assert (points >= box[0]).all() and (points <= box[1]).all()
        assert (positions >= whole_boxes[frame, 0]).all() and (positions <= whole_boxes[frame, 1]).all()
        whole = whole_spheres[frame].astype(float)
        assert (numpy.linalg.norm(positions - whole[:3], axis=1) <= whole[3]).all()
        assert numpy.array_equal(bounds.bounds(transforms)[0][0], spheres[frame])
    assert bounds.target_count == 0 and bounds.targets.shape == (0, 8) and len(bounds.target_begin) == 0
    with pytest.raises(ValueError):
        bounds.bounds(numpy.full((2, 3, 4), numpy.nan))
    with pytest.raises(ValueError):
        bounds.bounds(bones[0, :1])
    assert morula.clusters_of_runs(numpy.array([0, 2, 3])).tolist() == [0, 0, 1]


def test_bounds_of_clusters_contain_vertices_that_morph_targets_displace(limb):
    skin = morula.sample_skin(limb.positions)
    bones = morula.sample_bones(limb.positions, 4)
    modes = morula.sample_modes(limb.positions, 3)
    clusters = numpy.arange(len(limb.facets)) // 64
    bounds = morula.SkinBounds(limb, skin, clusters, modes)
    assert bounds.target_count == 3 and bounds.targets.shape[1] == 8
    assert len(bounds.target_begin) == bounds.cluster_count + 1 and bounds.target_begin[-1] == len(bounds.targets)
    morphs = numpy.random.default_rng(4).uniform(-2, 2, (4, 3))
    spheres, boxes, whole_spheres, whole_boxes = bounds.bounds(bones, morphs)
    displacements = modes.displacements
    for frame, transforms in enumerate(bones):
        moved = limb.positions + numpy.tensordot(morphs[frame], displacements, 1)
        positions = morula.move_by_skin(skin, moved, transforms)
        for cluster in range(bounds.cluster_count):
            points = positions[numpy.unique(limb.facets[clusters == cluster])]
            sphere, box = spheres[frame, cluster].astype(float), boxes[frame, cluster]
            assert (numpy.linalg.norm(points - sphere[:3], axis=1) <= sphere[3]).all()
            assert (points >= box[0]).all() and (points <= box[1]).all()
        assert numpy.array_equal(bounds.bounds(transforms, morphs[frame])[0][0], spheres[frame])
    for bad in (morphs[:, :2], morphs[:3], numpy.full((4, 3), numpy.inf)):
        with pytest.raises(ValueError):
            bounds.bounds(bones, bad)


def test_a_rebuilding_body_covers_through_swaps(limb, model):
    body = morula.RebuiltBody(limb, model, thread="caller", rebuild_every=3, min_improvement=-1e9)
    swapped = 0
    for positions in morula.deform_frames(limb, morula.Stretch(2.0), frame_count=12, and_back=False):
        swapped += body.update(positions).swapped
        assert morula.certify(body.cover, positions, body.copy_spheres())
    assert swapped == body.report.swapped > 0 and body.tree_version == swapped


def test_colliders_of_a_rebuilt_tree_are_out_of_date(limb, model):
    body = morula.RebuiltBody(limb, model, thread="caller", rebuild_every=3, min_improvement=-1e9)
    collider = morula.Collider(body)
    inside = morula.InsideQuery(collider)
    for positions in morula.deform_frames(limb, morula.Stretch(2.0), frame_count=8, and_back=False):
        body.update(positions)
    for ask in (lambda: morula.overlap(collider, collider), lambda: inside.locate((0, 0, 0)), lambda: inside.probe((0, 0, 0, 1))):
        with pytest.raises(RuntimeError, match="another Collider"):
            ask()
    assert morula.overlap(body, body)


def move_both(limb, body, plain, deformation):
    """Every frame of `body` is certified; returns the last one's positions."""
    for positions in morula.deform_frames(limb, deformation, frame_count=8, and_back=False):
        body.update(positions)
        plain.update(positions)
        assert morula.certify(body.cover, positions, body.copy_spheres())
    return positions


def leaf_radius(model, body):
    return body.copy_spheres()[model.tree.level_set(model.tree.level_count - 1), 3].mean()


def test_leaves_that_are_fitted_are_tighter_and_cover(limb, model):
    plain = morula.RebuiltBody(limb, model, thread="none")
    body = morula.RebuiltBody(limb, model, thread="none", effort="high")
    at_rest = body.copy_spheres()
    move_both(limb, body, plain, morula.Twist(180.0))
    assert leaf_radius(model, body) < leaf_radius(model, plain)
    body.update(limb.positions)
    assert numpy.array_equal(body.copy_spheres(), at_rest)


def test_lazy_updates_reach_the_same_spheres(limb, model, motion):
    lazy, whole = morula.Body(limb, model), morula.Body(limb, model)
    whole.update(motion[4])
    lazy.update_lazily(motion[4], 0)
    assert not lazy.is_complete
    for node in range(len(model)):
        if not model.tree.is_leaf(node):
            lazy.refresh_children(node)
    assert lazy.is_complete and numpy.array_equal(lazy.copy_spheres(), whole.copy_spheres())


def test_copies_are_independent(limb, model, motion):
    body = morula.Body(limb, model)
    body.update(motion[2])
    other = copy.copy(body)
    assert other.hash() == body.hash()
    other.update(motion[4])
    assert other.hash() != body.hash()


def test_boxes_of_a_kdop_tree_hold_their_vertices(limb, model, motion):
    tree = morula.KDopTree(limb, model, 14)
    tree.update(motion[4])
    along = (motion[4] - numpy.array(tree.origin)) @ tree.directions.T
    assert (along.min(axis=0) >= tree.lower[0]).all() and (along.max(axis=0) <= tree.upper[0]).all()


def test_spheres_around_kdops_are_asked_as_those_of_bodies(limb, model, motion):
    tree, body = morula.KDopTree(limb, model, 14), morula.Body(limb, model)
    spheres = tree.posed()
    for positions in motion[1:4]:
        tree.update(positions)
        body.update(positions)
        tree.pose(spheres)
        copied = spheres.copy_spheres()
        assert spheres.covers and morula.certify(model.cover, positions, copied)
        # They hold the boxes' corners.
        low, high = (numpy.array(side)[:, :3] + tree.origin for side in (tree.lower, tree.upper))
        corner = numpy.maximum(abs(low - copied[:, :3]), abs(high - copied[:, :3]))
        assert (numpy.linalg.norm(corner, axis=1) <= copied[:, 3] * (1 + 1e-6)).all()
        one, other = morula.Collider(limb, model, spheres), morula.Collider(body)
        one.set_positions(positions)
        one.set_transform((0.0, 0.3, 0.0))
        assert numpy.array_equal(morula.crossings(one, other).facet_a, morula.crossings(placed(body, (0.0, 0.3, 0.0)), other).facet_a)
    assert numpy.array_equal(tree.posed().copy_spheres(), copied)
    with pytest.raises(ValueError, match="spheres"):
        tree.pose(morula.PosedSpheres(morula.build(limb, method="octree", depth=1).tree))


def placed(body, translation):
    collider = morula.Collider(body)
    collider.set_transform(translation)
    return collider


def test_colliders_know_where_their_vertices_are(limb, model, motion):
    body = morula.Body(limb, model)
    body.update(motion[2])
    collider = morula.Collider(body)
    turn = morula.RigidTransform.from_axis((0, 0, 1), 0.5, (1, 2, 3))
    collider.set_transform(turn)
    numpy.testing.assert_allclose(collider.vertices(), motion[2] @ turn.matrix[:3, :3].T + [1, 2, 3], atol=1e-12)
    with pytest.raises(ValueError, match="set_positions"):
        morula.Collider(morula.PosedSpheres(model.tree)).vertices()


def test_two_threads_update_two_bodies(limb, model, motion):
    expected = morula.Body(limb, model).follow(motion)
    results = [None, None]

    def work(i):
        body = morula.Body(limb, model)
        for _ in range(5):
            results[i] = body.follow(motion)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(numpy.array_equal(result, expected) for result in results)


def test_threads_that_share_a_body_take_turns(limb, model, motion):
    body = morula.Body(limb, model)
    hashes = set()
    for positions in motion:
        one = morula.Body(limb, model)
        one.update(positions)
        hashes.add(one.hash())
    faults = []

    def work(offset):
        for i in range(60):
            try:
                body.update(motion[(i + offset) % len(motion)])
                morula.overlap(body, body)
                body.copy_spheres()
            except Exception as fault:  # noqa: BLE001
                faults.append(fault)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not faults and body.frame == 180 and body.hash() in hashes


def test_other_threads_run_while_a_tree_is_built():
    mesh = morula.sample_body("limb", 48)
    counted = [0]
    done = threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    before = counted[0]
    morula.build(mesh, quality="fast")
    gained = counted[0] - before
    done.set()
    counter.join()
    assert gained >= 5


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_ctrl_c_ends_a_build():
    script = textwrap.dedent(
        """
        import morula, sys
        mesh = morula.sample_body("limb", 200)
        print("ready", flush=True)
        try:
            morula.build(mesh, quality="best")
        except KeyboardInterrupt:
            print("interrupted", flush=True)
            sys.exit(5)
        """
    )
    child = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "ready\n"
    time.sleep(0.5)
    child.send_signal(signal.SIGINT)
    said, _ = child.communicate(timeout=120)
    assert said == "interrupted\n" and child.returncode == 5


def test_rules_by_level_have_names():
    rules = ["traditional", "approach2", "exact"]
    assert [morula.rule_of_level(rules, level) for level in range(5)] == [*rules, "exact", "exact"]
    described = morula.describe_rules(rules, 4)
    assert all(rule in described for rule in rules) and morula.describe_rules(["exact"], 4) == "exact"
    with pytest.raises(ValueError, match="rules"):
        morula.rule_of_level([], 0)
    with pytest.raises(ValueError, match="rules"):
        morula.describe_rules(["none"], 1)
    assert {row.name: row.reads for row in morula.rule_table()}["wrapped"] == "children"
    assert [row.reads for row in morula.rule_table() if row.name in ("traditional", "exact", "modal")] == ["links", "corners", "nothing"]
