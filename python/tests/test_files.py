# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Files of other programs, read back by others' readers; topology against plain numpy; what was missing elsewhere."""

import collections
import json
import struct
import warnings
import xml.etree.ElementTree

import numpy
import pytest

import morula


def test_meshio_and_vtk_read_what_paraview_would(limb, tmp_path):
    speed = numpy.random.default_rng(1).normal(size=(limb.vertex_count, 3))
    piece = morula.components_by_edges(limb).of_facet
    morula.write_vtp(
        tmp_path / "limb.vtp", limb.positions, limb.facets, point_arrays={"speed": speed, "height": limb.positions[:, 2]},
        facet_arrays={"piece": piece, "area": numpy.ones(limb.facet_count, numpy.float32)},
    )
    root = xml.etree.ElementTree.parse(tmp_path / "limb.vtp").getroot()
    names = [array.get("Name") for array in root.iter("DataArray")]
    assert {"speed", "height", "piece", "area"} <= set(names)
    types = {array.get("Name"): array.get("type") for array in root.iter("DataArray")}
    assert types["piece"] == "Int32" and types["area"] == "Float64"
    with pytest.raises(ValueError, match=r"point_arrays\['a'\].*32 bits"):
        morula.write_vtp(tmp_path / "x.vtp", limb.positions, point_arrays={"a": numpy.full(limb.vertex_count, 2**40)})
    with pytest.raises(ValueError):
        morula.write_vtp(tmp_path / "x.vtp", limb.positions, point_arrays={"a": [1.0]})
    with pytest.raises(ValueError, match=r"point_arrays\['a'\]"):
        morula.write_vtp(tmp_path / "x.vtp", limb.positions, point_arrays={"a": ["text"]})
    morula.write_pvd(tmp_path / "limb.pvd", [(0.0, "limb.vtp"), (0.5, "other.vtp")])
    sets = list(xml.etree.ElementTree.parse(tmp_path / "limb.pvd").getroot().iter("DataSet"))
    assert [(float(s.get("timestep")), s.get("file")) for s in sets] == [(0.0, "limb.vtp"), (0.5, "other.vtp")]
    pyvista = pytest.importorskip("pyvista")
    read = pyvista.read(tmp_path / "limb.vtp")
    numpy.testing.assert_array_equal(read.points, limb.positions)
    numpy.testing.assert_array_equal(read.faces.reshape(-1, 4)[:, 1:], limb.facets)
    numpy.testing.assert_array_equal(read["speed"], speed)


def test_spheres_for_gltf_and_sofa(model, tmp_path):
    frames = numpy.stack([model.spheres, model.spheres + [1, 0, 0, 0.1]])
    morula.write_gltf_spheres(tmp_path / "a.glb", frames, 10)
    data = (tmp_path / "a.glb").read_bytes()
    magic, version, length = struct.unpack("<4sII", data[:12])
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size = struct.unpack("<I", data[12:16])[0]
    scene = json.loads(data[20 : 20 + size])
    nodes = [n for n in scene["nodes"] if "mesh" in n]
    assert len(nodes) == len(model)
    numpy.testing.assert_allclose([n["translation"] for n in nodes], model.spheres[:, :3].astype(numpy.float32))
    assert len(scene["animations"]) == 1
    morula.write_sofa_spheres(tmp_path / "a.sph", model.spheres)
    rows = [line.split() for line in (tmp_path / "a.sph").read_text().splitlines() if line.startswith("sphe ")]
    numpy.testing.assert_array_equal(numpy.array([row[2:] for row in rows], float), model.spheres)
    with pytest.raises(ValueError, match="frames"):
        morula.write_gltf_spheres(tmp_path / "a.glb", model.spheres)


def test_motions_of_models_come_back(limb, tmp_path):
    q = morula.sample_coordinates(3, 5)
    morula.write_coordinates(tmp_path / "q.npy", q)
    assert numpy.array_equal(numpy.load(tmp_path / "q.npy"), q)
    assert numpy.array_equal(morula.read_coordinates(tmp_path / "q.npy", 3), q)
    bones = morula.sample_bones(limb.positions, 4)
    morula.write_bone_frames(tmp_path / "b.npy", bones)
    assert numpy.array_equal(morula.read_bone_frames(tmp_path / "b.npy", bones.shape[1]), bones)
    square = numpy.concatenate([bones, numpy.tile([0.0, 0, 0, 1], (*bones.shape[:2], 1, 1))], axis=2)
    morula.write_bone_frames(tmp_path / "c.npy", square)
    assert (tmp_path / "c.npy").read_bytes() == (tmp_path / "b.npy").read_bytes()


