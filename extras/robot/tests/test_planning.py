# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Planners' queries of a ball on a slider: distances, derivatives and times by hand."""

import copy
import pydoc
import subprocess
import sys

import numpy
import pytest

import morula

radius, wall = 0.1, 1.0


def column(*values):
    """Configurations of one coordinate."""
    return numpy.array(values, dtype=float)[:, None]


@pytest.fixture(scope="module")
def slider(tmp_path_factory):
    file = tmp_path_factory.mktemp("slider") / "slider.urdf"
    ball = f"<collision><geometry><sphere radius='{radius}'/></geometry></collision>"
    file.write_text(
        f"<robot name='slider'><link name='base'/><link name='ball'>{ball}</link>"
        "<joint name='slide' type='prismatic'><parent link='base'/><child link='ball'/><axis xyz='1 0 0'/>"
        "<limit lower='-5' upper='5' effort='1' velocity='1'/></joint></robot>"
    )
    robot = morula.robot.read_robot(file)
    return robot, morula.robot.fit_spheres(robot, spheres=1)


@pytest.fixture(scope="module")
def query(slider):
    return morula.robot.ConfigurationQuery(*slider)


@pytest.fixture(scope="module")
def world():
    """A wall from x = 1 on, and a ball of radius 0.5 around x = -2."""
    made = morula.robot.World()
    made.add(morula.robot.ObstacleBox((1, 3, 3), morula.RigidTransform(translation=(wall + 1, 0, 0))))
    made.add((-2, 0, 0, 0.5))
    return made


def test_clearances_are_those_by_hand(query, world):
    x = numpy.array([0.0, 0.5, 0.95, -0.9, -1.45])
    expected = numpy.where(x >= 0, wall - radius - x, x + 2 - 0.5 - radius)
    found = query.clearance(x[:, None], world, gradients=True)
    numpy.testing.assert_allclose(found.distance, expected, atol=1e-5)
    assert (found.lower <= found.distance).all() and (found.distance <= found.upper).all()
    assert (found.upper - found.lower).max() < 1e-5
    assert found.link.tolist() == [1] * 5 and found.other_link.tolist() == [-1] * 5
    assert found.obstacle.tolist() == [0, 0, 0, 1, 1]
    numpy.testing.assert_allclose(found.gradients, [[-1], [-1], [-1], [1], [1]], atol=1e-9)
    assert query.clearance(x[:, None], world).gradients is None
    again = query.clearance(x[:, None], world, gradients=True, workers=morula.Workers(2))
    assert again == found


def test_clearances_beyond_the_limit_name_nothing(query, world):
    found = query.clearance(column(0, 0.8), world, limit=0.2, gradients=True)
    assert found.distance[0] == 0.2 and found.link[0] == found.obstacle[0] == -1 and found.gradients[0, 0] == 0
    assert found.distance[1] == pytest.approx(0.1, abs=1e-5) and found.obstacle[1] == 0
    alone = query.clearance(column(0), world, with_world=False)
    assert alone.distance[0] == numpy.inf and alone.link[0] == -1
    none = query.clearance(numpy.zeros((0, 1)), world, gradients=True)
    assert none.distance.shape == (0,) and none.gradients.shape == (0, 1)


@pytest.mark.parametrize("options", [{}, {"resolution": 0.01}])
def test_edges_touch_when_the_ball_does(query, world, options):
    result = morula.robot.MotionResult
    start, end = numpy.array([[0.0], [0.0], [0.0], [-1.0]]), numpy.array([[0.8], [2.0], [-2.0], [0.5]])
    found = query.check_motions(start, end, world, **options)
    assert found.result.tolist() == [result.free, result.touches, result.touches, result.free]
    assert found.time[0] == found.time[3] == 1
    assert found.link.tolist() == [-1, 1, 1, -1] and found.obstacle.tolist() == [-1, 0, 1, -1]
    assert found.other_link.tolist() == [-1] * 4
    for edge, first in ((1, 0.9 / 2), (2, 1.4 / 2)):
        at = found.time[edge]
        assert at >= first - 1e-5
        # The configuration at that time has the contact.
        x = start[edge] + at * (end[edge] - start[edge])
        assert not query.check(x[None], world).free[0]
    assert query.check_motions(start, end, world, workers=morula.Workers(2), **options) == found
    assert (query.check_motions(start, end, world, with_world=False, **options).result == result.free).all()


