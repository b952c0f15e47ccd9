# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The collector of reference cycles sees all that objects of the extension keep of Python, each reference once."""

import gc
import sys
import weakref

import numpy
import pytest

import morula


class Mesh(morula.Mesh):
    pass


class CoveredTree(morula.CoveredTree):
    pass


class Body(morula.Body):
    pass


class RebuiltBody(morula.RebuiltBody):
    pass


class PosedSpheres(morula.PosedSpheres):
    pass


class Collider(morula.Collider):
    pass


class SurfaceTree(morula.SurfaceTree):
    pass


class DistanceField(morula.DistanceField):
    pass


class Callback:
    def __call__(self, *arguments):
        return True


def a_mesh():
    plain = morula.sample_body("limb", 8)
    return Mesh(plain.positions, plain.facets)


def a_tree(mesh):
    plain = morula.build(mesh, method="octree", depth=1)
    return CoveredTree(plain.tree, plain.cover)


def a_body():
    mesh = morula.sample_body("limb", 8)
    return Body(mesh, morula.build(mesh, method="octree", depth=1))


def a_surface():
    return SurfaceTree(morula.sample_body("limb", 8))


def a_step():
    mesh = morula.sample_body("limb", 8)
    surface = SurfaceTree(mesh)
    surface.update(mesh.positions, mesh.positions)
    return surface


def some_spheres():
    return PosedSpheres(morula.build(morula.sample_body("limb", 8), method="octree", depth=1).tree)


def cube():
    return morula.ConvexHull.box((0, 0, 0), (1, 1, 1))


def contact_query(a, b):
    query = morula.ContactQuery()
    query.add(a, b)
    return query


def scene_of(collider):
    scene = morula.Scene()
    scene.add(collider)
    return scene


def replaced(collider):
    scene = morula.Scene()
    scene.replace(scene.add(Collider(a_body())), collider)
    return scene


def run(query, *seen):
    query.run(*seen)
    return query


def following(collider):
    surface = morula.SurfaceTree(morula.sample_body("limb", 8))
    surface.follow(collider)
    return surface


def of_mesh(mesh):
    return mesh, morula.build(mesh, method="octree", depth=1)


def collider_of_spheres(mesh, tree, spheres):
    return morula.Collider(mesh, tree, spheres)


#: What keeps what: a function that makes the keeper, and functions that make what is kept.
KEEPERS = {
    "Body of a mesh": (lambda mesh: morula.Body(*of_mesh(mesh)), a_mesh),
    "Body of a tree": (lambda tree: morula.Body(morula.sample_body("limb", 8), tree), lambda: a_tree(morula.sample_body("limb", 8))),
    "copy of a Body": (lambda mesh: morula.Body(*of_mesh(mesh)).__copy__(), a_mesh),
    "RebuiltBody of a mesh": (lambda mesh: morula.RebuiltBody(*of_mesh(mesh), thread="none"), a_mesh),
    "Collider of a Body": (morula.Collider, a_body),
    "Collider of a RebuiltBody": (
        morula.Collider, lambda: RebuiltBody(*of_mesh(morula.sample_body("limb", 8)), thread="none")),
    "Collider of PosedSpheres": (morula.Collider, some_spheres),
    "Collider of a mesh and spheres": (
        lambda mesh: (lambda tree: collider_of_spheres(mesh, tree, morula.PosedSpheres(tree.tree)))(of_mesh(mesh)[1]), a_mesh),
    "SpheresView of a Body": (lambda body: body.spheres, a_body),
    "ContactQuery of Colliders": (contact_query, lambda: Collider(a_body()), lambda: Collider(a_body())),
    "InsideQuery of a Collider": (morula.InsideQuery, lambda: Collider(a_body())),
    "InsideQuery of a Body": (morula.InsideQuery, a_body),
    "ContactPatchQuery of Colliders": (morula.ContactPatchQuery, lambda: Collider(a_body()), lambda: Collider(a_body())),
    "PenetrationQuery of Colliders": (morula.PenetrationQuery, lambda: Collider(a_body()), lambda: Collider(a_body())),
    "PenetrationQuery of Bodies": (morula.PenetrationQuery, a_body, a_body),
    "SurfaceTree that follows a Collider": (following, lambda: Collider(a_body())),
    "SurfaceTree that follows a Body": (following, a_body),
    "ProximityQuery of surfaces": (lambda a, b: run(morula.ProximityQuery(distance=0.01), a, b), a_surface, a_surface),
    "SweptQuery of surfaces": (lambda a, b: run(morula.SweptQuery(), a, b), a_step, a_step),
    "SurfaceCrossingQuery of surfaces": (lambda a, b: run(morula.SurfaceCrossingQuery(), a, b), a_surface, a_surface),
    "LayerPatchQuery of surfaces": (lambda a, b: run(morula.LayerPatchQuery(thickness=0.01), a, b), a_surface, a_surface),
    "ProximityQuery of a function": (lambda f: morula.ProximityQuery(distance=0.1, accepts=f), Callback),
    "SweptQuery of a function": (lambda f: morula.SweptQuery(accepts=f), Callback),
    "SurfaceCrossingQuery of a function": (lambda f: morula.SurfaceCrossingQuery(accepts=f), Callback),
    "LayerPatchQuery of a function": (lambda f: morula.LayerPatchQuery(thickness=0.1, accepts=f), Callback),
    "ObstacleQuery of a function": (lambda f: morula.ObstacleQuery(accepts=f), Callback),
    "SweptObstacleQuery of a function": (lambda f: morula.SweptObstacleQuery(accepts=f), Callback),
    "ObstacleQuery of a surface": (lambda surface: run(morula.ObstacleQuery(), surface, cube()), a_surface),
    "SweptObstacleQuery of a surface": (lambda surface: run(morula.SweptObstacleQuery(), surface, cube()), a_step),
    "ObstacleQuery of a field": (
        lambda field: run(morula.ObstacleQuery(), a_surface(), field), lambda: DistanceField(lambda p: 1.0)),
    "DistanceField of functions": (lambda value, gradient: morula.DistanceField(value, gradient=gradient), Callback, Callback),
    "Scene of a function": (lambda f: morula.Scene(accepts=f), Callback),
    "Scene of a Collider": (scene_of, lambda: Collider(a_body())),
    "Scene of a Body": (scene_of, a_body),
    "Scene of a Collider that took another's place": (replaced, lambda: Collider(a_body())),
}


