# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Meshes that are arrays: every function takes them, in any layout, with the results of the morula.Mesh of the same
numbers; those that the library can read where they are it does not copy, and nobody keeps them after the call."""

import gc
import os
import re
import subprocess
import sys
import types

import numpy
import pytest

import morula


class Parts:
    """A mesh and what calls on it need."""

    def __init__(self, mesh, folder):
        self.mesh, self.folder = mesh, folder
        self.model = morula.build(mesh, method="octree", depth=2)
        self.distance = morula.SignedDistance(mesh)
        self.modes = morula.sample_modes(mesh.positions)
        self.frames = numpy.stack([mesh.positions, numpy.asarray(mesh.positions) * (1, 1.5, 1)])
        self.order = numpy.arange(mesh.vertex_count, dtype=numpy.uint32)[::-1]
        for name, data in (("modes.npy", self.modes.displacements), ("motion.npy", self.frames),
                           ("skin.npy", numpy.full((mesh.vertex_count, 2), 0.5))):
            numpy.save(folder / name, data)
        morula.write_tree(folder / "tree.morula", self.model)

    def written(self, write):
        """The bytes of a file that a call writes."""
        path = self.folder / "written.npy"
        write(path)
        return path.read_bytes()

    def collider(self, mesh):
        return morula.Collider(mesh, self.model, morula.PosedSpheres(self.model.tree))


def followed(body, parts):
    body.update(parts.frames[1])
    return body.copy_spheres()


def with_writer(path, mesh, parts):
    with morula.MotionWriter(path, mesh, 2) as writer:
        for frame in parts.frames:
            writer.write(frame)


def mesh_file(mesh, parts):
    path = parts.folder / "written.ply"
    morula.write_mesh(path, mesh)
    return path.read_bytes()


def shown(mesh, parts):
    scene = morula.show_spheres(page_motion(parts), mesh, parts.model.tree, numpy.stack([parts.model.spheres] * 2), measured=True)
    return repr(scene), scene.measured


def page_motion(parts):
    return morula.PageMotion(parts.mesh.facets, parts.frames)


#: Every function that takes a mesh, by name: f(mesh, parts).
CALLS = {
    "automatic_depth": lambda mesh, parts: morula.automatic_depth(mesh),
    "border_loops": lambda mesh, parts: morula.border_loops(mesh),
    "bounding_box": lambda mesh, parts: morula.bounding_box(mesh),
    "build": lambda mesh, parts: [
        morula.build(mesh, depth=2, **options) for options in ({"method": "octree"}, {"method": "grid"}, {"quality": "draft"})],
    "component_vertices": lambda mesh, parts: morula.component_vertices(mesh),
    "components_by_edges": lambda mesh, parts: morula.components_by_edges(mesh),
    "components_by_vertices": lambda mesh, parts: morula.components_by_vertices(mesh),
    "connectivity": lambda mesh, parts: morula.connectivity(mesh),
    "cover": lambda mesh, parts: morula.cover(mesh, parts.model.tree),
    "coverage": lambda mesh, parts: [
        morula.coverage(mesh, parts.model.spheres[3:]), morula.coverage(mesh, parts.model.spheres, positions=parts.frames[1])],
    "deform": lambda mesh, parts: morula.deform(mesh, morula.Bend(40), morula.Noise(0.1, 0.5)),
    "deform_frames": lambda mesh, parts: morula.deform_frames(mesh, morula.Twist(40), frame_count=3),
    "fit_clump": lambda mesh, parts: morula.fit_clump(mesh, spheres=4, quality="draft"),
    "follow_motion": lambda mesh, parts: repr(morula.follow_motion(page_motion(parts), mesh, parts.model)),
    "inner_ball_candidates": lambda mesh, parts: morula.inner_ball_candidates(mesh, parts.distance, candidates=50),
    "inspect": lambda mesh, parts: morula.inspect(mesh),
    "looseness": lambda mesh, parts: morula.looseness(mesh, parts.model.spheres, resolution=24),
    "measure": lambda mesh, parts: morula.measure(mesh, parts.model, resolution=24),
    "measure_spheres": lambda mesh, parts: morula.measure_spheres(mesh, parts.model.spheres, resolution=24),
    "mesh_hash": lambda mesh, parts: morula.mesh_hash(mesh),
    "nonmanifold_vertices": lambda mesh, parts: morula.nonmanifold_vertices(mesh),
    "page_html": lambda mesh, parts: morula.page_html(mesh, parts.model),
    "principal_strains": lambda mesh, parts: morula.principal_strains(mesh),
    "read_covered_tree": lambda mesh, parts: morula.read_covered_tree(parts.folder / "tree.morula", mesh),
    "read_modes": lambda mesh, parts: morula.read_modes(parts.folder / "modes.npy", mesh).displacements,
    "read_motion": lambda mesh, parts: morula.read_motion(parts.folder / "motion.npy", mesh),
    "read_skin": lambda mesh, parts: morula.read_skin(parts.folder / "skin.npy", mesh).weights,
    "renumbered": lambda mesh, parts: morula.renumbered(parts.model, mesh, parts.order),
    "repair": lambda mesh, parts: morula.repair(mesh),
    "sample_surface": lambda mesh, parts: morula.sample_surface(mesh, 50),
    "show_spheres": shown,
    "signed_volume": lambda mesh, parts: morula.signed_volume(mesh),
    "surface_area": lambda mesh, parts: morula.surface_area(mesh),
    "used_vertices": lambda mesh, parts: morula.used_vertices(mesh),
    "weld_vertices": lambda mesh, parts: morula.weld_vertices(mesh).new_vertex,
    "welded": lambda mesh, parts: morula.welded(mesh, morula.weld_vertices(parts.mesh)),
    "with_fewer_cuts": lambda mesh, parts: morula.with_fewer_cuts(mesh, parts.model),
    "with_known_poses": lambda mesh, parts: morula.with_known_poses(
        mesh, parts.model, [("long", parts.frames[1])], quality="draft", pose_threshold=1.01)[0],
    "write_mesh": mesh_file,
    "write_motion": lambda mesh, parts: parts.written(lambda path: morula.write_motion(path, mesh, parts.frames)),
    "Body.__init__": lambda mesh, parts: followed(morula.Body(mesh, parts.model), parts),
    "Collider.__init__": lambda mesh, parts: parts.collider(mesh).vertices(),
    "CoveredTree.validate": lambda mesh, parts: parts.model.validate(mesh),
    "FitSampler.__init__": lambda mesh, parts: morula.FitSampler(mesh, interior=50, surface=50).measure(parts.model.spheres),
    "KDopTree.__init__": lambda mesh, parts: morula.KDopTree(mesh, parts.model, 6).hash(),
    "LoosenessEstimator.__init__": lambda mesh, parts: morula.LoosenessEstimator(mesh).estimate(
        morula.Body(parts.mesh, parts.model), parts.mesh.positions),
    "LoosenessMeter.__init__": lambda mesh, parts: morula.LoosenessMeter(mesh).measure(
        parts.mesh.positions, parts.model.spheres, resolution=24),
    "Mesh.of": lambda mesh, parts: morula.Mesh.of(mesh),
    "ModalCertificate.__init__": lambda mesh, parts: morula.ModalCertificate(mesh, parts.modes, largest_norm=1e-3).free_norm,
    "Motion.__init__": lambda mesh, parts: list(morula.Motion(parts.folder / "motion.npy", mesh)),
    "MotionWriter.__init__": lambda mesh, parts: parts.written(lambda path: with_writer(path, mesh, parts)),
    "RebuiltBody.__init__": lambda mesh, parts: followed(morula.RebuiltBody(mesh, parts.model, thread="none"), parts),
    "SignedDistance.__init__": lambda mesh, parts: morula.SignedDistance(mesh)(parts.mesh.positions[:20] * 1.1),
    "SkinBounds.__init__": lambda mesh, parts: list(morula.SkinBounds(
        mesh, numpy.ones((len(parts.mesh.positions), 1)), numpy.arange(len(parts.mesh.facets)) // 50).bounds(
            numpy.eye(4)[None, :3])),
    "SurfaceTree.__init__": lambda mesh, parts: morula.SurfaceTree(mesh).hash(),
    "TriangleBvh.__init__": lambda mesh, parts: morula.TriangleBvh(mesh).closest_points(parts.mesh.positions[:20] * 1.1),
}
MISSING = {name for name in CALLS if "." not in name and not hasattr(morula._morula, name)}  # extras that were not built


def takes_a_mesh(function):
    return "morula.typing.MeshLike" in (getattr(function, "__doc__", None) or "")


def test_every_function_that_takes_a_mesh_is_tried():
    found = set()
    for name, value in vars(morula._morula).items():
        if isinstance(value, type):
            found |= {f"{name}.{member}" for member in vars(value) if takes_a_mesh(getattr(value, member))}
        elif isinstance(value, types.ModuleType):
            found |= {f"{name}.{member}" for member, one in vars(value).items() if takes_a_mesh(one)}
        elif takes_a_mesh(value):
            found.add(name)
    assert len(found) > 40 and found == set(CALLS) - MISSING


def plain(result):
    """A result as what can be compared bit for bit."""
    if isinstance(result, numpy.ndarray):
        return result.dtype.str, result.shape, result.tobytes()
    if isinstance(result, morula.CoveredTree):
        return plain([result.spheres, result.tree, result.cover, result.report.mesh_hash, [[pose.name, pose.positions, pose.model] for pose in result.poses]])
    if isinstance(result, (morula.SphereTree, morula.Cover, morula.Mesh, morula.RigidTransform)):
        return plain(result.__reduce__()[1])
    if isinstance(result, (list, tuple)):
        return [plain(part) for part in result]
    if isinstance(result, dict):
        return {name: plain(part) for name, part in result.items()}
    if hasattr(result, "to_dict"):
        return plain({name: value for name, value in result.to_dict().items() if not name.endswith("seconds")})
    assert result is None or isinstance(result, (bool, int, float, str, bytes)), result
    return repr(result)


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    # Numbers that single precision holds, so that arrays of both are one mesh.
    body = morula.sample_body("limb", 12)
    mesh = morula.Mesh(body.positions.astype(numpy.float32), body.facets)
    return Parts(mesh, tmp_path_factory.mktemp("parts"))


@pytest.fixture(scope="module")
def expected(parts):
    return {name: plain(call(parts.mesh, parts)) for name, call in CALLS.items() if name not in MISSING}


def in_wide_rows(array):
    wide = numpy.full((len(array), 7), 9, array.dtype)
    wide[:, 2:5] = array
    return wide[:, 2:5]


def misaligned(array):
    memory = bytearray(array.nbytes + 1)
    copy = numpy.frombuffer(memory, array.dtype, offset=1).reshape(array.shape)
    copy[:] = array
    assert not copy.flags.aligned
    return copy


def read_only(array):
    array = array.copy()
    array.flags.writeable = False
    return array


def of_a_buffer(array):
    return memoryview(array.copy())


#: Layouts of an array of rows of three.
LAYOUTS = {
    "C order": numpy.ascontiguousarray, "wide rows": in_wide_rows, "every second row": lambda array: numpy.repeat(array, 2, axis=0)[::2],
    "Fortran order": numpy.asfortranarray, "backwards": lambda array: array[::-1].copy()[::-1], "read-only": read_only,
    "misaligned": misaligned, "of a buffer": of_a_buffer,
}


@pytest.mark.parametrize("integer", [numpy.int32, numpy.uint32])
@pytest.mark.parametrize("real", [numpy.float32, numpy.float64])
@pytest.mark.parametrize("name", [name for name in CALLS if name not in MISSING])
def test_arrays_give_the_results_of_the_mesh(name, real, integer, parts, expected):
    arrays = parts.mesh.positions.astype(real), parts.mesh.facets.astype(integer)
    assert plain(CALLS[name](arrays, parts)) == expected[name]


QUICK = ["mesh_hash", "signed_volume", "Mesh.of", "connectivity", "SurfaceTree.__init__", "Body.__init__"]


@pytest.mark.parametrize("layout", LAYOUTS)
def test_any_layout_gives_the_same_results(layout, parts, expected):
    for real in (numpy.float32, numpy.float64):
        arrays = LAYOUTS[layout](parts.mesh.positions.astype(real)), parts.mesh.facets
        for name in QUICK:
            assert plain(CALLS[name](arrays, parts)) == expected[name]
    for integer in (numpy.int16, numpy.uint16, numpy.int32, numpy.uint32, numpy.int64, numpy.uint64):
        arrays = parts.mesh.positions, LAYOUTS[layout](parts.mesh.facets.astype(integer))
        for name in QUICK:
            assert plain(CALLS[name](arrays, parts)) == expected[name]


def test_objects_with_attributes_give_the_same_results(parts, expected):
    class Block:
        def __init__(self, data, kind="triangle"):
            self.type, self.data = kind, data

    class Solver:
        vertices, faces = parts.mesh.positions.astype(numpy.float32), parts.mesh.facets.astype(numpy.int32)

    class Cells:
        points, cells_dict = parts.mesh.positions, {}
        cells = [Block(numpy.zeros((1, 2), int), "line"), Block(parts.mesh.facets.astype(numpy.int32))]

    class SeveralCells(Cells):
        cells = [Block(parts.mesh.facets[:100].astype(numpy.int64)), Block(parts.mesh.facets[100:])]

    for given in (Solver(), Cells(), SeveralCells()):
        for name in QUICK:
            assert plain(CALLS[name](given, parts)) == expected[name]


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are Linux's")
def test_arrays_that_can_be_read_are_not_copied():
    # The process may reserve 6 MiB more than it has: a copy of any large array below needs 12 at least.
    program = """
