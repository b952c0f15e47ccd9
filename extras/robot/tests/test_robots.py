# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Robots: kinematics by hand, spheres by sampling, collisions by brute force, files as the command writes them."""

import fractions
import itertools
import pathlib
import shutil
import subprocess
import sys

import numpy
import pytest
from conftest import covers_by_sampling

import morula

robots = pathlib.Path(__file__).resolve().parent / "robots"
urdf = robots / "arm_description" / "urdf" / "arm.urdf"


@pytest.fixture(scope="module")
def arm():
    return morula.robot.read_robot(urdf)


@pytest.fixture(scope="module")
def spheres(arm):
    return morula.robot.fit_spheres(arm, spheres=8)


@pytest.fixture(scope="module")
def ignored(arm, spheres):
    return morula.robot.find_ignored(arm, spheres, samples=200)


def test_what_the_file_says_is_there(arm):
    assert arm.name == "arm" and arm.format == "urdf" and pathlib.Path(arm.file) == urdf
    assert [link.name for link in arm.links][:3] == ["base", "shoulder", "upper"]
    base = arm.links[arm.root]
    assert base.joint is None and base.inertial.mass == 4 and [s.kind for s in base.collision] == ["box", "cylinder"]
    assert base.collision[0].size == (0.3, 0.2, 0.06) and base.collision[1].radius == 0.05
    lift = arm.joints[arm.find_joint("lift")]
    assert lift.kind == "revolute" and (lift.lower, lift.upper) == (-1.2, 1.5) and lift.axis == (0, 1, 0)
    assert arm.links[lift.parent].name == "shoulder" and lift.moves and lift.mimic is None
    assert arm.find_link("nobody") is None and [arm.joints[j].name for j in arm.independent_joints] == ["turn", "lift", "bend", "reach", "roll"]
    assert arm.to_dict()["links"][0]["name"] == "base" and "Robot(" in repr(arm)
    with pytest.raises(OSError, match="nowhere.urdf"):
        morula.robot.read_robot("nowhere.urdf")
    mesh = arm.links[1].collision[0]
    assert mesh.file_name.startswith("package://") and pathlib.Path(mesh.file).name == "wedge.obj"
    assert morula.robot.find_mesh(mesh.file_name, urdf).samefile(mesh.file)


def test_what_is_printed_is_short(arm, spheres, ignored):
    assert repr(arm) == f"Robot(name='arm', format='urdf', links=<{len(arm.links)}>, joints=<{len(arm.joints)}>, independent_joints=<5>)"
    base = arm.links[arm.root]
    assert repr(base) == f"Link(name='base', collision=<2>, visual=<{len(base.visual)}>, joint=None)"
    assert repr(spheres) == (
        f"RobotSpheres(links=<{len(spheres.links)}>, sphere_count={spheres.sphere_count}, inner_count=0, covered=True, "
        f"notes=<{len(spheres.notes)}>)"
    )
    link = spheres.links[0]
    assert repr(link) == f"LinkSpheres(link={link.link}, spheres=<{link.spheres.shape}>, inner=<(0, 4)>, notes=<{len(link.notes)}>)"
    assert repr(ignored) == f"SelfCollision(ignored=<{len(ignored.ignored)}>, samples={ignored.samples}, pairs={ignored.pairs})"
    # All of it is in the dict.
    assert arm.to_dict()["joints"][0]["name"] == arm.joints[0].name and len(spheres.to_dict()["links"]) == len(spheres.links)


def rotation(axis, angle):
    x, y, z = axis
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return numpy.eye(3) + numpy.sin(angle) * cross + (1 - numpy.cos(angle)) * cross @ cross


def test_links_are_where_the_joints_put_them(arm):
    values = numpy.array([0.3, -0.4, 1.1, 0.05, 0.7])
    poses = morula.robot.link_poses(arm, values)
    by_hand = {arm.root: numpy.eye(4)}
    given = {joint: value for joint, value in zip(arm.independent_joints, values)}
    for index in arm.order:
        joint = arm.joints[index]
        move = numpy.eye(4)
        if joint.kind in ("revolute", "continuous"):
            move[:3, :3] = rotation(joint.axis, given[index])
        elif joint.kind == "prismatic":
            move[:3, 3] = numpy.array(joint.axis) * given[index]
        by_hand[joint.child] = by_hand[joint.parent] @ joint.origin.matrix @ move
    for link, pose in enumerate(poses):
        numpy.testing.assert_allclose(pose.matrix, by_hand[link], atol=1e-12)
    rest = morula.robot.rest_values(arm)
    assert rest[2] == pytest.approx((0.2 + 2.9) / 2) and rest[0] == 0
    with pytest.raises(ValueError):
        morula.robot.link_poses(arm, values[:2])


