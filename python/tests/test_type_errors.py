# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""No call of the package is answered in words of the binding, whatever is wrong with it: all functions, methods,
attributes and classes of the extension are tried, as they are found there."""

import enum
import importlib
import inspect
import pickle
import re
from types import ModuleType

import numpy
import pytest

import morula

MODULES = [morula._morula, *(value for value in vars(morula._morula).values() if isinstance(value, ModuleType))]
#: Words of the binding and of C++ that no message contains.
FOREIGN = re.compile(
    r"nb::|nb_|nanobind|incompatible function|no constructor|std::|morula::|_morula|bad_cast|ndarray\[|0x[0-9a-f]{6}|\\\d")
CLASSES = [
    pytest.param(value, id=f"{module.__name__}.{name}") for module in MODULES for name, value in vars(module).items()
    if isinstance(value, type) and value.__module__ == module.__name__
]


class Thing:
    """Nothing that any function takes."""

    def __repr__(self):
        return "Thing()"


#: Arguments of calls that are wrong for nearly all functions.
CALLS = [([Thing()] * count, {}) for count in range(12)]
CALLS += [([], {"no_such_argument": 1}), ([None] * 3, {}), ([-1] * 2, {}), (["a", "b"], {}), ([numpy.zeros(2)], {}), ([b"a", 1j], {})]


def told(call, *given, **named):
    """The error that a call ends with, or None. Nothing in it is the binding's."""
    try:
        call(*given, **named)
    except Exception as error:  # noqa: BLE001
        said = f"{type(error).__name__}: {error}"
        assert not FOREIGN.search(said), said
        # It says something.
        assert re.search(r"\w{3}.*[ (]", str(error)), said
        return error
    return None


def instances(folder):
    """Of every class that has methods with arguments."""
    mesh = morula.sample_body("limb", 8)
    model = morula.build(mesh, method="octree", depth=1)
    body = morula.Body(mesh, model)
    modes = morula.sample_modes(mesh.positions)
    spheres = model.tree.spheres
    contacts = morula.collide(body, body)
    yield from [
        mesh, model, model.tree, model.cover, body, body.spheres, morula.Collider(body), morula.SurfaceTree(mesh), contacts,
        morula.ContactQuery(), morula.CrossingQuery(), morula.DistanceQuery(), morula.HapticProbe(), morula.HapticTool(spheres[:2]), morula.InsideQuery(body),
        morula.MovingSpheres(),
        morula.PenetrationQuery(body, body), morula.ContactPatchQuery(body, body), morula.ProximityQuery(distance=0.1),
        morula.SweptQuery(),
        morula.SurfaceCrossingQuery(), morula.LayerPatchQuery(thickness=0.1), morula.ObstacleQuery(), morula.SweptObstacleQuery(), morula.Scene(),
        morula.BroadPhase(), morula.BodyId(0, 0), morula.SignedDistance(mesh), morula.TriangleBvh(mesh),
        morula.KDopTree(mesh, model, 14), morula.RebuiltBody(mesh, model, thread="none"), morula.PosedSpheres(model.tree),
        morula.RigidTransform(), morula.ConvexHull.box((0, 0, 0), (1, 1, 1)), morula.LoosenessEstimator(mesh),
        morula.LoosenessMeter(mesh), morula.FitSampler(mesh, interior=10, surface=10), morula.Workers(1), modes,
        morula.sample_skin(mesh.positions), morula.SkinBounds(mesh, morula.sample_skin(mesh.positions), numpy.zeros(mesh.facet_count, int)),
        morula.PowerDiagram(spheres), morula.connectivity(mesh),
        morula.cut_by_power(mesh.positions[:3], spheres[:2]), morula.ModalCertificate(mesh, modes, largest_norm=1e-9),
        morula.MotionWriter(folder / "frames", mesh, 1), morula.SphereFramesWriter(folder / "frames.npz", model.tree, 1),
    ]
    morula.write_mesh(folder / "0.obj", mesh)
    yield morula.Motion(folder / "0.obj", mesh)
    if hasattr(morula, "fit_clump"):
        yield from [morula.fit_clump(mesh, spheres=2, quality="draft"), morula.clump_formats()[0]]
    if hasattr(morula, "PageScene"):
        yield morula.PageScene(morula.PageMotion(mesh.facets, mesh.positions[None]), model.tree)
    if hasattr(morula, "CollidePage"):
        yield morula.CollidePage([body, body])
    if hasattr(morula._morula, "batch_engine"):
        yield morula._morula.batch_engine.Seat()
    if hasattr(morula._morula, "robot"):
        yield from instances_of_robots(folder)


def instances_of_robots(folder):
    file = folder / "ball.urdf"
    file.write_text("<robot name='r'><link name='a'><collision><geometry><sphere radius='1'/></geometry></collision></link></robot>")
    robot = morula.robot.read_robot(file)
    spheres = morula.robot.fit_spheres(robot, spheres=1)
    query = morula.robot.ConfigurationQuery(robot, spheres)
    yield from [robot, spheres, morula.robot.SphereRobot(robot, spheres), query, morula.robot.World(), morula.robot.output_formats()[0]]


@pytest.fixture(scope="module")
def of_class(tmp_path_factory):
    return {type(instance): instance for instance in instances(tmp_path_factory.mktemp("instances"))}