import resource, numpy, morula
rows = 1 << 20
positions = [numpy.zeros((rows, 3), numpy.float32), numpy.zeros((rows, 3)), numpy.zeros((rows, 4), numpy.float32)[:, :3]]
facets = [numpy.zeros((rows, 3), integer) for integer in (numpy.uint32, numpy.int32)]
frozen = facets[0].view()
frozen.flags.writeable = False
few, one = numpy.eye(3), numpy.array([[0, 1, 2]], numpy.int32)
class Solver:
    vertices, faces = positions[0], one
copied = [(few, numpy.zeros((rows, 3), numpy.int64)), (few, numpy.zeros((3, rows), numpy.uint32).T), (positions[1][:, ::-1], one)]
calls = [morula.surface_area, morula.signed_volume, morula.bounding_box, morula.mesh_hash]
[call((few, one)) for call in calls]
size = int(open('/proc/self/statm').read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (size + (6 << 20),) * 2)
for mesh in [(x, one) for x in positions] + [(few, f) for f in [*facets, frozen]] + [Solver()]:
    [call(mesh) for call in calls]
print('read')
for mesh in copied:
    try:
        morula.surface_area(mesh)
    except MemoryError:
        print('copied')
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=600,
                          env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
    assert (done.stdout, done.stderr) == ("read\n" + 3 * "copied\n", "")


