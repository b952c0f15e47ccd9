# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The packages that users carry with them: meshes of theirs, answers that agree with theirs."""

import numpy
import pytest

import morula


def test_meshes_of_trimesh_are_meshes(limb):
    trimesh = pytest.importorskip("trimesh")
    theirs = trimesh.Trimesh(limb.vertices, limb.faces, process=False)
    assert morula.Mesh.of(theirs) == limb
    assert morula.build(theirs, method="octree", depth=2) == morula.build(limb, method="octree", depth=2)
    ball = trimesh.creation.icosphere(subdivisions=3, radius=2.0)
    built = morula.build(ball, quality="fast")
    body = morula.Body(ball, built)
    body.update(ball.vertices * 1.5)
    assert body.certify(ball.vertices * 1.5)
    assert numpy.isclose(morula.signed_volume(ball), ball.volume)
    assert numpy.isclose(morula.surface_area(ball), ball.area)


def test_meshes_of_meshio_are_meshes(limb, tmp_path):
    meshio = pytest.importorskip("meshio")
    theirs = meshio.Mesh(limb.vertices, [("triangle", limb.faces.astype(numpy.int64))])
    assert morula.Mesh.of(theirs) == limb
    meshio.write(tmp_path / "limb.off", theirs)
    assert morula.read_mesh(tmp_path / "limb.off").facet_count == limb.facet_count
    tets = meshio.Mesh(limb.vertices, [("tetra", numpy.array([[0, 1, 2, 3]]))])
    with pytest.raises(ValueError, match="tetra"):
        morula.inspect(tets)


def test_padded_faces_of_pyvista_are_refused_with_the_line_to_write(limb):
    pyvista = pytest.importorskip("pyvista")
    padded = numpy.hstack([numpy.full((limb.facet_count, 1), 3), limb.faces]).ravel()
    theirs = pyvista.PolyData(numpy.array(limb.vertices), padded)
    with pytest.raises(TypeError, match=r"morula.Mesh\(mesh.points, mesh.triangulate\(\).faces.reshape\(-1, 4\)\[:, 1:\]\)"):
        morula.inspect(theirs)
    mesh = theirs
    assert morula.Mesh(mesh.points, mesh.triangulate().faces.reshape(-1, 4)[:, 1:]) == limb


def test_distances_agree_with_coal():
    coal = pytest.importorskip("coal")
    tool, bar = morula.sample_body("tool", 12), morula.sample_body("bar", 6)

    def theirs(mesh):
        model = coal.BVHModelOBBRSS()
        model.beginModel(mesh.facet_count, mesh.vertex_count)
        vertices = coal.StdVec_Vec3s()
        for v in mesh.vertices:
            vertices.append(numpy.array(v))
        triangles = coal.StdVec_Triangle()
        for f in mesh.faces:
            triangles.append(coal.Triangle(*map(int, f)))
        model.addSubModel(vertices, triangles)
        model.endModel()
        return model

    a, b = theirs(tool), theirs(bar)
    ours = morula.Collider(morula.Body(tool, morula.build(tool, quality="fast")))
    other = morula.Collider(morula.Body(bar, morula.build(bar, quality="fast")))
    generator = numpy.random.default_rng(7)
    for _ in range(20):
        turn = morula.RigidTransform.from_axis(generator.normal(size=3), generator.uniform(0, 6), generator.normal(size=3) * 2.5)
        ours.place(turn)
        pose = coal.Transform3s(turn.matrix[:3, :3], turn.matrix[:3, 3])
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        expected = coal.distance(a, pose, b, coal.Transform3s(), request, result)
        bounds = morula.distance(ours, other)
        if bounds.crossing:
            assert expected <= 1e-6
        else:
            assert abs(bounds.upper - expected) < 1e-6


def edges_of(faces):
    sides = numpy.sort(numpy.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return numpy.unique(sides, axis=0)


@pytest.mark.parametrize("radius", [0.0, 0.01, 0.05])
def test_the_broad_phase_for_ipctk_finds_what_brute_force_finds(radius):
    ipctk = pytest.importorskip("ipctk")
    limb = morula.sample_body("limb", 10)
    motion = morula.deform_frames(limb, morula.Bend(90), morula.Twist(60), frame_count=9)
    faces = limb.faces.astype(numpy.int32)
    mesh = ipctk.CollisionMesh(limb.vertices, edges_of(faces), faces)
    folded = numpy.array(limb.vertices)
    folded[:, 0] = numpy.abs(folded[:, 0] - folded[:, 0].mean())
    ours = morula.ipctk.BroadPhase()

    def pairs(candidates):
        edges = {tuple(sorted((c.edge0_id, c.edge1_id))) for c in candidates.ee_candidates}
        return edges, {(c.face_id, c.vertex_id) for c in candidates.fv_candidates}

    for start, end in ((folded, None), (motion[2], None), (limb.vertices, folded), (motion[0], motion[1])):
        found = []
        for phase in (ours, ipctk.BruteForce()):
            candidates = ipctk.Candidates()
            steps = (numpy.asfortranarray(start),) if end is None else (numpy.asfortranarray(start), numpy.asfortranarray(end))
            candidates.build(mesh, *steps, radius, phase)
            found.append((pairs(candidates), candidates, steps))
        (own, candidates, steps), (theirs, others, _) = found
        assert own == theirs
        assert len(own[0]) > 0
        if end is not None:
            assert candidates.compute_collision_free_stepsize(mesh, *steps) == others.compute_collision_free_stepsize(mesh, *steps)


def test_the_broad_phase_says_what_it_is_not_for(limb):
    ipctk = pytest.importorskip("ipctk")
    phase = morula.ipctk.BroadPhase()
    with pytest.raises(ValueError, match="faces"):
        phase.build(limb.vertices, numpy.array([[0, 1]], numpy.int32), numpy.empty((0, 3), numpy.int32), 0.1)
    assert phase.name() == "Morula"


def test_plots_show_what_was_measured(limb, built, motion):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    curve = morula.plot.looseness_of_motion(limb, built, motion, resolution=48)
    assert curve.shape == (len(motion),) and (curve > 0).all() and curve[0] == curve[-1]
    axes = morula.plot.looseness_curve({"exact": curve})
    assert list(axes.lines[0].get_ydata()) == list(curve) and axes.get_legend() is not None
    rows = morula.plot.levels_table(morula.measure(limb, built))
    assert [row["level"] for row in rows] == [0, 1, 2] and rows[2]["bare_area"] == 0
    assert len(morula.plot.spheres(built.level(1)).collections) == len(built.level(1))