def test_tables_of_formats_are_true(limb, tmp_path):
    formats = morula.file_formats()
    assert {f.extension for f in formats if f.purpose == "meshes" and f.is_read} == set(morula.readable_mesh_extensions().split())
    for f in formats:
        if f.purpose == "meshes" and f.is_written:
            assert f.extension in morula.writable_mesh_list()
            morula.write_mesh(tmp_path / f"limb{f.extension}", limb)
            if f.is_read:
                assert morula.read_mesh(tmp_path / f"limb{f.extension}").facet_count == limb.facet_count
    morula.write_balls(tmp_path / "balls.ply", numpy.array([[0, 0, 0, 1.0]]))
    morula.write_mesh(tmp_path / "mesh.ply", limb)
    assert morula.is_ball_file(tmp_path / "balls.ply") and not morula.is_ball_file(tmp_path / "mesh.ply")
    assert not morula.holds_spheres(tmp_path / "mesh.ply")


def test_frame_files_are_in_the_order_of_numbers(limb, tmp_path):
    for i in (1, 2, 10, 9, 8, 7, 6, 5, 4, 3):
        morula.write_mesh(tmp_path / f"f{i}.obj", limb)
    assert [name.rsplit("/", 1)[-1] for name in morula.frame_files(tmp_path)] == [f"f{i}.obj" for i in range(1, 11)]
    (tmp_path / "f5.obj").unlink()
    with pytest.raises(OSError):
        morula.frame_files(tmp_path, "f*")


def open_box():
    hull = morula.ConvexHull.box((0, 0, 0), (1, 1, 1))
    normals = hull.planes[:, :3]
    return morula.Mesh(hull.vertices, hull.facets[normals[:, 2] < 0.5])


def test_edges_fans_and_borders_are_those_of_numpy(limb):
    for mesh in (limb, open_box()):
        found = morula.connectivity(mesh)
        ways = mesh.facets[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        edges, inverse, counts = numpy.unique(numpy.sort(ways, axis=1), axis=0, return_inverse=True, return_counts=True)
        assert numpy.array_equal(found.edges, edges) and numpy.array_equal(found.facet_edges.ravel(), inverse.ravel())
        assert found.edge_count == len(edges)
        for e in range(0, len(edges), 7):
            assert found.edge_sides(e).tolist() == numpy.flatnonzero(inverse.ravel() == e).tolist()
        around = collections.defaultdict(list)
        for f, corners in enumerate(mesh.facets.tolist()):
            for v in corners:
                around[v].append(f)
        assert all(found.vertex_facets(v).tolist() == around[v] for v in around)
        assert morula.border_edges(found).tolist() == numpy.flatnonzero(counts == 1).tolist()
        assert morula.nonmanifold_edges(found).size == morula.nonmanifold_vertices(mesh).size == 0
        loops = morula.border_loops(mesh)
        assert len(loops) == (1 if mesh is not limb else 0) and len(loops.sides) == (counts == 1).sum()
        side = int(inverse.ravel()[0])
        neighbors = {int(s) // 3 for s in numpy.flatnonzero(inverse.ravel() == side)} - {0}
        assert found.facet_across(0, 0) in neighbors | {morula.no_facet}
    with pytest.raises(IndexError):
        found.facet_across(10**6, 0)


def test_pieces(limb):
    both = morula.Mesh(
        numpy.concatenate([limb.positions, limb.positions + 9.0, [[0, 0, 0]]]),
        numpy.concatenate([limb.facets, limb.facets + limb.vertex_count]),
    )
    pieces = morula.components_by_vertices(both)
    assert pieces.count == 2 and pieces.of_facet.tolist() == [0] * limb.facet_count + [1] * limb.facet_count
    assert morula.components_by_edges(both) == morula.components_by_edges(both)
    mesh, index = morula.used_vertices(both)
    assert mesh.vertex_count == 2 * limb.vertex_count and index.tolist() == list(range(2 * limb.vertex_count))


def test_single_triangles():
    a = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]])
    assert morula.intersect(a, a + [0.2, 0.2, 0]) and not morula.intersect(a, a + [0, 0, 1])
    crossing = numpy.array([[0.25, 0.25, -1], [0.25, 0.25, 1], [2, 2, 0.0]])
    p, q = morula.intersection(a, crossing)
    numpy.testing.assert_allclose(sorted([p, q]), [[0.25, 0.25, 0], [0.5, 0.5, 0]], atol=1e-15)
    assert morula.intersection(a, a + [0, 0, 1]) is None
    nearest = morula.closest_point(a, (0.2, -3.0, 4.0))
    assert nearest.point == (0.2, 0, 0) and nearest.squared_distance == 25 and nearest.barycentric[2] == 0
    cube = morula.ConvexHull.box((-1, -1, -1), (1, 1, 1))
    total = sum(morula.solid_angle(cube.vertices[f], (0.1, 0.2, 0.3)) for f in cube.facets)
    assert numpy.isclose(total, 4 * numpy.pi)


