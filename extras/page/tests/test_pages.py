# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Pages: what is in the file, read back here; the page itself has its own tests."""

import base64
import json
import pathlib
import re
import subprocess
import sys

import numpy
import pytest

import morula

if not morula.has_page():
    pytest.skip(f"no page: {morula.why_no_page()}", allow_module_level=True)

urdf = pathlib.Path(__file__).resolve().parents[3] / "extras" / "robot" / "tests" / "robots" / "arm_description" / "urdf" / "arm.urdf"


def element(html, name):
    return re.search(rf'<script type="application/[a-z-]+" id="{name}">(.*?)</script>', html, re.S).group(1)


def manifest(html):
    assert element(html, "morula-end") == "true"
    return json.loads(element(html, "morula-manifest"))


def spheres_of_frame(html, number, frame):
    """Frame -1 is at rest."""
    content = manifest(html)
    scene = content["scenes"][number]
    nodes = scene["level_begin"][-1]
    rows = numpy.frombuffer(base64.b64decode(element(html, scene["data"]["id"])), "<f4", count=(frame + 2) * nodes * 4)
    spheres = rows.reshape(-1, nodes, 4)[frame + 1].astype(float)
    spheres[:, :3] += content["motions"][scene["motion"]]["origin"]
    return spheres


@pytest.fixture(scope="module")
def motions(limb, motion):
    return morula.PageMotion(limb.facets, motion, body="limb", name="bend"), morula.PageMotion(limb.facets, limb.positions, body="rest")


def test_scenes_of_one_page_share_their_motions(limb, model, motion, motions):
    bend, rest = motions
    assert len(bend) == len(motion) and len(rest) == 1 and repr(rest) == "<morula.PageMotion: rest, motion, 1 frame>"
    moved = morula.Body(limb, model).follow(motion)
    scenes = [
        morula.follow_motion(bend, limb, model, measured=True),
        morula.follow_motion(bend, limb, model, name="other", rules=["approach2", "exact"]),
        morula.show_spheres(bend, limb, model.tree, moved, label="kept"),
        morula.PageScene(rest, model.tree, name="alone", inside=True),
    ]
    described = [morula.describe_rules(rules, model.tree.level_count) for rules in (["exact"], ["approach2", "exact"])]
    assert [scene.label for scene in scenes] == [*described, "kept", "spheres as they are"] and described[0] == "exact"
    assert len(scenes[0].measured) == len(motion) and scenes[1].measured == []
    page = morula.page_of_scenes(scenes, title="limbs")
    content = manifest(page.html)
    assert content["title"] == "limbs" and [m["body"] for m in content["motions"]] == ["limb", "rest"]
    assert [s["motion"] for s in content["scenes"]] == [0, 0, 0, 1]
    assert [s["tree"] for s in content["scenes"]] == ["grid", "other", "tree", "alone"]
    assert [s["rule"] for s in content["scenes"]] == [scene.label for scene in scenes]
    assert [s["inside"] for s in content["scenes"]] == [False, False, False, True]
    assert content["scenes"][0]["measured"] is not None and content["scenes"][2]["measured"] is None
    for frame in (0, len(motion) - 1):
        numpy.testing.assert_allclose(spheres_of_frame(page.html, 0, frame), moved[frame], atol=1e-5)
        numpy.testing.assert_allclose(spheres_of_frame(page.html, 2, frame), moved[frame], atol=1e-5)
    numpy.testing.assert_allclose(spheres_of_frame(page.html, 3, 0), model.spheres, atol=1e-5)


def test_marks_are_on_the_page(limb, model, motion, motions):
    scene = morula.follow_motion(motions[0], limb, model)
    assert scene.contacts == []
    marks = [[morula.PageContact((1, 2, 3), (0, 0, 1), 0.5)] * (i % 3) for i in range(len(motion))]
    scene.contacts = marks
    assert scene.contacts == marks and scene.contacts[1][0].depth == 0.5
    assert manifest(morula.make_page([scene]))["scenes"][0]["contacts"] == [i % 3 for i in range(len(motion))]


def test_what_a_page_cannot_show_is_refused(limb, model, motion, motions):
    bend, rest = motions
    with pytest.raises(ValueError, match="at least one scene"):
        morula.make_page([])
    scene = morula.follow_motion(bend, limb, model)
    scene.contacts = [[]]
    with pytest.raises(ValueError, match="contacts miss a frame"):
        morula.make_page([scene])
    with pytest.raises(ValueError, match="study"):
        morula.page_of_scenes([morula.PageScene(rest, model.tree)], study="{}")
    with pytest.raises(ValueError, match="another mesh"):
        morula.follow_motion(bend, morula.sample_body("limb", 4), model)
    with pytest.raises(ValueError, match="rules"):
        morula.follow_motion(bend, limb, model, rules=["nothing"])
    with pytest.raises(ValueError, match="1 frames"):
        morula.show_spheres(bend, limb, model.tree, model.spheres[None])
    with pytest.raises(ValueError, match="spheres"):
        morula.PageScene(rest, model.tree, model.spheres[None, :3])
    with pytest.raises(ValueError, match="frames"):
        morula.PageMotion(limb.facets, motion[:0])
    far = numpy.array(motion)
    far[1, 0, 0] = 1e40
    with pytest.raises(ValueError, match="frame 1"):
        morula.follow_motion(morula.PageMotion(limb.facets, far), limb, model)


