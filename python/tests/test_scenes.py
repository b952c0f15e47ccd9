# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Scenes: the bits of the command, pairs as each by itself, events, budgets, filters; boxes against all pairs of boxes."""

import csv
import gc
import json
import threading
import weakref

import numpy
import pytest

import morula
from test_queries import brute_crossings

columns = ("node_a", "node_b", "finished", "point", "normal", "depth", "lens_volume", "error_bound")


def same_contacts(found, expected):
    return all(numpy.array_equal(getattr(found, name), getattr(expected, name)) for name in columns)


def collider_of(name, resolution=10, place=(0.0, 0.0, 0.0)):
    mesh = morula.sample_body(name, resolution)
    collider = morula.Collider(morula.Body(mesh, morula.build(mesh, method="octree", depth=2)))
    collider.set_transform(place)
    return mesh, collider


@pytest.mark.parametrize(("budget", "text"), [(None, []), (3000, ["--budget", "3000"])])
def test_contacts_are_those_of_the_command(command, tmp_path, budget, text):
    command("sample", "limb", "-o", "limb.obj", "--resolution", "12")
    command("deform", "limb.obj", "-o", "motion", "--bend", "90", "--frames", "4")
    path = [[0, 3, 0], [0, 1, 0.2], [0.1, 0.3, 0.2], [0, 3, 0]]
    bodies = [
        {"name": "floor", "mesh": "limb.obj", "static": True, "translate": [0, 0.6, 0]},
        {"name": "limb", "mesh": "limb.obj", "motion": "motion"},
        {"name": "tool", "mesh": "limb.obj", "path": path, "weight": 2},
    ]
    (tmp_path / "room.json").write_text(json.dumps({"bodies": bodies}))
    command("collide", "--scene", "room.json", "-o", "contacts.csv", *text)
    with open(tmp_path / "contacts.csv", newline="") as file:
        theirs = list(csv.DictReader(file))
    report = json.loads(command("collide", "--scene", "room.json", "--json", *text))

    mesh = morula.read_mesh(tmp_path / "limb.obj")
    model = morula.build(mesh, quality="fast")
    moved = [morula.Body(mesh, model) for _ in bodies]
    scene = morula.Scene(budget=budget, surfaces=True)
    ids = [
        scene.add(body, is_static=i == 0, weight=2.0 if i == 2 else 1.0, user_data=i) for i, body in enumerate(moved)
    ]
    scene.collider(ids[0]).set_transform((0.0, 0.6, 0.0))
    ours, began, ended = [], [], []
    for frame, positions in enumerate(morula.read_motion(tmp_path / "motion", mesh)):
        moved[1].update(positions)
        scene.collider(ids[2]).set_transform(path[frame])
        status = scene.update()
        assert (status.finished, status.near_pairs, status.open_pairs, status.pair_tests) == tuple(
            report["frames"][frame][name] for name in ("finished", "near_pairs", "open_pairs", "pair_tests")
        )
        for pair in scene.pairs():
            names = [bodies[scene.user_data(body)]["name"] for body in (pair.a, pair.b)]
            contacts = pair.contacts
            for k in range(len(contacts)):
                surface = [repr(float(pair.surfaces.depth[k]))] if k < len(pair.surfaces) else [""]
                numbers = [*contacts.point[k], *contacts.normal[k], contacts.depth[k], contacts.error_bound[k]]
                ours.append(
                    [frame, *names, pair.id, int(pair.began), int(contacts.finished[k]), contacts.node_a[k], contacts.node_b[k]]
                    + [float(n) for n in numbers] + [float(s) if s else "" for s in surface]
                )
        began.append(sum(pair.began for pair in scene.pairs()))
        ended.append([pair.id for pair in scene.ended()])
    read = []
    for row in theirs:
        values = list(row.values())
        read.append(
            [int(values[0]), *values[1:3], *map(int, values[3:8]), *map(float, values[8:16]), float(values[16]) if values[16] else ""]
        )
    assert ours == read and len(read) > 100
    assert ended == [frame["ended"] for frame in report["frames"]]
    assert began == [sum(pair["began"] for pair in frame["pairs"]) for frame in report["frames"]] and sum(began) >= 2


@pytest.fixture
def crowd():
    """Bodies in a heap."""
    generator = numpy.random.default_rng(3)
    return [
        collider_of(name, 8, generator.uniform(-1.2, 1.2, 3)) for name in ("limb", "bar", "capsule", "blob", "torus", "tool", "bar")
    ]