def test_spheres_cover_their_links(arm, spheres):
    assert spheres.covered and spheres.sphere_count == sum(len(l.spheres) for l in spheres.links)
    for link in spheres.links:
        assert link.figures.covered and link.figures.uncovered_distance == 0 and len(link.spheres) <= 8 + 2
        surface = morula.robot.surface_of(arm.file, arm.links[link.link].collision)
        assert surface.mesh == link.surface.mesh
        if surface.mesh.facet_count:
            assert covers_by_sampling(surface.mesh, surface.mesh.positions, link.spheres)
        for ball in surface.spheres:
            assert any(numpy.linalg.norm(ball[:3] - s[:3]) + ball[3] <= s[3] + 1e-9 for s in link.spheres)
    assert spheres.of(arm.find_link("tool")) is None
    assert spheres.of(spheres.links[0].link) == spheres.links[0]
    again = morula.robot.fit_spheres(arm, spheres=8, workers=morula.Workers(2), progress=lambda share, link: None)
    assert all(numpy.array_equal(a.spheres, b.spheres) for a, b in zip(spheres.links, again.links))
    own = {"base": numpy.array([[0, 0, 0.05, 0.25]])}
    kept = morula.robot.fit_spheres(arm, spheres=4, fixed_spheres=own, skip={"flange"}, link_spheres={"upper": 2})
    assert numpy.allclose(kept.of(arm.find_link("base")).spheres[0], own["base"][0]) and kept.of(arm.find_link("flange")) is None
    assert len(kept.of(arm.find_link("upper")).spheres) <= 2

    def stop(share, link):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        morula.robot.fit_spheres(arm, progress=stop)
    with pytest.raises(ValueError):
        morula.robot.fit_spheres(arm, link_spheres={"nobody": 3})


def test_inner_spheres_and_planes_that_clip(arm):
    plane = numpy.array([[0.0, 0, 1, 0.05]])
    found = morula.robot.fit_spheres(arm, spheres=6, inner=4, clip={"forearm": plane})
    forearm = found.of(arm.find_link("forearm"))
    assert forearm.figures.beyond_clip is not None and found.inner_count == sum(len(link.inner) for link in found.links) > 0
    assert all(link.figures.beyond_clip is None for link in found.links if link.link != forearm.link)
    assert (forearm.inner[:, 2] - forearm.inner[:, 3] >= 0.05 - 1e-9).all()
    for link in found.links:
        if len(link.inner) and not len(link.surface.spheres) and link.link != forearm.link:
            inside = morula.SignedDistance(link.surface.mesh)
            single = morula.components_by_vertices(link.surface.mesh).count == 1
            assert not single or (inside(link.inner[:, :3]) + link.inner[:, 3] <= 1e-6).all()
    swapped = found.with_inner_spheres()
    assert swapped.sphere_count == found.inner_count
    around = morula.robot.mesh_of(arm, found, morula.robot.rest_values(arm))
    assert around.links == [link.link for link in found.links] and around.vertex_begin[-1] == around.mesh.vertex_count
    outer, inner = (
        morula.robot.surface_of(arm.file, arm.links[arm.find_link("forearm")].collision, round) for round in ("around", "inside")
    )
    truth = numpy.pi * 0.04**2 * (0.2 + 4 / 3 * 0.04)
    assert morula.signed_volume(inner.mesh) < truth < morula.signed_volume(outer.mesh)
    with pytest.raises(ValueError, match="round"):
        morula.robot.surface_of(arm.file, [], "beside")


def moved(spheres, poses):
    """By place: spheres in the world."""
    found = []
    for link in spheres.links:
        matrix = poses[link.link].matrix
        found.append(numpy.column_stack([link.spheres[:, :3] @ matrix[:3, :3].T + matrix[:3, 3], link.spheres[:, 3]]))
    return found


