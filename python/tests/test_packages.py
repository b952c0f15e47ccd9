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
    model = morula.build(ball, quality="fast")
    body = morula.Body(ball, model)
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
        ours.set_transform(turn)
        pose = coal.Transform3s(turn.matrix[:3, :3], turn.matrix[:3, 3])
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        expected = coal.distance(a, pose, b, coal.Transform3s(), request, result)
        bounds = morula.distance(ours, other)
        if bounds.crossing:
            assert expected <= 1e-6
        else:
            assert abs(bounds.upper - expected) < 1e-6


def test_distances_agree_with_mujoco():
    """Of convex bodies, which are all that MuJoCo makes of meshes."""
    mujoco = pytest.importorskip("mujoco")
    generator = numpy.random.default_rng(3)
    hulls = [morula.ConvexHull(generator.normal(size=(40, 3)) * [1, 0.5, 0.3]) for _ in range(2)]
    # Meshes of MuJoCo are turned to their axes of inertia; facets and vertices as they are placed then are what counts.
    assets = "".join(
        f'<mesh name="m{i}" vertex="{" ".join(map(repr, map(float, hull.vertices.ravel())))}"/>' for i, hull in enumerate(hulls)
    )
    bodies = "".join(f'<body name="b{i}"><freejoint/><geom name="g{i}" type="mesh" mesh="m{i}"/></body>' for i in range(2))
    model = mujoco.MjModel.from_xml_string(f"<mujoco><asset>{assets}</asset><worldbody>{bodies}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    colliders = []
    for hull in hulls:
        mesh = morula.Mesh(hull.vertices, hull.facets)
        colliders.append(morula.Collider(morula.Body(mesh, morula.build(mesh, method="octree", depth=3))))
    compared = 0
    for _ in range(20):
        turns = [
            morula.RigidTransform.from_axis(generator.normal(size=3), generator.uniform(0, 6), generator.normal(size=3) * 2)
            for _ in range(2)
        ]
        for i, (collider, turn) in enumerate(zip(colliders, turns)):
            collider.set_transform(turn)
            quaternion = numpy.zeros(4)
            mujoco.mju_mat2Quat(quaternion, turn.matrix[:3, :3].ravel())
            data.qpos[7 * i : 7 * i + 7] = [*turn.translation, *quaternion]
        mujoco.mj_forward(model, data)
        theirs = mujoco.mj_geomDistance(model, data, 0, 1, 100.0, numpy.zeros(6))
        bounds = morula.distance(*colliders)
        if theirs > 1e-3:
            # MuJoCo keeps vertices in single precision.
            assert abs(bounds.upper - theirs) < 1e-4
            compared += 1
    assert compared >= 8


def test_the_cloud_of_a_pyvista_plot_has_the_spheres(model):
    pyvista = pytest.importorskip("pyvista")
    cloud = morula.plot.to_pyvista(model.level(1))
    assert isinstance(cloud, pyvista.PolyData)
    spheres = model.level(1)
    numpy.testing.assert_allclose(cloud.points.min(axis=0), (spheres[:, :3] - spheres[:, 3:]).min(axis=0), atol=0.03)
    numpy.testing.assert_allclose(cloud.points.max(axis=0), (spheres[:, :3] + spheres[:, 3:]).max(axis=0), atol=0.03)


def test_polyscope_shows_spheres_and_meshes(limb, model):
    polyscope = pytest.importorskip("polyscope")
    try:
        polyscope.set_allow_headless_backends(True)
        polyscope.init()
    except Exception as fault:  # noqa: BLE001: there may be no display and no software renderer
        pytest.skip(f"Polyscope does not start here: {fault}")
    cloud = morula.plot.to_polyscope(model.level(2), name="leaves")
    assert cloud.n_points() == len(model.level(2)) and polyscope.get_point_cloud("leaves") is not None
    surface = morula.plot.to_polyscope(limb, name="limb")
    assert surface.n_faces() == limb.facet_count
    polyscope.remove_all_structures()


def test_what_scipy_knows_of_rotations_places_bodies(limb):
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    turn = rotation.from_rotvec([0.3, -0.2, 0.9])
    x, y, z, w = turn.as_quat()
    ours = morula.RigidTransform.from_quaternion(w, x, y, z)
    numpy.testing.assert_allclose(ours.matrix[:3, :3], turn.as_matrix(), atol=1e-14)
    assert morula.deviation_from_rigid(morula.RigidTransform(numpy.column_stack([turn.as_matrix(), [1, 2, 3]]))) < 1e-14


def test_nearest_points_are_those_of_trimesh(limb):
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("scipy")
    points = numpy.random.default_rng(6).normal(size=(200, 3))
    theirs = trimesh.Trimesh(limb.vertices, limb.faces, process=False)
    try:
        _, distances, _ = trimesh.proximity.closest_point(theirs, points)
    except (ImportError, ModuleNotFoundError) as fault:
        pytest.skip(f"trimesh needs more: {fault}")
    numpy.testing.assert_allclose(morula.TriangleBvh(limb).closest_points(points).distances, distances, atol=1e-9)


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
    ours = morula.ipctk.BroadPhase(boxes=True)

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


def scenes_of_ipctk():
    """A small limb, all of whose facets are near each other, in a bend; and a fall of one body onto another."""
    limb = morula.sample_body("limb", 8)
    motion = 0.2 * morula.deform_frames(limb, morula.Bend(120), frame_count=9)
    yield pytest.param(0.2 * limb.vertices, limb.faces, list(motion[:4]), id="limb")
    tool, bar = morula.sample_body("tool", 8), morula.sample_body("bar", 6)
    vertices = numpy.concatenate([tool.vertices, bar.vertices + [0.1, 0.05, 1.4]])
    faces = numpy.concatenate([tool.faces, bar.faces + tool.vertex_count])
    falls = [numpy.array(vertices) for _ in range(6)]
    for i, positions in enumerate(falls):
        positions[tool.vertex_count :, 2] -= 0.25 * i
    yield pytest.param(vertices, faces, falls, id="fall")


@pytest.mark.parametrize("vertices, faces, frames", list(scenes_of_ipctk()))
def test_collisions_of_ipctk_are_the_same_with_the_broad_phase(vertices, faces, frames):
    ipctk = pytest.importorskip("ipctk")
    faces = faces.astype(numpy.int32)
    mesh = ipctk.CollisionMesh(numpy.asfortranarray(vertices), edges_of(faces), faces)
    ours = morula.ipctk.BroadPhase()
    dhat, some = 0.05, 0

    def found(collisions, positions):
        rows = []
        for i in range(len(collisions)):
            ids = sorted(k for k in collisions[i].vertex_ids(mesh.edges, mesh.faces) if k >= 0)
            distance = collisions[i].compute_distance(collisions[i].dof(positions, mesh.edges, mesh.faces))
            rows.append((*ids, round(float(distance), 12)))
        return sorted(rows)

    for start, end in zip(frames, frames[1:]):
        start, end = numpy.asfortranarray(start), numpy.asfortranarray(end)
        of_ours, of_theirs = ipctk.NormalCollisions(), ipctk.NormalCollisions()
        of_ours.build(mesh, start, dhat, broad_phase=ours)
        of_theirs.build(mesh, start, dhat, broad_phase=ipctk.BruteForce())
        assert found(of_ours, start) == found(of_theirs, start)
        potential = ipctk.BarrierPotential(dhat, 1.0) if _takes(ipctk.BarrierPotential, dhat, 1.0) else ipctk.BarrierPotential(dhat)
        assert potential(of_ours, mesh, start) == pytest.approx(potential(of_theirs, mesh, start), rel=1e-12, abs=1e-300)
        some += len(of_theirs)
        steps = []
        for phase in (ours, ipctk.BruteForce()):
            candidates = ipctk.Candidates()
            candidates.build(mesh, start, end, dhat / 2, phase)
            steps.append((candidates.compute_collision_free_stepsize(mesh, start, end), len(candidates)))
        assert steps[0][0] == steps[1][0] and steps[0][1] <= steps[1][1]
    assert some > 20


def test_the_filter_of_a_mesh_is_asked(limb):
    ipctk = pytest.importorskip("ipctk")
    faces, edges = limb.faces.astype(numpy.int32), edges_of(limb.faces).astype(numpy.int32)

    def allowed(i, j):
        return min(i, j) % 7 < 2

    kept = []
    for filtered in (False, True):
        mesh = ipctk.CollisionMesh(numpy.asfortranarray(limb.vertices), edges, faces)
        if filtered:
            # The toolkit's own broad phases call filters of Python from threads, and wait for ever.
            mesh.can_collide = ipctk.CollisionFilter(allowed)
        candidates = ipctk.Candidates()
        candidates.build(mesh, numpy.asfortranarray(limb.vertices), 0.05, morula.ipctk.BroadPhase())
        kept.append(
            (
                {(c.edge0_id, c.edge1_id) for c in candidates.ee_candidates}, {(c.face_id, c.vertex_id) for c in candidates.fv_candidates}
            )
        )
    (all_edges, all_faces), (own_edges, own_faces) = kept
    assert own_edges == {(e, f) for e, f in all_edges if any(allowed(i, j) for i in edges[e] for j in edges[f])}
    assert own_faces == {(f, v) for f, v in all_faces if any(allowed(i, v) for i in faces[f])}
    assert 0 < len(own_edges) < len(all_edges) and 0 < len(own_faces) < len(all_faces)


def _takes(kind, *arguments):
    try:
        kind(*arguments)
    except TypeError:
        return False
    return True


def test_the_broad_phase_says_what_it_is_not_for(limb):
    ipctk = pytest.importorskip("ipctk")
    phase = morula.ipctk.BroadPhase()
    with pytest.raises(ValueError, match="faces"):
        phase.build(limb.vertices, numpy.array([[0, 1]], numpy.int32), numpy.empty((0, 3), numpy.int32), 0.1)
    assert phase.name() == "Morula"


def test_plots_show_what_was_measured(limb, model, motion):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    curve = morula.plot.looseness_of_motion(limb, model, motion, resolution=48)
    assert curve.shape == (len(motion),) and (curve > 0).all() and curve[0] == curve[-1]
    axes = morula.plot.looseness_curve({"exact": curve})
    assert list(axes.lines[0].get_ydata()) == list(curve) and axes.get_legend() is not None
    rows = morula.plot.levels_table(morula.measure(limb, model))
    assert [row["level"] for row in rows] == [0, 1, 2] and rows[2]["uncovered_area"] == 0
    assert len(morula.plot.spheres(model.level(1)).collections) == len(model.level(1))