#: Objects that outlive their mesh, by name: a function that makes the object, and one that returns its later results.
KEEPERS = {
    "Body": (lambda mesh, parts: morula.Body(mesh, parts.model), lambda body, parts: [
        body.copy_spheres(), body.mesh, morula.estimate_looseness(body, parts.frames[1]), morula.Collider(body).vertices(),
        followed(body, parts), body.__copy__().mesh]),
    "RebuiltBody": (lambda mesh, parts: morula.RebuiltBody(mesh, parts.model, thread="caller", rebuild_every=2),
                    lambda body, parts: [morula.Collider(body).vertices()] + [followed(body, parts) for _ in range(4)]),
    "Collider of a Body": (
        lambda mesh, parts: morula.Collider(morula.Body(mesh, parts.model)), lambda collider, parts: collider.vertices()),
    "Collider of spheres": (lambda mesh, parts: parts.collider(mesh), lambda collider, parts: [
        collider.vertices(), morula.crossings(collider, crossing(parts))]),
    "ContactQuery": (lambda mesh, parts: contact_query(mesh, parts), lambda query, parts: query.run()),
    "InsideQuery": (lambda mesh, parts: morula.InsideQuery(morula.Body(mesh, parts.model)),
                    lambda query, parts: query.inside(parts.mesh.positions * 1.01)),
    "SurfaceTree": (lambda mesh, parts: morula.SurfaceTree(mesh), lambda surface, parts: [
        surface.hash(), surface.facets, morula.proximity(surface, distance=0.02)]),
    "KDopTree": (lambda mesh, parts: morula.KDopTree(mesh, parts.model, 6),
                 lambda tree, parts: [tree.hash(), tree.update(parts.frames[1]), tree.hash()]),
    "LoosenessEstimator": (lambda mesh, parts: morula.LoosenessEstimator(mesh), lambda estimator, parts: estimator.estimate(
        morula.Body(parts.mesh, parts.model), parts.frames[0])),
    "LoosenessMeter": (lambda mesh, parts: morula.LoosenessMeter(mesh), lambda meter, parts: meter.measure(
        parts.frames[0], parts.model.spheres, resolution=24)),
    "FitSampler": (lambda mesh, parts: morula.FitSampler(mesh, interior=50, surface=50),
                   lambda sampler, parts: sampler.measure(parts.model.spheres)),
    "ModalCertificate": (lambda mesh, parts: morula.ModalCertificate(mesh, parts.modes, largest_norm=1e-3), lambda certificate, parts: [
        certificate.free_norm, certificate.norm(numpy.full(parts.modes.mode_count, 1e-4))]),
    "Motion": (lambda mesh, parts: morula.Motion(parts.folder / "motion.npy", mesh), lambda motion, parts: list(motion)),
    "SignedDistance": (lambda mesh, parts: morula.SignedDistance(mesh), lambda distance, parts: distance(parts.frames[1])),
    "TriangleBvh": (lambda mesh, parts: morula.TriangleBvh(mesh), lambda tree, parts: [
        tree.closest_points(parts.frames[1]), tree.winding_numbers(parts.frames[1])]),
    "Mesh": (lambda mesh, parts: morula.Mesh.of(mesh), lambda mesh, parts: [mesh, mesh.hash()]),
    "MotionWriter": (lambda mesh, parts: morula.MotionWriter(parts.folder / "frames", mesh, 2), lambda writer, parts: [
        [writer.write(frame) for frame in parts.frames], writer.finish(), (parts.folder / "frames" / "0001.obj").read_bytes()]),
}