def test_a_finished_pair_has_the_contacts_of_two_bodies_alone(crowd):
    scene = morula.Scene(surfaces=True, find_crossings=True)
    ids = [scene.add(collider, user_data=i) for i, (_, collider) in enumerate(crowd)]
    assert scene.update(morula.Workers(2)).finished and len(scene) == len(crowd)
    pairs = scene.pairs()
    touching = set()
    for a in range(len(crowd)):
        for b in range(a + 1, len(crowd)):
            alone = morula.collide(crowd[a][1], crowd[b][1], surfaces=True, find_crossings=True)
            pair = scene.find(ids[b], ids[a])
            assert (pair is not None) == (len(alone) > 0)
            if pair is not None:
                touching.add((a, b))
                assert same_contacts(pair.contacts, alone)
                assert pair.surfaces == alone.surfaces and pair.crossings == alone.crossings
    assert list(zip(pairs.user_data_a.tolist(), pairs.user_data_b.tolist())) == sorted(touching) and len(touching) > 5
    assert pairs.began.all() and pairs.finished.all() and pairs[-1].id == pairs.id[-1]
    for i, pair in enumerate(pairs):
        part = slice(pairs.contacts_begin[i], pairs.contacts_begin[i + 1])
        assert numpy.array_equal(pairs.contacts.depth[part], pair.contacts.depth)
        assert numpy.array_equal(pairs.surfaces.depth[part], pair.surfaces.depth)
    with pytest.raises(IndexError):
        pairs[len(pairs)]
    # What was read stays, whatever comes.
    before = pairs.contacts.depth.copy()
    for body in ids:
        scene.remove(body)
    scene.update()
    assert len(scene.pairs()) == 0 and len(scene.ended()) == len(pairs) and numpy.array_equal(pairs.contacts.depth, before)


def test_reserved_memory_changes_no_result(crowd):
    told = []
    for reserves in (False, True):
        scene = morula.Scene(surfaces=True)
        if reserves:
            scene.reserve(bodies=len(crowd), near_pairs=21, contacts=100)
        for _, collider in crowd:
            scene.add(collider)
        scene.update()
        told.append((scene.pairs().contacts.depth.tolist(), scene.pairs().id.tolist()))
    assert told[0] == told[1] and len(told[0][0]) > 10


def test_no_crossing_is_lost_to_a_budget(crowd):
    for budget in (0, 40, "50us"):
        scene = morula.Scene(budget=budget)
        ids = [scene.add(collider) for _, collider in crowd]
        scene.update()
        checked = 0
        for a in range(len(crowd)):
            for b in range(a + 1, len(crowd)):
                (mesh_a, one), (mesh_b, other) = crowd[a], crowd[b]
                crossed = brute_crossings(
                    mesh_a, mesh_a.positions + one.transform.translation, mesh_b, mesh_b.positions + other.transform.translation
                )
                if not crossed:
                    continue
                contacts = scene.find(ids[a], ids[b]).contacts
                regions = [(set(one.facets(i).tolist()), set(other.facets(j).tolist())) for i, j in zip(contacts.node_a, contacts.node_b)]
                for f, g in crossed[::7]:
                    assert any(f in at_a and g in at_b for at_a, at_b in regions)
                    checked += 1
        assert checked > 20


def test_touches_begin_and_end():
    _, floor = collider_of("bar")
    mesh, ball = collider_of("capsule")
    scene = morula.Scene()
    down, up = scene.add(floor, is_static=True), scene.add(ball)
    seen = []
    for height in (9.0, 0.5, 0.4, 9.0, 0.5):
        ball.set_transform((0.0, height, 0.0))
        scene.update()
        seen.append(([(p.id, p.began) for p in scene.pairs()], [p.id for p in scene.ended()]))
    first, second = seen[1][0][0][0], seen[4][0][0][0]
    assert seen == [([], []), ([(first, True)], []), ([(first, False)], []), ([], [first]), ([(second, True)], [])] and first != second
    scene.sleep(up)
    scene.update()                                   # looks at it for the last time
    ball.set_transform((0.0, 9.0, 0.0))
    scene.update()
    assert len(scene.pairs()) == 1 and scene.is_asleep(up)
    scene.wake(up)
    scene.update()
    assert len(scene.pairs()) == 0
    scene.remove(up)
    assert up not in scene and down in scene and not scene.has(up)
    scene.update()
    again = scene.add(ball)
    assert again.place == up.place and again != up and hash(again) != hash(up) and len({up, again, down}) == 3
    with pytest.raises(ValueError, match="body"):
        scene.collider(up)