def meet(a, b):
    return (numpy.linalg.norm(a[:, None, :3] - b[None, :, :3], axis=2) <= a[:, None, 3] + b[None, :, 3]).any()


def test_collisions_are_those_of_all_against_all(arm, spheres, ignored):
    robot = morula.robot.SphereRobot(arm, spheres, ignored)
    assert robot.links == [link.link for link in spheres.links] and robot.sphere_count == spheres.sphere_count
    skip = {frozenset((p.a, p.b)) for p in ignored.ignored}
    assert {p.reason for p in ignored.ignored} <= {"given", "adjacent", "rest", "apart", "never"} and ignored.samples >= 200
    assert ignored.never_bound == 3 / ignored.samples
    generator = numpy.random.default_rng(8)
    lower = numpy.array([arm.joints[j].lower for j in arm.independent_joints])
    upper = numpy.array([arm.joints[j].upper for j in arm.independent_joints])
    configurations = generator.uniform(lower, upper, (60, len(lower)))
    expected = []
    for values in configurations:
        poses = morula.robot.link_poses(arm, values)
        places = moved(spheres, poses)
        pairs = [
            (i, j) for i, j in itertools.combinations(range(len(places)), 2)
            if frozenset((robot.links[i], robot.links[j])) not in skip and meet(places[i], places[j])
        ]
        robot.set_joint_values(values)
        numpy.testing.assert_allclose(robot.spheres(), numpy.concatenate(places), atol=1e-12)
        assert robot.self_collision() == (pairs[0] if pairs else None)
        expected.append(bool(pairs))
        ball = (*generator.uniform(-0.5, 0.5, 3), generator.uniform(0, 0.2))
        assert robot.collides(ball) == meet(numpy.concatenate(places), numpy.array([ball]))
        # By poses of links, both ways to give them.
        robot.set_link_poses(poses)
        same = robot.spheres()
        robot.set_link_poses(numpy.array([pose.matrix for pose in poses]))
        assert numpy.array_equal(same, robot.spheres())
    assert robot.self_collisions(configurations).tolist() == expected
    assert 0 < robot.sphere_tests
    all_pairs = morula.robot.SphereRobot(arm, spheres)
    assert all_pairs.self_collision() is not None


def test_boxes_and_trees_are_obstacles(arm, spheres):
    robot = morula.robot.SphereRobot(arm, spheres)
    robot.set_joint_values(morula.robot.rest_values(arm))
    now = robot.spheres()
    generator = numpy.random.default_rng(9)
    for _ in range(40):
        half, center = generator.uniform(0.01, 0.1, 3), generator.uniform(-0.6, 0.6, 3)
        distances = numpy.linalg.norm(numpy.maximum(abs(now[:, :3] - center) - half, 0), axis=1)
        box = morula.robot.ObstacleBox(half, morula.RigidTransform(translation=center))
        assert robot.collides(box) == (distances <= now[:, 3]).any()
        assert robot.collides(morula.robot.ObstacleBox(half), morula.RigidTransform(translation=center)) == robot.collides(box)
        balls = numpy.column_stack([generator.uniform(-1, 1, (30, 3)), generator.uniform(0, 0.1, 30)])
        scene = morula.PosedSpheres(morula.tree_from_spheres(balls))
        assert robot.collides(scene) == meet(now, balls)
    mesh = morula.sample_body("bar", 6)
    body = morula.Body(mesh, morula.build(mesh, method="octree", depth=2))
    far = morula.RigidTransform(translation=(9, 9, 9))
    assert robot.collides(body, morula.RigidTransform(translation=-mesh.positions.mean(axis=0))) and not robot.collides(body, far)
    with pytest.raises(TypeError, match="obstacle"):
        robot.collides("wall")


def test_one_tree_is_a_body(arm, spheres):
    values = morula.robot.rest_values(arm)
    one = morula.robot.tree_of(arm, spheres, values)
    assert one.model.validate(one.mesh) == []
    assert len(one.links) == len(one.vertex_begin) - 1 and one.vertex_begin[-1] == one.mesh.vertex_count
    body = morula.Body(one.mesh, one.model)
    before = morula.robot.link_poses(arm, values)
    after = morula.robot.link_poses(arm, values + 0.1)
    positions = numpy.array(one.mesh.positions)
    for k, link in enumerate(one.links):
        rows = slice(one.vertex_begin[k], one.vertex_begin[k + 1])
        move = after[link].matrix @ numpy.linalg.inv(before[link].matrix)
        positions[rows] = positions[rows] @ move[:3, :3].T + move[:3, 3]
    body.update(positions)
    assert body.certify(positions)