def test_verdicts_name_what_touches(query, world):
    found = query.check(column(0, 1.0, -1.5), world)
    assert found.free.tolist() == [True, False, False] and found.link.tolist() == [-1, 1, 1]
    assert found.obstacle.tolist() == [-1, 0, 1] and found.other_link.tolist() == [-1] * 3
    assert query.check(column(0, 1.0, -1.5).astype(numpy.float32), world, workers=morula.Workers(2)) == found
    assert query.check_self(column(0, 1.0)).free.all()


def test_objects_and_allowed_contacts(slider, world):
    query = morula.robot.ConfigurationQuery(*slider)
    query.attach("ball", numpy.array([[0.4, 0, 0, radius]]))
    kept = copy.deepcopy(query)
    assert query.check(column(0.4, 0.6), world).free.tolist() == [True, False]
    query.attach("ball", numpy.array([[0.4, 0, 0, radius]]), touching_obstacles=[0])
    assert query.check(column(0.6, 0.95), world).free.tolist() == [True, False]
    query.allow_contacts("ball", [0])
    assert query.check(column(0.95, -1.5), world).free.tolist() == [True, False]
    assert query.check_motions(column(0.95), column(2), world).result[0] == morula.robot.MotionResult.free
    near = query.clearance(column(0.95), world)
    assert near.obstacle[0] == 1 and near.distance[0] == pytest.approx(0.95 + 2 - 0.5 - radius, abs=1e-5)
    query.detach("ball")
    query.allow_contacts("ball", [])
    assert query.check(column(0.6, 0.95), world).free.tolist() == [True, False]
    assert kept.check(column(0.4, 0.6), world).free.tolist() == [True, False]
    for call in (lambda: query.detach("nobody"), lambda: query.allow_contacts("nobody", [0])):
        with pytest.raises(ValueError, match="there is no link nobody"):
            call()


def test_copies_of_worlds_are_independent(world):
    for made in (copy.copy(world), copy.deepcopy(world)):
        made.add((9, 9, 9, 1))
        assert len(made) == 3 and len(world) == 2
        assert repr(made) == "World(obstacles=<3>)"


def test_worlds_say_what_they_cannot_use():
    world = morula.robot.World()
    with pytest.raises(TypeError, match="add_mesh"):
        world.add(morula.sample_body("blob"))
    points = numpy.zeros((5, 3))
    points[3, 1] = numpy.nan
    with pytest.raises(ValueError, match="number 3"):
        world.add_points(points, 0.01)


def test_help_shows_the_classes():
    shown = pydoc.plain(pydoc.render_doc(morula.robot))
    assert "class ConfigurationQuery" in shown and "class World" in shown and "FUNCTIONS" in shown
    assert sorted(morula.robot.__all__) == sorted(set(morula.robot.__all__))


def places_of_two_bars(values):
    """Centers of the balls at the middle and end of a bar of length 1, and at the end of a second one: (n, 3, 2)."""
    first, second = values[:, 0], values.sum(axis=1)
    along = numpy.stack([numpy.cos(first), numpy.sin(first)], axis=-1)
    on = numpy.stack([numpy.cos(second), numpy.sin(second)], axis=-1)
    return numpy.stack([0.5 * along, along, along + 0.8 * on], axis=1)