def crossing(parts):
    other = parts.collider(parts.mesh)
    other.set_transform((0.05, 0.1, 0.02))
    return other


def contact_query(mesh, parts):
    query = morula.ContactQuery(surfaces=True)
    query.add(morula.Collider(morula.Body(mesh, parts.model)), crossing(parts))
    return query


@pytest.mark.parametrize("real", [numpy.float32, numpy.float64])
@pytest.mark.parametrize("name", KEEPERS)
def test_nothing_reads_arrays_after_the_call(name, real, parts):
    make, ask = KEEPERS[name]
    wanted = plain(ask(make(parts.mesh, parts), parts))
    positions, facets = parts.mesh.positions.astype(real), parts.mesh.facets.astype(numpy.int32)
    kept = make((positions, facets), parts)
    # The caller overwrites the arrays with invalid values and frees them, as a solver may.
    positions[:] = numpy.nan
    facets[:] = -1
    del positions, facets
    gc.collect()
    assert plain(ask(kept, parts)) == wanted


def test_a_mesh_that_is_given_is_kept_itself(parts):
    assert morula.Body(parts.mesh, parts.model).mesh is parts.mesh
    arrays = numpy.array(parts.mesh.positions), numpy.array(parts.mesh.facets)
    mesh = morula.Mesh(*arrays)
    before = hash(mesh)
    arrays[0][:] = 0
    arrays[1][:] = 0
    assert mesh == parts.mesh and hash(mesh) == before