def test_a_page_is_saved_whole_or_what_was_there_stays(tmp_path):
    page = morula.pages.Page("<p>ä</p>" * 20_000)
    target = tmp_path / "page.html"
    target.write_text("older")
    script = (
        "import resource, signal, morula.pages\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000))\n"
        "try:\n"
        f"    morula.pages.Page('x' * 100_000).save({str(target)!r})\n"
        "except OSError as error:\n"
        "    print(type(error).__name__)\n"
    )
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "OSError", said
    assert target.read_text() == "older" and list(tmp_path.iterdir()) == [target]
    page.save(target)
    assert target.read_text(encoding="utf-8") == page.html and list(tmp_path.iterdir()) == [target]
    with pytest.raises(FileNotFoundError, match="nowhere"):
        page.save(tmp_path / "nowhere" / "page.html")


def test_joints_of_ones_own():
    """Two boxes, of which the second turns about the first and a third slides with it."""
    box = morula.ConvexHull.box((0, 0, 0), (1, 1, 1))
    corners, facets = numpy.array(box.vertices), numpy.array(box.facets)
    count = len(corners)
    positions = numpy.concatenate([corners + [2 * k, 0, 0] for k in range(3)])
    parts = [morula.PagePart(name, k * count, (k + 1) * count) for k, name in enumerate(("base", "arm", "tool"))]
    joints = morula.PageJoints(
        parts,
        [
            morula.PageJoint("swing", "turns", 0, 1, axis=(0, 1, 0), lower=-1, upper=1),
            morula.PageJoint("reach", "slides", 1, 2, lower=0, upper=0.5, leader=0, factor=0.25),
        ],
        [(0, 1)],
    )
    assert joints.joints[0].kind == "turns" and joints.joints[1].leader == 0 and joints.ignored == [[0, 1]]
    assert joints.parts[2] == morula.PagePart("tool", 2 * count, 3 * count)
    motion = morula.PageMotion(numpy.concatenate([facets + k * count for k in range(3)]), positions, joints=joints)
    spheres = numpy.array([[2.5, 0.5, 0.5, 4], *([2 * k + 0.5, 0.5, 0.5, 0.9] for k in range(3))])
    none = morula.no_node
    shape = [[1, none, none, none], [3, 0, 0, 0], [none, 0, 0, 0], [0, 1, 4]]
    tree = morula.SphereTree(spheres, *(numpy.array(numbers) for numbers in shape))
    content = manifest(morula.make_page([morula.PageScene(motion, tree, parts=[0, 1, 2])]))
    written = content["motions"][0]["joints"]
    assert [part["name"] for part in written["parts"]] == ["base", "arm", "tool"] and written["ignored"] == [[0, 1]]
    assert [(j["kind"], j["leader"], j["factor"]) for j in written["joints"]] == [("turns", None, 1), ("slides", 0, 0.25)]
    assert content["scenes"][0]["parts"] == [0, 1, 2]
    with pytest.raises(ValueError, match="part"):
        morula.make_page([morula.PageScene(motion, tree)])
    with pytest.raises(ValueError, match="kind"):
        morula.PageJoint("swing", "bends", 0, 1)
    twice = morula.PageJoints(parts, [morula.PageJoint("a", "fixed", 0, 1), morula.PageJoint("b", "fixed", 2, 1)])
    with pytest.raises(ValueError, match="two joints carry one part"):
        morula.make_page([morula.PageScene(morula.PageMotion(motion_facets(facets, count), positions, joints=twice), tree, parts=[0, 1, 2])])


def motion_facets(facets, count):
    return numpy.concatenate([facets + k * count for k in range(3)])