def reached(keeper, wanted):
    """How often what the collector finds from `keeper`, down objects of the extension alone, is `wanted`."""
    count, seen, todo = 0, set(), [keeper]
    while todo:
        one = todo.pop()
        for found in gc.get_referents(one):
            count += found is wanted
            if type(found).__module__.startswith("morula.") and not isinstance(found, type) and id(found) not in seen:
                seen.add(id(found))
                todo.append(found)
    return count


@pytest.mark.parametrize("name", KEEPERS)
def test_cycles_are_collected(name):
    make, *parts = KEEPERS[name]
    for which in range(len(parts)):
        gone = []
        for _ in range(20):
            kept = [part() for part in parts]
            # An attribute of what is kept leads back to its keeper.
            kept[which].keeper = make(*kept)
            gone += [weakref.ref(one) for one in kept]
            del kept
        gc.collect()
        assert [alive() for alive in gone] == [None] * len(gone)


@pytest.mark.parametrize("name", KEEPERS)
def test_each_reference_is_reported_once(name):
    make, *parts = KEEPERS[name]
    kept = [part() for part in parts]
    before = [sys.getrefcount(one) for one in kept]
    keeper = make(*kept)
    gc.collect()
    after = [sys.getrefcount(one) for one in kept]
    held = [more - less for more, less in zip(after, before)]
    assert min(held) > 0
    assert [reached(keeper, one) for one in kept] == held
    del keeper
    gc.collect()
    assert [sys.getrefcount(one) for one in kept] == before


@pytest.mark.parametrize("name", KEEPERS)
def test_what_is_in_use_is_left_alone(name):
    make, *parts = KEEPERS[name]
    kept = [part() for part in parts]
    keeper = make(*kept)
    gone = [weakref.ref(one) for one in kept]
    del kept
    for _ in range(3):
        gc.collect()
    assert all(alive() is not None for alive in gone)
    del keeper


def test_functions_of_objects_do_not_keep_them():
    class Simulation:
        def __init__(self):
            self.size = numpy.zeros(100000)
            self.surface = a_surface()
            self.query = morula.ProximityQuery(distance=0.1, accepts=self.keep)
            self.swept = morula.SweptQuery(accepts=self.keep)
            self.obstacles = morula.ObstacleQuery(accepts=self.keep)
            self.field = morula.DistanceField(self.distance, gradient=self.direction)
            self.scene = morula.Scene(accepts=self.keep)
            self.query.run(self.surface)
            self.obstacles.run(self.surface, self.field)

        def keep(self, *arguments):
            return True

        def distance(self, point):
            return 1.0

        def direction(self, point):
            return (1, 0, 0)

    gone = [weakref.ref(Simulation()) for _ in range(10)]
    gc.collect()
    assert [alive() for alive in gone] == [None] * len(gone)


def test_scene_that_is_its_own_filter_is_collected():
    class Scene(morula.Scene):
        def keep(self, a, b):
            return True

    class Owner:
        pass

    scene = Scene()
    owner = scene.owner = Owner()
    scene.set_options(accepts=scene.keep)
    gone = weakref.ref(owner)
    del scene, owner
    gc.collect()
    assert gone() is None


def test_pages_are_collected():
    if not hasattr(morula, "PageMotion"):
        pytest.skip("this package was built without the page")

    class Motion(morula.PageMotion):
        pass

    mesh = morula.sample_body("limb", 8)
    tree = morula.build(mesh, method="octree", depth=1).tree
    motion = Motion(mesh.facets, mesh.positions[None])
    motion.scene = morula.PageScene(motion, tree)
    gone = weakref.ref(motion)
    del motion
    gc.collect()
    assert gone() is None


def test_collecting_while_queries_run_takes_nothing_away(limb, model):
    import threading

    body = morula.Body(limb, model)
    query, others = morula.InsideQuery(body), [morula.SurfaceTree(limb) for _ in range(2)]
    near = morula.ProximityQuery(distance=0.02)
    failures = []

    def ask():
        try:
            for i in range(30):
                near.run(others[i % 2])
                query.inside(limb.positions)
        except Exception as error:  # noqa: BLE001
            failures.append(error)

    threads = [threading.Thread(target=ask) for _ in range(2)]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        gc.collect()
    for thread in threads:
        thread.join()
    assert failures == []
    assert len(near.pairs()) == len(morula.proximity(others[1], distance=0.02))