TRIANGLE = numpy.eye(3), numpy.array([[0, 1, 2]], numpy.int32)


@pytest.mark.parametrize("integer", [numpy.int16, numpy.int32, numpy.int64])
def test_negative_indices_are_refused_by_row(integer):
    facets = numpy.array([[0, 1, 2], [2, 1, 7], [0, -3, 1]], integer)
    message = r"mesh\[1\]: row 2 holds -3, but indices are 0 to 4294967295"
    for call in (morula.surface_area, morula.connectivity, morula.build):
        with pytest.raises(ValueError, match=message):
            call((TRIANGLE[0], facets))


@pytest.mark.parametrize("integer", [numpy.int32, numpy.uint32, numpy.int64])
def test_indices_out_of_range_are_refused_by_row(integer):
    facets = numpy.array([[0, 1, 2], [2, 1, 3]], integer)
    for call in (morula.surface_area, morula.connectivity, morula.build, morula.SurfaceTree):
        with pytest.raises(ValueError, match=r"(mesh|rest)\[1\]: row 1 names vertex 3 of 3"):
            call((TRIANGLE[0], facets))


@pytest.mark.parametrize("integer", [numpy.int32, numpy.uint32, numpy.int64])
@pytest.mark.parametrize("real", [numpy.float32, numpy.float64])
def test_unusable_meshes_are_refused(real, integer):
    none = numpy.zeros((0, 3), integer)
    for positions in (numpy.zeros((0, 3), real), numpy.eye(3, dtype=real)):
        assert morula.surface_area((positions, none)) == 0
        with pytest.raises(ValueError, match="the mesh has no facets"):
            morula.build((positions, none))
    bad = numpy.eye(4, 3, dtype=real)
    bad[3, 1] = numpy.nan  # which no facet uses
    assert morula.build((bad, TRIANGLE[1].astype(integer)), method="octree").tree.node_count > 0
    bad[1, 2] = numpy.inf
    with pytest.raises(ValueError, match="vertex 1 has a coordinate that is not finite"):
        morula.build((bad, TRIANGLE[1].astype(integer)))