def test_files_are_those_of_the_command(arm, tmp_path, command):
    command("robot", urdf, "-o", "out", "--spheres", "4", "--samples", "200")
    spheres = morula.robot.fit_spheres(arm, spheres=4)
    ignored = morula.robot.find_ignored(arm, spheres, samples=200)
    compared = 0
    for format in morula.robot.output_formats():
        assert morula.robot.output_format(format.name).name == format.name and format.reader
        for name, data in format.write(arm, spheres, ignored, folder=tmp_path / "out").items():
            if (tmp_path / "out" / name).exists():
                assert (tmp_path / "out" / name).read_bytes() == data, name
                compared += 1
    assert compared >= 1 and morula.robot.output_format("nonsense") is None
    assert morula.robot.guess_tool(arm) in [link.name for link in arm.links]
    read = morula.robot.read_robot_spheres(next((tmp_path / "out").glob("**/*spheres.json")))
    for link in spheres.links:
        assert numpy.array_equal(read[arm.links[link.link].name], link.spheres)


@pytest.mark.parametrize("file", ["mjcf/arm.xml", "sdf/arm.sdf"])
def test_other_descriptions_are_robots_too(file):
    other = morula.robot.read_robot(robots / "arm_description" / file)
    assert other.format == file[: file.index("/")] and len(other.independent_joints) >= 3


def test_mujoco_puts_links_where_we_do(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    (tmp_path / "arm.xml").write_text(
        """
        <mujoco model="arm">
          <compiler angle="radian"/>
          <worldbody>
            <body name="base">
              <geom type="box" size="0.1 0.1 0.05"/>
              <body name="upper" pos="0 0 0.2" euler="0.1 0.2 0.3">
                <joint name="turn" axis="0 1 1" range="-2 2"/>
                <geom type="capsule" size="0.03" fromto="0 0 0 0 0 0.3"/>
                <body name="lower" pos="0 0 0.3" quat="0.8 0 0.6 0">
                  <joint name="slide" type="slide" axis="1 0 0" range="0 0.2"/>
                  <joint name="roll" axis="0 0 1" pos="0 0.02 0" range="-1 1"/>
                  <geom type="sphere" size="0.05" pos="0.1 0 0"/>
                </body>
              </body>
            </body>
          </worldbody>
        </mujoco>
        """
    )
    ours = morula.robot.read_robot(tmp_path / "arm.xml")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    data = mujoco.MjData(model)
    spheres = morula.robot.SphereRobot(ours, morula.robot.fit_spheres(ours, spheres=4))
    names = [ours.joints[j].name for j in ours.independent_joints]
    assert sorted(names) == ["roll", "slide", "turn"]
    generator = numpy.random.default_rng(4)
    for _ in range(10):
        values = numpy.array([generator.uniform(ours.joints[j].lower, ours.joints[j].upper) for j in ours.independent_joints])
        for name, value in zip(names, values):
            data.joint(name).qpos[0] = value
        mujoco.mj_forward(model, data)
        poses = morula.robot.link_poses(ours, values)
        for name in ("base", "upper", "lower"):
            pose, body = poses[ours.find_link(name)].matrix, data.body(name)
            numpy.testing.assert_allclose(pose[:3, 3], body.xpos, atol=1e-9)
            numpy.testing.assert_allclose(pose[:3, :3], body.xmat.reshape(3, 3), atol=1e-9)
        # The spheres contain MuJoCo's ball at the end.
        spheres.set_joint_values(values)
        ball = data.geom_xpos[model.ngeom - 1]
        reach = numpy.linalg.norm(spheres.spheres()[:, :3] - ball, axis=1) + 0.05 - spheres.spheres()[:, 3]
        assert reach.min() < 1e-6


def test_a_robot_that_is_asked_in_one_thread_is_posed_in_another():
    """In a program of its own, since what waits for ever here would stop all tests."""
    code = f"""
import threading
import morula, numpy
arm = morula.robot.read_robot({str(urdf)!r})
robot = morula.robot.SphereRobot(arm, morula.robot.fit_spheres(arm, spheres=4))
values = numpy.zeros(len(arm.independent_joints))
long = threading.Thread(target=robot.self_collisions, args=(numpy.zeros((200000, len(values))),))
long.start()
while long.is_alive():
    robot.set_joint_values(values)
    robot.collides((9, 9, 9, 0.1))
    assert len(robot.spheres()) == robot.sphere_count
print("done")
"""
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120).stdout == "done\n"