def test_edges_of_two_bars_are_free_where_all_configurations_are(tmp_path):
    """The gap of every sampled configuration, by sines and cosines, against verdicts of edges of all lengths."""
    at = "<origin xyz='{} 0 0'/><geometry><sphere radius='0.1'/></geometry>"
    ball = "<collision>" + at + "</collision>"
    joint = "<joint name='{0}' type='continuous'><parent link='{1}'/><child link='{2}'/><origin xyz='{3} 0 0'/><axis xyz='0 0 1'/></joint>"
    file = tmp_path / "bars.urdf"
    file.write_text(
        "<robot name='bars'><link name='base'/>"
        f"<link name='one'>{ball.format(0.5)}{ball.format(1)}</link><link name='two'>{ball.format(0.8)}</link>"
        + joint.format("a", "base", "one", 0)
        + joint.format("b", "one", "two", 1)
        + "</robot>"
    )
    robot = morula.robot.read_robot(file)
    spheres = morula.robot.fit_spheres(robot, spheres=2)
    fitted = numpy.concatenate([link.spheres for link in spheres.links])
    numpy.testing.assert_allclose(numpy.sort(fitted[:, 0]), [0.5, 0.8, 1], atol=1e-5)
    radii = fitted[numpy.argsort(fitted[:, 0])][[0, 2, 1], 3]
    world, obstacles = morula.robot.World(), numpy.array([[1.2, 0.9], [-0.8, -0.9], [-0.2, 1.5]])
    for x, y in obstacles:
        world.add((x, y, 0, 0.15))
    query = morula.robot.ConfigurationQuery(robot, spheres)
    assert query.check_self(numpy.zeros((1, 2))).free[0]
    random = numpy.random.default_rng(5)
    start, end = random.uniform(-3, 3, (2, 200, 2))
    end[::2] = start[::2] + 0.1 * (end[::2] - start[::2])
    tolerance = 1e-3
    found = query.check_motions(start, end, world, tolerance=tolerance)
    result = morula.robot.MotionResult
    share = numpy.linspace(0, 1, 4000)
    for edge in range(len(start)):
        values = start[edge] + share[:, None] * (end[edge] - start[edge])
        places = places_of_two_bars(values)
        gaps = (numpy.linalg.norm(places[:, :, None] - obstacles, axis=-1) - 0.15 - radii[:, None]).min(axis=(1, 2))
        # The second bar's ball and the first one's middle.
        own = numpy.linalg.norm(places[:, 2] - places[:, 0], axis=1) - radii[2] - radii[0]
        gaps = numpy.minimum(gaps, own)
        time = found.time[edge]
        if found.result[edge] == result.free:
            assert gaps.min() > 0
        elif found.result[edge] == result.touches:
            assert gaps[share < time].min(initial=1) > -2 * tolerance
            assert not query.check((start[edge] + time * (end[edge] - start[edge]))[None], world).free[0]
            assert gaps[numpy.abs(share - time).argmin()] < 0.01
        else:
            assert abs(gaps[numpy.abs(share - time).argmin()]) < 0.01
    counts = numpy.bincount(found.result, minlength=3)
    assert counts[0] > 40 and counts[1] > 40 and counts[2] < 10


def test_edges_near_a_contact_are_not_called_touching(query, world):
    # 0.001 from the wall.
    edge = column(0.899), column(0.5)
    assert query.check_motions(*edge, world, tolerance=1e-4).result[0] == morula.robot.MotionResult.free
    near = query.check_motions(*edge, world, tolerance=0.01)
    assert near.result[0] in (morula.robot.MotionResult.free, morula.robot.MotionResult.undecided)
    assert query.clearance(edge[0], world).distance[0] == pytest.approx(0.001, abs=1e-5)


def test_wrong_arguments_of_planners_queries(query, world):
    for wrong in (numpy.zeros(3), numpy.zeros((2, 2))):
        with pytest.raises((TypeError, ValueError), match="configurations"):
            query.clearance(wrong, world)
        with pytest.raises((TypeError, ValueError), match="start"):
            query.check_motions(wrong, column(0), world)
        with pytest.raises((TypeError, ValueError), match="end"):
            query.check_motions(column(0), wrong, world)
    with pytest.raises(ValueError, match="end: "):
        query.check_motions(column(0), column(0, 1), world)
    with pytest.raises(ValueError):
        query.clearance(column(0), world, limit=0)
    for options in ({"tolerance": 0}, {"resolution": -1}):
        with pytest.raises(ValueError):
            query.check_motions(column(0), column(1), world, **options)
    with pytest.raises(ValueError):
        query.clearance(column(numpy.nan), world)