def packed_record(array):
    records = numpy.zeros(len(array), [("id", "u1"), ("row", array.dtype, 3)])
    records["row"] = array
    return records["row"]


@pytest.mark.parametrize("spoil, words", [
    (lambda array: array.astype(array.dtype.newbyteorder("S")), "in this machine's byte order"),
    (packed_record, "not whole numbers apart"),
])
@pytest.mark.parametrize("which", [0, 1])
def test_numbers_that_cannot_be_read_are_refused_with_the_line_to_write(which, spoil, words):
    mesh = [TRIANGLE[0], TRIANGLE[1][[0, 0]]]
    expected = morula.surface_area(tuple(mesh))
    mesh[which] = spoil(mesh[which])
    with pytest.raises(TypeError, match=words) as refusal:
        morula.surface_area(tuple(mesh))
    assert "main memory" not in str(refusal.value)
    line = re.search(r": (mesh\[\d\]\.astype\(.*\)|numpy\.ascontiguousarray\(mesh\[\d\]\))", str(refusal.value)).group(1)
    mesh[which] = eval(line)
    assert morula.surface_area(tuple(mesh)) == expected


def test_vertices_in_one_place_are_vertices():
    # Rows at no distance from each other.
    mesh = numpy.broadcast_to(numpy.array([0.0, 1.0, 2.0]), (3, 3)), TRIANGLE[1]
    assert morula.bounding_box(mesh) == ((0, 1, 2), (0, 1, 2))