def test_float_spheres_contain_the_given_ones(spheres):
    random = numpy.random.default_rng(3)
    for scale in (1e-9, 1.0, 1e9):
        given = numpy.column_stack([random.normal(size=(500, 3)) * scale + 7 * scale, random.random(500) * scale])
        rounded = morula.robot.float_spheres(given)
        assert rounded.dtype == numpy.float32 and rounded.shape == (500, 4)
        # In exact arithmetic: distance of centers <= difference of radii, without square roots.
        for (*center, radius), row in zip(given, rounded):
            squared = sum((fractions.Fraction(a) - fractions.Fraction(float(b))) ** 2 for a, b in zip(center, row[:3]))
            grown = fractions.Fraction(float(row[3])) - fractions.Fraction(radius)
            assert grown >= 0 and squared <= grown**2
            assert float(row[3]) <= radius + 3e-6 * scale * 10
    link = spheres.links[0]
    assert numpy.array_equal(morula.robot.float_spheres(link), morula.robot.float_spheres(link.spheres))
    assert morula.robot.float_spheres(numpy.zeros((0, 4))).shape == (0, 4)
    for wrong in (numpy.zeros(4), numpy.zeros((2, 3)), [[0, 0, 0, 1e300]], [[numpy.nan, 0, 0, 1]]):
        with pytest.raises(ValueError, match="spheres: "):
            morula.robot.float_spheres(wrong)


def test_lists_and_transforms_are_taken(arm, spheres):
    moving = morula.robot.SphereRobot(arm, spheres)
    values = [0.1] * len(arm.independent_joints)
    moving.set_joint_values(values)
    before = moving.spheres()
    moving.set_joint_values(numpy.array(values))
    assert numpy.array_equal(moving.spheres(), before)
    with pytest.raises(TypeError, match="values: a sequence with something else than numbers"):
        moving.set_joint_values(["x"] * len(values))
    pose = morula.RigidTransform(translation=(1, 2, 3))
    for given in (pose, (1, 2, 3), numpy.array([[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3.0]])):
        assert morula.robot.ObstacleBox((1, 1, 1), given).pose == pose


def test_spheres_follow_the_size_of_links(arm):
    by_size = morula.robot.fit_spheres(arm, quality="draft")
    assert by_size.covered and len({len(link.spheres) for link in by_size.links}) > 1


def test_spheres_leave_at_most_a_share_uncovered(arm):
    options = {"spheres": 3, "tolerance": 0.08, "quality": "draft"}
    fitted = morula.robot.fit_spheres(arm, max_uncovered=0.4, **options)
    assert 0 < fitted.uncovered_share <= 0.4 and fitted.within <= 0.08
    assert max(link.figures.uncovered_share for link in fitted.links) <= 1
    with pytest.raises(ValueError, match="max_uncovered"):
        morula.robot.fit_spheres(arm, max_uncovered=2, **options)


def test_xacro_runs_only_where_it_is_named(tmp_path):
    shutil.copytree(urdf.parents[1], tmp_path / "arm_description")
    file = tmp_path / "arm_description" / "urdf" / "a.xacro"
    file.write_text("<robot name='a' xmlns:xacro='x'>\n<xacro:b/></robot>")
    with pytest.raises(OSError, match="a.xacro:2: has macros: run xacro"):
        morula.robot.read_robot(file)
    program = tmp_path / "program"
    program.write_text(f"#!/bin/sh\ncat '{urdf}'\n")
    program.chmod(0o700)
    read = morula.robot.read_robot(file, xacro=str(program), xacro_arguments=["a:=b"])
    assert read.name == "arm" and read.expanded == urdf.read_text()
    with pytest.raises(ValueError, match="NAME:=VALUE"):
        morula.robot.read_robot(file, xacro=str(program), xacro_arguments=["a=b"])