def test_arrays_of_any_layout_and_number_type(query, world):
    x = numpy.linspace(-3, 3, 37)
    expected = query.clearance(column(*x), world).distance.tolist()
    wide = numpy.zeros((74, 3))
    wide[::2, 1] = x
    backward = x[::-1].copy()[::-1, None]
    for given in (wide[::2, 1:2], backward, numpy.asfortranarray(x[:, None])):
        assert query.clearance(given, world).distance.tolist() == expected
    single = x.astype(numpy.float32)[:, None]
    assert query.clearance(single, world) == query.clearance(single.astype(float), world)
    many = morula.Workers(7)
    for n in (0, 1, 15, 16, 17, 33):
        assert query.clearance(x[:n, None], world, workers=many).distance.tolist() == expected[:n]


# A thread that adds a large mesh needs the GIL now and then, to look for signals.
waiting = """
import threading
import numpy
import morula
steps = numpy.linspace(0, 1, 400)
x, y = numpy.meshgrid(steps, steps)
points = numpy.stack([x, y, numpy.sin(9 * x) * numpy.cos(7 * y)], axis=-1).reshape(-1, 3)
k, i = numpy.mgrid[:399, :399].reshape(2, -1)
a = 400 * k + i
facets = numpy.concatenate([numpy.stack([a, a + 1, a + 401], 1), numpy.stack([a, a + 401, a + 400], 1)])
world = morula.robot.World()
adding = threading.Thread(target=lambda: world.add_mesh((points, facets)))
adding.start()
while adding.is_alive():
    len(world)
assert len(world) == 1
"""


def test_a_wait_for_a_world_does_not_stop_the_thread_that_changes_it():
    subprocess.run([sys.executable, "-c", waiting], check=True, timeout=120)


def test_rates_of_false_self_collisions_of_two_sliding_blocks(tmp_path):
    """Blocks that slide past each other, 0.1 apart: their shapes never collide, their single spheres do near the middle."""
    file = tmp_path / "blocks.urdf"
    block = "<collision><geometry><box size='1 1 1'/></geometry></collision>"
    file.write_text(
        f"<robot name='blocks'><link name='base'>{block}</link><link name='rail'/><link name='block'>{block}</link>"
        "<joint name='up' type='fixed'><parent link='base'/><child link='rail'/><origin xyz='0 0 1.1'/></joint>"
        "<joint name='slide' type='prismatic'><parent link='rail'/><child link='block'/><axis xyz='1 0 0'/>"
        "<limit lower='-4' upper='4' effort='1' velocity='1'/></joint></robot>"
    )
    robot = morula.robot.read_robot(file)
    spheres = morula.robot.fit_spheres(robot, spheres=1)
    shares = []
    rates = morula.robot.self_collision_rates(robot, spheres, samples=4000, progress=shares.append)
    a, b = (link.spheres[0] for link in spheres.links)
    half = numpy.sqrt((a[3] + b[3]) ** 2 - 1.1**2)
    assert rates.samples == 4000 and rates.surfaces == 0 and rates.false_share == rates.spheres
    assert rates.spheres == pytest.approx(half / 4, abs=0.04)
    assert [(p.a, p.b) for p in rates.pairs] == [(0, 2)] and rates.pairs[0].false_share == rates.false_share
    assert shares and shares[-1] == 1
    assert morula.robot.self_collision_rates(robot, spheres, samples=4000, workers=morula.Workers(2)) == rates
    with pytest.raises(ValueError):
        morula.robot.self_collision_rates(robot, spheres, samples=0)
    fit = morula.robot.fit_for_self_collision(robot, max_total=4, samples=200)
    assert fit.spheres.covered and fit.spheres.sphere_count <= fit.total == 4
    assert fit.rates.false_share <= fit.evenly.false_share
    assert [step.spheres for step in fit.steps] == sorted(step.spheres for step in fit.steps)
    falling = [step.false_share for step in fit.steps]
    assert falling == sorted(falling, reverse=True)