def test_power_diagrams_are_those_of_numpy(model):
    spheres = model.level(2)
    diagram = morula.PowerDiagram(spheres)
    points = numpy.random.default_rng(4).normal(size=(500, 3))
    powers = ((points[:, None] - spheres[:, :3]) ** 2).sum(axis=2) - spheres[:, 3] ** 2
    owners = diagram.owners(points, morula.Workers(2))
    numpy.testing.assert_allclose(powers[numpy.arange(500), owners], powers.min(axis=1), atol=1e-12)
    sphere, amount = diagram.least_growth(points[:1])
    needed = numpy.linalg.norm(points[0] - spheres[:, :3], axis=1) - spheres[:, 3]
    assert numpy.isclose(amount, needed.min()) and numpy.isclose(needed[sphere], amount)
    assert owners[0] in diagram.candidates(points[:1].repeat(3, axis=0) + 1e-9 * numpy.eye(3))


def test_facets_fall_apart_into_cells(model):
    """Pieces tile the facet, and no sphere has less power at a sample of a piece than its owner."""
    spheres = numpy.array([[0, 0, 0, 1], [1, 0, 0, 1], [0, 1, 0, 0.8], [9, 9, 9, 0.1]], float)
    triangle = numpy.array([[0, 0, 0], [1, 0, 0.1], [0, 1, 0.2]])
    cut = morula.cut_by_power(triangle, spheres)
    assert len(cut) == len(cut.owner) == len(cut.corner_begin) - 1 and sorted(cut.owner.tolist()) == [0, 1, 2]
    pieces = [cut.polygon(k) for k in range(len(cut))]
    assert numpy.array_equal(numpy.concatenate(pieces), cut.corners)

    def area(polygon):
        return sum(abs(numpy.linalg.det([polygon[0], p, q])) for p, q in zip(polygon[1:], polygon[2:]))

    assert numpy.isclose(sum(map(area, pieces)), 1)
    generator = numpy.random.default_rng(6)
    for owner, polygon in zip(cut.owner, pieces):
        points = generator.dirichlet(numpy.ones(len(polygon)), 50) @ polygon @ triangle
        powers = ((points[:, None] - spheres[:, :3]) ** 2).sum(axis=2) - spheres[:, 3] ** 2
        assert (powers[:, owner] <= powers.min(axis=1) + 1e-12).all()
    whole = morula.PowerDiagram(spheres).cut(triangle)
    assert numpy.array_equal(whole.corners, cut.corners) and numpy.array_equal(whole.owner, cut.owner)
    # A part of it, and spheres that may own it; a cut is the same from both sides of an edge.
    half = morula.cut_by_power(triangle, spheres, numpy.array([[1, 0, 0], [0, 1, 0], [0, 0.5, 0.5]]), candidates=numpy.array([1, 2]))
    assert set(half.owner.tolist()) <= {1, 2} and numpy.isclose(sum(area(half.polygon(k)) for k in range(len(half))), 0.5)
    beside = morula.cut_by_power(triangle[[1, 0, 2]] + [[0, 0, 0], [0, 0, 0], [0, -2, 0]], spheres, vertices=[1, 0, 3])
    on_edge = {tuple(c[:2]) for c in cut.corners if c[2] == 0}
    assert on_edge == {(c[1], c[0]) for c in beside.corners if c[2] == 0} and len(on_edge) == 3
    for wrong in (dict(polygon=numpy.eye(3)[:1]), dict(candidates=numpy.arange(0)), dict(candidates=numpy.array([4]))):
        with pytest.raises((ValueError, IndexError)):
            morula.cut_by_power(triangle, spheres, **wrong)
    with pytest.raises(ValueError, match="triangle"):
        morula.PowerDiagram(spheres).cut(triangle[:2])
    with pytest.raises(IndexError):
        cut.polygon(len(cut))