def test_a_touch_begins_and_ends_where_it_is_proven():
    floor, ball = collider_of("bar")[1], collider_of("capsule")[1]
    scene = morula.Scene()
    scene.add(floor), scene.add(ball)

    def after(height, budget):
        ball.set_transform((0.0, height, 0.0))
        scene.set_budget(budget)
        status = scene.update()
        pairs = scene.pairs()
        told = [(p.touches, p.confirmed, p.began, p.finished) for p in pairs]
        assert told == list(zip(pairs.touches.tolist(), pairs.confirmed.tolist(), pairs.began.tolist(), pairs.finished.tolist()))
        assert all((p.id > 0) == p.touches for p in pairs)
        return told, status.undecided_pairs, len(scene.ended())

    assert after(0.3, 0) == ([(False, False, False, False)], 1, 0)
    assert after(0.3, None) == ([(True, True, True, True)], 0, 0)
    assert after(0.31, 0) == ([(True, False, False, False)], 1, 0)
    assert after(9.0, 0) == ([], 0, 1)


def test_filters_decide_who_meets():
    colliders = [collider_of("bar", 6)[1] for _ in range(4)]

    def touching(scene):
        scene.update()
        return [(p.a.place, p.b.place) for p in scene.pairs()]

    scene = morula.Scene()
    ids = [scene.add(c, is_static=i < 2, category=1 << i, mask=0b1111) for i, c in enumerate(colliders)]
    assert touching(scene) == [(0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
    scene.set_masks(ids[3], category=8, mask=0b0001)
    assert touching(scene) == [(0, 2), (0, 3), (1, 2)]

    asked = []

    def accepts(a, b):
        asked.append((scene.user_data(a), scene.user_data(b)))
        return scene.user_data(a) + scene.user_data(b) != 2

    scene = morula.Scene(accepts=accepts)
    for i, collider in enumerate(colliders):
        scene.add(collider, user_data=i)
    assert touching(scene) == [(0, 1), (0, 3), (1, 2), (1, 3), (2, 3)] == touching(scene)
    assert len(asked) == 6
    # A filter that fails says so; the next update asks again.
    answers = iter([True, ValueError])

    def fails(a, b):
        answer = next(answers, True)
        if answer is ValueError:
            raise ZeroDivisionError
        return not (a.place == 0 and b.place == 1)

    scene.set_options(accepts=fails)
    with pytest.raises(ZeroDivisionError):
        scene.update()
    assert touching(scene) == [(0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
    for budget in (0, "1us", None):
        scene.set_budget(budget)
        assert len(touching(scene)) == 5
    scene.set_options(accepts=lambda a, b: scene.pairs() is None)
    with pytest.raises(RuntimeError, match="accepts"):
        scene.update()
    with pytest.raises(TypeError, match="accepts"):
        morula.Scene(accepts=3)


def test_a_filter_that_knows_its_scene_is_collected():
    class Owner:
        def __init__(self):
            self.scene = morula.Scene(accepts=self.accepts)

        def accepts(self, a, b):
            return True

    gone = weakref.ref(Owner())
    gc.collect()
    assert gone() is None


def test_rays_and_shapes_find_what_each_body_says(crowd):
    scene = morula.Scene()
    ids = [scene.add(collider) for _, collider in crowd]
    scene.update()
    generator = numpy.random.default_rng(8)
    hits = 0
    for _ in range(60):
        origin, direction = generator.normal(size=3) * 4, generator.normal(size=3)
        direction -= origin
        alone = [morula.first_hit(collider, origin, direction) for _, collider in crowd]
        nearest = min((i for i, hit in enumerate(alone) if hit), key=lambda i: alone[i].first.t, default=None)
        found = scene.first_hit(origin, direction)
        assert bool(found) == (nearest is not None)
        if nearest is not None:
            hits += 1
            assert found.body == ids[nearest] and found.first == alone[nearest].first
            listed = scene.all_hits(origin, direction)
            assert (listed[0].body, listed[0].hit) == (found.body, found.first)
            every = sorted((float(t), i, int(f)) for i, (_, collider) in enumerate(crowd)
                           for t, f in zip(*(getattr(morula.all_hits(collider, origin, direction), name) for name in ("t", "facet"))))
            assert [(hit.hit.t, ids.index(hit.body), hit.hit.point.facet) for hit in listed] == every
            rest = scene.all_hits(origin, direction, ignored=[found.body])
            assert [hit.body for hit in rest] == [hit.body for hit in listed if hit.body != found.body]
            assert bool(scene.first_hit(origin, direction, ignored=[found.body])) == bool(rest)
            assert not scene.first_hit(origin, direction, mask=2) and scene.all_hits(origin, direction, mask=2) == []
    assert hits > 10
    assert scene.touch((0.5, 0.1, 0.2, 0.7), mask=2) == [] and scene.touch((0.5, 0.1, 0.2, 0.7), ignored=ids) == []
    for shape in (morula.HalfSpace((0, 1, 0), -0.5), (0.5, 0.1, 0.2, 0.7), morula.Capsule((0, 0, 0), (1, 1, 1), 0.2)):
        alone = {ids[i]: morula.touch(collider, shape) for i, (_, collider) in enumerate(crowd)}
        found = {touch.body: touch.touch.touches for touch in scene.touch(shape)}
        assert {body for body, touches in found.items() if touches} == {body for body, touch in alone.items() if touch.touches}
    for shape in ((0.5, 0.1, 4.0, 0.2), morula.Capsule((0, 0, 4), (1, 1, 5), 0.2), morula.ConvexHull(numpy.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (4.0, 5.0)], float))):
        motion = (0.1, 0.2, -8.0)
        alone = {ids[i]: morula.sweep(collider, shape, motion) for i, (_, collider) in enumerate(crowd)}
        found = scene.sweep_all(shape, motion)
        assert {hit.body: hit.first for hit in found} == {body: hit.first for body, hit in alone.items() if hit}
        assert [hit.first.t for hit in found] == sorted(hit.first.t for hit in found)
        first = scene.sweep(shape, motion)
        assert bool(first) == bool(found) and (not first or (first.body, first.first) == (found[0].body, found[0].first))
        assert not scene.sweep(shape, motion, mask=2) and scene.sweep_all(shape, motion, ignored=ids) == []
    with pytest.raises(TypeError, match="HalfSpace"):
        scene.sweep(morula.HalfSpace((0, 1, 0), 0), (0, 0, 1))
    far = scene.touch((40.0, 0.0, 0.0, 0.1), nearest=True)
    distances = [-morula.touch(collider, (40.0, 0.0, 0.0, 0.1), nearest=True).deepest.depth for _, collider in crowd]
    assert len(far) == 1 and far[0].body == ids[int(numpy.argmin(distances))]
    crowd[0][1].set_transform((9.0, 9.0, 9.0))
    with pytest.raises(ValueError):
        scene.first_hit((0, 0, 9.0), (0, 0, -1.0))
    with pytest.raises(TypeError, match="shape"):
        scene.touch("floor")


def test_what_is_wrong_is_said_and_changes_nothing(crowd):
    scene = morula.Scene()
    mesh, collider = crowd[0]
    body = morula.Body(mesh, morula.build(mesh, method="octree", depth=2))
    ids = [scene.add(body), scene.add(crowd[1][1])]
    scene.update()
    before = scene.pairs()
    with pytest.raises(ValueError, match="not finite"):
        body.update(numpy.full((mesh.vertex_count, 3), numpy.nan))
    with pytest.raises(ValueError):
        scene.update()
    assert [p.id for p in scene.pairs()] == [p.id for p in before]
    body.update(mesh.positions)
    scene.update()
    for wrong in (dict(margin=-1.0), dict(margin=numpy.inf), dict(budget=-1)):
        with pytest.raises(ValueError):
            scene.set_options(**wrong)
        with pytest.raises(ValueError):
            morula.Scene(**wrong)
    with pytest.raises(ValueError):
        scene.add(collider, category=0)
    with pytest.raises(ValueError):
        scene.remove(morula.BodyId(77, 0))
    with pytest.raises(TypeError, match="collider"):
        scene.add(mesh)
    assert ids[0] == morula.BodyId(ids[0].place, ids[0].generation) and "2 bodies" in repr(scene)


def test_a_body_that_was_rebuilt_is_replaced():
    mesh = morula.sample_body("limb", 10)
    model = morula.build(mesh, method="octree", depth=2)
    body = morula.RebuiltBody(mesh, model, thread="caller", rebuild_every=3, min_improvement=-1e9)
    scene = morula.Scene()
    number = scene.add(body)
    scene.add(collider_of("bar", 8)[1])
    scene.update()
    for positions in morula.deform_frames(mesh, morula.Stretch(2.0), frame_count=8, and_back=False):
        body.update(positions)
    assert body.tree_version > 0
    with pytest.raises(RuntimeError, match="another Collider"):
        scene.update()
    scene.replace(number, body)
    scene.update()
    assert len(scene.pairs()) == 1


def test_threads_wait_for_each_other(crowd):
    scene = morula.Scene(budget=500)
    ids = [scene.add(collider) for _, collider in crowd]
    scene.update()
    wrong = []

    def work(number):
        try:
            for k in range(40):
                scene.collider(ids[number]).set_transform((0.1 * k, 0.0, 0.0))
                scene.update()
                assert all(len(pair.contacts) > 0 for pair in scene.pairs())
        except Exception as error:  # noqa: BLE001: told below
            wrong.append(error)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert not wrong and not any(thread.is_alive() for thread in threads)


def test_boxes_overlap_as_all_pairs_do():
    generator = numpy.random.default_rng(11)
    count = 120
    lower = generator.uniform(0, 10, (count, 3))
    upper = lower + generator.uniform(0, 3, (count, 3))
    still = generator.uniform(size=count) < 0.3
    boxes = morula.BroadPhase()
    assert [boxes.add(lower[i], upper[i], bool(still[i])) for i in range(count)] == list(range(count))
    gone = set()
    for step in range(12):
        boxes.update()
        meet = ((lower[:, None] <= upper[None]) & (lower[None] <= upper[:, None])).all(axis=2) & ~(still[:, None] & still[None])
        expected = [(i, j) for i in range(count) for j in range(i + 1, count) if meet[i, j] and not {i, j} & gone]
        assert list(map(tuple, boxes.pairs().tolist())) == expected and len(expected) > 20
        probe = generator.uniform(0, 10, 3)
        inside = ((lower <= probe + 1) & (upper >= probe - 1)).all(axis=1)
        assert boxes.find(probe - 1, probe + 1).tolist() == [i for i in numpy.flatnonzero(inside) if i not in gone]
        behind = [i for i in numpy.flatnonzero(lower[:, 1] <= 3.0) if i not in gone]
        found = boxes.find_behind((0, 1, 0), 3.0).tolist()
        assert set(behind) <= set(found) and len(found) < len(boxes)
        middle = (lower[5] + upper[5]) / 2
        assert 5 in boxes.find_along(middle - [0, 0, 50], (0, 0, 1)) and 5 not in boxes.find_along(middle - [0, 0, 50], (0, 0, -1))
        moved = numpy.array([i for i in range(count) if generator.uniform() < 0.5 and i not in gone])
        shift = generator.normal(size=(len(moved), 3)) * (0.05 if step % 2 else 2.0)
        lower[moved] += shift
        upper[moved] += shift
        boxes.move_all(moved, lower[moved], upper[moved])
        if step == 6:
            boxes.remove(17)
            gone.add(17)
            assert not boxes.has(17) and len(boxes) == count - 1
    assert boxes.box(3) == (tuple(lower[3]), tuple(upper[3]))
    with pytest.raises(ValueError):
        boxes.add((1, 0, 0), (0, 0, 0))
    with pytest.raises(ValueError):
        boxes.move(17, (0, 0, 0), (1, 1, 1))
    with pytest.raises(IndexError):
        boxes.box(17)


def test_touching_closed_bodies_have_patches():
    hull = morula.ConvexHull.box((0, 0, 0), (1, 1, 1))
    box = morula.Mesh(hull.vertices, hull.facets)
    a, b = (morula.Collider(morula.Body(box, morula.build(box, method="octree", depth=2))) for _ in range(2))
    b.set_transform((0.5, 0.25, 0.9))
    scene = morula.Scene(patches=True)
    id_a, id_b = scene.add(a), scene.add(b)
    scene.update()
    patches = scene.find(id_a, id_b).patches
    assert len(patches) == 1 and patches.is_finished and patches.certified
    assert abs(patches.volume[0] - 0.5 * 0.75 * 0.1) < 1e-14 and len(patches.points) == 4
    (pair,) = scene.pairs()
    assert pair.has_patches and pair.patches.total_volume == patches.total_volume
    assert scene.pairs().has_patches.tolist() == [True]
    numpy.testing.assert_array_equal(pair.patches.a.gradient, patches.a.gradient)
    scene.set_options(patches=True, patch_points=0, patch_depths=False)
    scene.update()
    assert len(scene.find(id_a, id_b).patches.points) == 0
    scene.set_options(budget=1, patches=True)
    b.set_transform((0.5, 0.2, 0.9))
    scene.update()
    (pair,) = scene.pairs()
    assert not pair.has_patches and len(pair.patches) == 0 and len(pair.contacts) > 0
    with pytest.raises(ValueError, match="patch_points"):
        morula.Scene(patch_points=17)