def test_bodies_that_meet_are_on_one_page(limb, model, motion):
    if not hasattr(morula, "CollidePage"):
        pytest.skip("this package was built without the command")
    body = morula.Body(limb, model)
    tool = morula.sample_body("tool", 12)
    other = morula.Collider(morula.Body(tool, morula.build(tool, quality="fast")))
    one = morula.Collider(body)
    page = morula.CollidePage([one, other], title="limb and tool")
    scene = morula.Scene(surfaces=True)
    scene.add(one)
    scene.add(other)
    marks = []
    for frame, positions in enumerate(motion):
        body.update(positions)
        other.set_transform((0.0, 0.2 * frame, 0.0))
        scene.update()
        found = scene.pairs()
        deep = found.surfaces.depth != 0
        marks.append(int((found.contacts.finished & deep).sum()))
        page.add(found, name=f"step {frame}")
    assert sum(marks) > 10
    html = page.html()
    content = manifest(html)
    assert content["title"] == "limb and tool" and content["scenes"][0]["contacts"] == marks
    assert content["motions"][0]["frames"] == [f"step {frame}" for frame in range(len(motion))]
    assert content["motions"][0]["vertices"] == limb.vertex_count + tool.vertex_count
    last = spheres_of_frame(html, 0, len(motion) - 1)
    begin = content["scenes"][0]["level_begin"]
    assert begin[1:3] == [1, 3] and content["scenes"][0]["branching"] >= 2
    numpy.testing.assert_allclose(last[1], body.copy_spheres()[0], atol=1e-5)
    # Marks of one's own, none, or what collide() finds; and what is refused.
    few = morula.CollidePage([body])
    few.add()
    few.add([morula.PageContact((0, 0, 0), (0, 0, 1), 1)])
    few.add(morula.collide(one, other))
    assert manifest(few.html())["scenes"][0]["contacts"][:2] == [0, 1]
    with pytest.raises(TypeError, match="contacts"):
        few.add(3)
    with pytest.raises(ValueError, match="at least one"):
        morula.CollidePage([])
    with pytest.raises(ValueError, match="surface"):
        morula.CollidePage([morula.PosedSpheres(model.tree)])


def test_contact_patches_are_on_the_page_as_the_command_writes_them():
    if not hasattr(morula, "CollidePage"):
        pytest.skip("this package was built without the command")
    mesh = morula.sample_body("limb", 8)
    a, b = (morula.Collider(morula.Body(mesh, morula.build(mesh, method="octree", depth=1))) for _ in range(2))
    b.set_transform((0, 0.1, 0))
    page = morula.CollidePage([a, b])
    page.add()
    patches = morula.ContactPatchQuery(a, b).run()
    page.add(patches, name="with")
    shown = manifest(page.html())["scenes"][0]
    assert [len(frame["volumes"]) for frame in shown["patches"]] == [0, len(patches)]
    assert shown["patches"][1]["facets"] == [len(patches.a.facet) + len(patches.b.facet)]
    assert shown["patches"][1]["curves"] == len(morula.crossings(a, b)) > 0
    assert shown["contacts"] == [0, len(patches.points)]
    small = morula.ConvexHull.box((0, 0, 0), (1, 1, 1))
    box = morula.Mesh(small.vertices, small.facets)
    with pytest.raises(ValueError, match="another body"):
        morula.CollidePage([morula.Body(box, morula.build(box, method="octree", depth=1))]).add(patches)
    alone = morula.CollidePage([a])
    alone.add(morula.ContactPatchQuery(a).run())
    assert manifest(alone.html())["scenes"][0]["patches"][0]["volumes"] == []


def test_marks_of_pairs_that_a_budget_ended_have_the_surfaces_of_their_own_pair():
    if not hasattr(morula, "CollidePage"):
        pytest.skip("this package was built without the command")
    limb, tool = morula.sample_body("limb", 24), morula.sample_body("tool", 6)
    meshes = [limb, limb, tool, tool]
    bodies = [morula.Collider(morula.Body(mesh, morula.build(mesh, quality="fast"))) for mesh in meshes]
    for body, x in zip(bodies, (0, 0.1, 100, 100.05)):
        body.set_transform((x, 0, 0))
    scene = morula.Scene(surfaces=True, budget=256)
    for body, weight in zip(bodies, (1, 1, 100, 100)):
        scene.add(body, weight=weight)
    scene.update()
    found = scene.pairs()
    assert len(found[0].surfaces) < len(found[0].contacts) and len(found[1].surfaces) == len(found[1].contacts) > 0
    marks = 0
    for pair in found:
        deep = numpy.zeros(len(pair.contacts), bool)
        deep[: len(pair.surfaces)] = pair.surfaces.depth != 0
        marks += int((pair.contacts.finished & deep).sum())
    page = morula.CollidePage(bodies)
    page.add(found)
    assert manifest(page.html())["scenes"][0]["contacts"] == [marks]


def test_the_page_of_a_robot_is_that_of_the_command(tmp_path, command):
    if not hasattr(morula._morula, "robot") or not hasattr(morula._morula.robot, "page_html"):
        pytest.skip("this package was built without robots or without the command")
    arm = morula.robot.read_robot(urdf)
    spheres = morula.robot.fit_spheres(arm, spheres=4)
    page = morula.robot.page(arm, spheres, morula.robot.find_ignored(arm, spheres, samples=200))
    content = manifest(page.html)
    joints = content["motions"][0]["joints"]
    assert content["title"] == "arm" and {j["name"] for j in joints["joints"]} == {j.name for j in arm.joints}
    assert [part["name"] for part in joints["parts"]] == [link.name for link in arm.links] and joints["ignored"]
    assert manifest(morula.robot.page(arm, spheres).html)["motions"][0]["joints"]["ignored"] == []
    command("robot", urdf, "-o", "out", "--spheres", 4, "--samples", 200, "--page")
    assert page.html == (tmp_path / "out" / "robot.html").read_text(encoding="utf-8")