def is_function(value):
    return type(value).__name__ in ("nb_func", "nb_method")


def functions():
    """All functions of the extension as (where it stands, its class or None, the function)."""
    for module in MODULES:
        for name, value in vars(module).items():
            if is_function(value):
                yield pytest.param(f"{name}()", None, value, id=f"{module.__name__}.{name}")
    for case in CLASSES:
        [kind] = case.values
        for name, value in vars(kind).items():
            if is_function(value):
                label = kind.__name__ if name in ("__init__", "__new__") else f"{kind.__name__}.{name}"
                yield pytest.param(f"{label}()", kind, value, id=f"{case.id}.{name}")
            for part in ("fget", "fset"):
                if is_function(getattr(value, part, None)):
                    yield pytest.param(f"{kind.__name__}.{name}", kind, getattr(value, part), id=f"{case.id}.{name}.{part}")


def needs_arguments(function):
    signature = next(line for line in function.__nb_signature__[0][0].splitlines() if line.startswith("def "))
    return re.match(r"def \w*\(self, ", signature)


@pytest.mark.parametrize("label, kind, function", list(functions()))
def test_messages_name_the_function(label, kind, function, of_class):
    firsts = [[]]
    if kind in of_class and type(function).__name__ == "nb_method" and not label == f"{kind.__name__}()":
        firsts.append([of_class[kind]])
    for first in firsts:
        for given, named in CALLS:
            error = told(function, *first, *given, **named)
            if isinstance(error, TypeError):
                assert str(error).startswith(f"{label}: "), error


@pytest.mark.parametrize("kind", CLASSES)
def test_methods_with_arguments_are_tried_with_an_instance(kind, of_class):
    # What is common to records and to what is copied needs none: any other object is taken.
    common = ("__init__", "__new__", "__eq__", "__getitem__", "__setstate__", "__deepcopy__")
    methods = [name for name, value in vars(kind).items() if is_function(value) and name not in common and needs_arguments(value)]
    assert kind in of_class or not methods, methods


def functions_in_python():
    """What the package's own modules define, public ones alone."""
    for name in ("display", "pages", "studies", *morula._MODULES):
        try:
            module = importlib.import_module(f"morula.{name}")
        except ImportError:  # another package is missing
            continue
        for value in vars(module).values():
            if callable(value) and getattr(value, "__module__", "") == module.__name__ and not value.__name__.startswith("_"):
                yield pytest.param(value, id=f"{module.__name__}.{value.__name__}")


@pytest.mark.parametrize("function", list(functions_in_python()))
def test_functions_written_in_python_pass_no_words_of_the_binding_on(function, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for given, named in CALLS[1:]:
        told(function, *given, **named)


def is_made_by_calls(kind):
    return is_function(vars(kind).get("__init__")) or issubclass(kind, (enum.Enum, Exception))


@pytest.mark.parametrize("kind", CLASSES)
def test_calls_of_classes_are_answered_in_words(kind):
    class Derived(Thing if issubclass(kind, enum.Enum) else kind):
        pass

    for given, named in CALLS:
        error = told(kind, *given, **named)
        told(Derived, *given, **named)
        if not is_made_by_calls(kind):
            assert isinstance(error, TypeError) and str(error).startswith(f"{kind.__name__}(): the class cannot be called: ")


@pytest.mark.parametrize("kind", [case for case in CLASSES if not is_made_by_calls(case.values[0])])
def test_a_class_that_cannot_be_called_says_where_its_instances_come_from(kind):
    said = str(told(kind))
    named = re.findall(r"[\w.]*\w", said.partition("cannot be called: ")[2])
    sources = [name for name in named if "." in name]
    assert 1 <= len(sources) <= 3, said
    for source in sources:
        owner, _, name = source.rpartition(".")
        value = vars(morula)["robot"] if owner == "morula.robot" else morula if owner == "morula" else None
        if value is None:
            [value] = [case.values[0] for case in CLASSES if case.values[0].__name__ == owner]
        member = inspect.getattr_static(value, name)
        assert kind.__name__ in (getattr(member, "fget", None) or member).__nb_signature__[0][0], source
    for make in (lambda: kind.__new__(kind), lambda: object.__new__(kind)):
        if not hasattr(kind, "__setstate__"):
            assert isinstance(told(make), TypeError)
    # Its type is not told that it could be called.
    assert not is_function(vars(kind).get("__init__")) and not is_function(vars(kind).get("__new__"))


def test_reports_are_unpickled_though_their_class_cannot_be_called():
    model = morula.build(morula.sample_body("limb", 8), method="octree", depth=1)
    assert pickle.loads(pickle.dumps(model.report)) == model.report


def test_contacts_come_from_collide():
    assert str(told(morula.Contacts)).startswith("Contacts(): the class cannot be called: morula.collide(), ContactQuery.run() or ")
    clumps = " or what morula.fit_clump() is given as progress" if hasattr(morula, "fit_clump") else ""
    assert str(told(morula.BuildProgress)).endswith(f"what morula.build() is given as progress{clumps} gets one")


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_derived_classes_that_make_nothing_are_told():
    class Hollow(morula.Body):
        def __init__(self):
            pass

    mesh = morula.sample_body("limb", 8)
    assert str(told(Hollow().update, mesh.positions)) == (
        "Body.update(): self has nothing in it: __init__() of a derived class has to call super().__init__()")