def test_frames_are_read_and_written_one_at_a_time(limb, model, motion, tmp_path):
    for path in (tmp_path / "motion.npy", tmp_path / "frames"):
        with morula.MotionWriter(path, limb, len(motion)) as writer:
            for positions in motion:
                writer.write(positions)
        read = morula.Motion(path, limb)
        assert len(read) == len(motion) and numpy.array_equal(read[-1], motion[-1]) and read.frame_name(2)
        assert numpy.array_equal(numpy.stack(list(read)), morula.read_motion(path, limb))
        numpy.testing.assert_allclose(read[3], motion[3], atol=1e-15)
        with pytest.raises(IndexError):
            read[len(motion)]
    body = morula.Body(limb, model)
    with morula.SphereFramesWriter(tmp_path / "spheres.npz", model.tree, len(motion)) as writer:
        for positions in motion:
            body.update(positions)
            writer.write(body.copy_spheres())
    assert numpy.array_equal(morula.read_sphere_frames(tmp_path / "spheres.npz").spheres, morula.Body(limb, model).follow(motion))
    # Nothing is there of a block that raised, or had too few frames; nothing is written afterwards.
    with pytest.raises(ZeroDivisionError):
        with morula.MotionWriter(tmp_path / "never.npy", limb, 2) as writer:
            writer.write(motion[0])
            1 / 0
    with pytest.raises(OSError):
        with morula.SphereFramesWriter(tmp_path / "never.npz", model.tree, 2) as writer:
            writer.write(model.spheres)
    with pytest.raises(ValueError, match="finished"):
        writer.write(model.spheres)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["frames", "motion.npy", "spheres.npz"]
    with pytest.raises(ValueError, match="positions"):
        morula.MotionWriter(tmp_path / "never.npy", limb, 1).write(motion[0][:-1])
    with pytest.raises(ValueError, match="spheres"):
        morula.SphereFramesWriter(tmp_path / "never.npz", model.tree, 1).write(model.spheres[:-1])


def test_looseness_meters_say_what_looseness_says(limb, model, motion):
    meter = morula.LoosenessMeter(limb)
    assert meter.has_volume
    spheres = model.level(1)
    assert meter.measure(limb.positions, spheres, resolution=48) == morula.looseness(limb, spheres, resolution=48)
    box = open_box()
    around = numpy.array([[0.5, 0.5, 0.5, 1.0]])
    assert morula.LoosenessMeter(box).measure(box.positions, around, resolution=48).looseness is None
    measured = morula.LoosenessMeter(box).measure_open(box.positions, around, resolution=48)
    assert measured.range[0] <= measured.looseness <= measured.range[1]
    with pytest.raises(ValueError, match="positions"):
        meter.measure(limb.positions[:5], spheres)
    inside = morula.SignedDistance(limb)
    ball = tuple(spheres[0])
    one = morula.ball_protrusion(inside, ball)
    assert one.lower <= one.upper <= morula.protrusion(inside, spheres[:1], tolerance=1e-3).worst + 1e-12


def test_what_rules_promise(limb, model, motion):
    body = morula.Body(limb, model, rules=["approach2", "exact"])
    body.update(motion[4])
    assert body.any_promises_cover and body.certify_promised_levels(motion[4])
    assert not morula.Body(limb, model, rules="approach1").any_promises_cover
    wrapped = morula.Body(limb, model, rules=["wrapped", "wrapped", "exact"])
    wrapped.update(motion[4])
    assert wrapped.any_promises_nesting and wrapped.certify_promised_nesting().nested
    assert "exact" in morula.position_rules() and "modal" not in morula.position_rules()


def test_cuts_and_crossings_of_nodes(limb, model):
    a, b = morula.Collider(morula.Body(limb, model)), morula.Collider(morula.Body(limb, model))
    b.set_transform((0.3, 0.05, 0.0))
    query = morula.ContactQuery(budget=200)
    query.add(a, b)
    contacts = query.start()
    cut = query.cut()
    waiting = cut.state == int(morula.FrontPairState.waiting)
    finished = cut.state == int(morula.FrontPairState.finished)
    assert finished.sum() == contacts.finished_count and waiting.sum() == len(contacts) - contacts.finished_count > 0
    whole = morula.CrossingQuery()
    found = whole.run(a, b)
    assert found == morula.crossings(a, b) and len(found) > 5 and whole.pairs_tested >= len(found)
    leaves = morula.collide(a, b)
    assert whole.run(a, b, (leaves.node_a, leaves.node_b)) == found
    with pytest.raises(ValueError):
        whole.run(a, b, (numpy.array([10**6]), numpy.array([0])))


def test_rigid_transforms_turn():
    turn = morula.RigidTransform.from_axis((0, 0, 1), numpy.pi / 2, (5, 5, 5))
    numpy.testing.assert_allclose(turn.rotate((1, 0, 0)), (0, 1, 0), atol=1e-15)
    numpy.testing.assert_allclose(turn.inverse_rotate((0, 1, 0)), (1, 0, 0), atol=1e-15)
    assert morula.deviation_from_rigid(turn) < morula.largest_rigid_deviation


def test_parts_of_a_file_that_are_not_read_are_warnings(tmp_path):
    path = tmp_path / "odd.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert morula.read_mesh(path).facet_count == 1
        path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nface 1 2 3\n")
        with pytest.raises(UserWarning, match=r"odd\.obj: 1 statement that OBJ does not know"):
            morula.read_mesh(path)
    with pytest.warns(UserWarning, match="on line 5"):
        assert morula.read_mesh(path).facet_count == 1
