# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""USD: what is written is what USD's own readers see; what its writers make is read."""

import numpy
import pytest

import morula

pytest.importorskip("pxr", reason="usd-core is not installed")
from pxr import Gf, Usd, UsdGeom, Vt  # noqa: E402

ENDINGS = ["usda", "usdc", "usd"]


def contain(centers, radii, spheres):
    """Do spheres in single precision contain those in double?"""
    apart = numpy.linalg.norm(centers.astype(numpy.float64) - spheres[:, :3], axis=1)
    return bool((apart + spheres[:, 3] <= radii.astype(numpy.float64) * (1 + 1e-15)).all())


@pytest.mark.parametrize("ending", ENDINGS)
def test_spheres_in_motion_are_points_with_widths(limb, model, motion, tmp_path, ending):
    spheres = morula.Body(limb, model).follow(motion)
    path = tmp_path / f"spheres.{ending}"
    morula.usd.write_spheres(path, spheres, frames_per_second=30, up="Z")
    stage = Usd.Stage.Open(str(path))
    assert stage.GetTimeCodesPerSecond() == 30
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, len(motion) - 1)
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    points = UsdGeom.Points(stage.GetDefaultPrim().GetChildren()[0])
    assert points.GetWidthsInterpolation() == "vertex"
    assert points.GetPointsAttr().GetTimeSamples() == list(range(len(motion)))
    for frame, given in enumerate(spheres):
        centers, widths = (numpy.array(attribute.Get(frame)) for attribute in (points.GetPointsAttr(), points.GetWidthsAttr()))
        assert centers.shape == (len(given), 3)
        assert numpy.allclose(widths / 2, given[:, 3], rtol=1e-6, atol=1e-6)
        assert contain(centers, widths / 2, given)
        low, high = points.GetExtentAttr().Get(frame)
        assert (numpy.array(low) <= (centers - widths[:, None] / 2).min(axis=0) + 1e-6).all()
        assert (numpy.array(high) >= (centers + widths[:, None] / 2).max(axis=0) - 1e-6).all()


def test_spheres_are_instances_of_one_ball(model, tmp_path):
    path = tmp_path / "spheres.usda"
    morula.usd.write_spheres(path, model, level=1, kind="instances")
    stage = Usd.Stage.Open(str(path))
    instancer = UsdGeom.PointInstancer(stage.GetPrimAtPath("/morula/spheres"))
    given = model.tree.level(1)
    matrices = instancer.ComputeInstanceTransformsAtTime(Usd.TimeCode.Default(), Usd.TimeCode.Default())
    assert len(matrices) == len(given)
    for matrix, (x, y, z, radius) in zip(matrices, given):
        assert Gf.IsClose(matrix.ExtractTranslation(), Gf.Vec3d(x, y, z), 1e-6)
        assert abs(matrix.TransformDir(Gf.Vec3d(1, 0, 0)).GetLength() - radius) < 1e-6
    [ball] = instancer.GetPrototypesRel().GetTargets()
    assert UsdGeom.Sphere(stage.GetPrimAtPath(ball)).GetRadiusAttr().Get() == 1.0


def test_rounding_to_single_precision_keeps_cover(tmp_path):
    generator = numpy.random.default_rng(2)
    given = generator.uniform(-1, 1, (500, 4)) * 10.0 ** generator.integers(-6, 6, (500, 1))
    given[:, 3] = abs(given[:, 3])
    given[0] = (0, 0, 0, 0)
    given[1] = (1, 2, 3, 0.5)
    morula.usd.write_spheres(tmp_path / "s.usdc", given)
    stage = Usd.Stage.Open(str(tmp_path / "s.usdc"))
    points = UsdGeom.Points(stage.GetPrimAtPath("/morula/spheres"))
    centers, widths = numpy.array(points.GetPointsAttr().Get()), numpy.array(points.GetWidthsAttr().Get())
    assert contain(centers, widths / 2, given)
    assert (widths[:2] == [0, 1]).all(), "what needs no rounding is not rounded"


def test_a_motion_goes_through_a_file(limb, motion, tmp_path):
    path = tmp_path / "limb.usdc"
    morula.usd.write_mesh(path, limb, motion, frames_per_second=50)
    mesh, frames, times = morula.usd.read_motion(path)
    assert (mesh.faces == limb.faces).all()
    assert numpy.allclose(frames, motion, atol=1e-6)
    assert numpy.allclose(times, numpy.arange(len(motion)) / 50)
    assert (numpy.asarray(mesh.vertices) == frames[0]).all()
    morula.usd.write_mesh(path, limb)
    assert morula.usd.read_motion(path)[1].shape == (1, limb.vertex_count, 3), "the file was replaced"
    assert morula.usd.mesh_paths(path) == ["/morula/surface"]
    assert [p.name for p in tmp_path.iterdir()] == ["limb.usdc"]


def quad(stage, place, **more):
    mesh = UsdGeom.Mesh.Define(stage, place)
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)])
    mesh.CreateFaceVertexCountsAttr([4, 3, 3, 3, 3])
    mesh.CreateFaceVertexIndicesAttr([3, 2, 1, 0, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4])
    return mesh


def test_polygons_transforms_and_orientation_of_others(tmp_path):
    path = tmp_path / "tent.usda"
    stage = Usd.Stage.CreateNew(str(path))
    parent = UsdGeom.Xform.Define(stage, "/a")
    parent.AddTranslateOp().Set((10, 0, 0))
    turning = parent.AddRotateZOp()
    turning.Set(0, 0)
    turning.Set(90, 24)
    quad(stage, "/a/tent").AddScaleOp().Set((2, 2, 2))
    stage.Save()
    mesh, frames, times = morula.usd.read_motion(path)
    assert mesh.facet_count == 6 and morula.signed_volume(mesh) == pytest.approx(8 / 3)
    assert numpy.allclose(times, [0, 1])
    assert numpy.allclose(frames[0, 2], [12, 2, 0]) and numpy.allclose(frames[1, 2], [8, 2, 0])
    # A mirror, and the other convention of facets, each by itself and both.
    for mirror, left, volume in [(True, False, 8 / 3), (False, True, -8 / 3), (True, True, -8 / 3)]:
        stage = Usd.Stage.CreateInMemory()
        tent = quad(stage, "/tent")
        tent.AddScaleOp().Set((-2, 2, 2) if mirror else (2, 2, 2))
        if left:
            tent.CreateOrientationAttr("leftHanded")
        stage.GetRootLayer().Export(str(path))
        assert morula.signed_volume(morula.usd.read_mesh(path)) == pytest.approx(volume), (mirror, left)


def test_concave_polygons_have_their_area(tmp_path):
    path = tmp_path / "ell.usda"
    outline = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)]  # an L of area 5, in the plane of y and z
    for first in range(6):
        stage = Usd.Stage.CreateInMemory()
        mesh = UsdGeom.Mesh.Define(stage, "/ell")
        mesh.CreatePointsAttr([(7, y, z) for y, z in outline])
        mesh.CreateFaceVertexCountsAttr([6])
        mesh.CreateFaceVertexIndicesAttr([(first + k) % 6 for k in range(6)])
        stage.GetRootLayer().Export(str(path))
        read = morula.usd.read_mesh(path)
        assert read.facet_count == 4 and morula.surface_area(read) == pytest.approx(5)


def test_references_lead_to_known_folders(tmp_path):
    (tmp_path / "own" / "below").mkdir(parents=True)
    (tmp_path / "other").mkdir()
    cube = morula.sample_body("bar", 3)
    for place in ("own/below/cube.usda", "other/cube.usda"):
        morula.usd.write_mesh(tmp_path / place, cube)
    (tmp_path / "own" / "link.usda").symlink_to(tmp_path / "other" / "cube.usda")
    (tmp_path / "own" / "middle.usda").write_text('#usda 1.0\n(defaultPrim = "a")\ndef Xform "a" (references = @../other/cube.usda@</morula>) {}\n')

    def scene(reference):
        (tmp_path / "own" / "scene.usda").write_text(f'#usda 1.0\n(defaultPrim = "w")\ndef Xform "w" ({reference}) {{}}\n')
        return tmp_path / "own" / "scene.usda"

    inside = scene(f"references = @{tmp_path / 'own' / 'below' / 'cube.usda'}@</morula>")
    assert morula.usd.read_mesh(inside).facet_count == cube.facet_count
    for reference in (
        f"references = @{tmp_path / 'other' / 'cube.usda'}@</morula>",
        f"payload = @{tmp_path / 'other' / 'cube.usda'}@</morula>",
        "references = @../other/cube.usda@</morula>",
        f"references = @{tmp_path / 'own' / 'link.usda'}@</morula>",
        f"references = @{tmp_path / 'own' / 'middle.usda'}@</a>",
    ):
        file = scene(reference)
        for call in (morula.usd.read_mesh, morula.usd.read_motion, morula.usd.mesh_paths):
            with pytest.raises(OSError, match="other.cube.usda, which lies outside .*own; allow its folder with roots="):
                call(file)
        morula.usd.mesh_paths(file, roots=[tmp_path / "other"])
    file = scene(f"references = @{tmp_path / 'other' / 'cube.usda'}@</morula>")
    assert morula.usd.read_mesh(file, roots=[tmp_path / "other"]).facet_count == cube.facet_count


def test_holes_are_left_out_and_one_of_several_is_named(tmp_path):
    path = tmp_path / "two.usda"
    stage = Usd.Stage.CreateNew(str(path))
    quad(stage, "/one").CreateHoleIndicesAttr([0])
    quad(stage, "/two")
    stage.Save()
    assert morula.usd.mesh_paths(path) == ["/one", "/two"]
    assert morula.usd.read_mesh(path, "/one").facet_count == 4
    assert morula.usd.read_mesh(path, "/two").facet_count == 6
    with pytest.raises(ValueError, match="there are /one, /two; name one with prim="):
        morula.usd.read_mesh(path)
    with pytest.raises(ValueError, match="there is no mesh /three; there are /one, /two"):
        morula.usd.read_mesh(path, "/three")


def test_what_is_no_motion_is_refused(tmp_path):
    path = tmp_path / "bad.usda"
    stage = Usd.Stage.CreateInMemory()
    mesh = quad(stage, "/m")
    mesh.GetFaceVertexIndicesAttr().Set([3, 2, 1, 0, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4], 0)
    mesh.GetFaceVertexIndicesAttr().Set([3, 2, 1, 0, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 4, 0], 1)
    stage.GetRootLayer().Export(str(path))
    with pytest.raises(ValueError, match="change"):
        morula.usd.read_motion(path)
    stage = Usd.Stage.CreateInMemory()
    mesh = quad(stage, "/m")
    mesh.GetPointsAttr().Set(Vt.Vec3fArray(5), 0)
    mesh.GetPointsAttr().Set(Vt.Vec3fArray(6), 1)
    stage.GetRootLayer().Export(str(path))
    with pytest.raises(ValueError, match="5 points at first and 6"):
        morula.usd.read_motion(path)
    quad(stage, "/m").GetFaceVertexCountsAttr().Set([4, 3])
    stage.GetRootLayer().Export(str(path))
    with pytest.raises(ValueError, match="7 corners, and 16 are given"):
        morula.usd.read_mesh(path)
    path.write_text("#usda 1.0\ndef Mesh {")
    with pytest.raises(OSError, match=r"bad\.usda"):
        morula.usd.read_mesh(path)
    path.write_text("#usda 1.0\n")
    with pytest.raises(ValueError, match="no meshes"):
        morula.usd.read_mesh(path)
    with pytest.raises(OSError, match="there is no such file"):
        morula.usd.read_mesh(tmp_path / "none.usda")


def test_what_cannot_be_written_is_refused(model, tmp_path):
    spheres = model.tree.level(1)
    for arguments, words in [
        ({"path": "s.obj", "spheres": spheres}, "USD files end in"),
        ({"path": "s.usda", "spheres": spheres, "kind": "balls"}, "none of points, instances"),
        ({"path": "s.usda", "spheres": spheres, "up": "X"}, "neither Y nor Z"),
        ({"path": "s.usda", "spheres": spheres, "level": 1}, "belongs to a tree"),
        ({"path": "s.usda", "spheres": spheres[:, :3]}, r"\(nodes, 4\)"),
        ({"path": "s.usda", "spheres": spheres * numpy.nan}, "not finite"),
        ({"path": "s.usda", "spheres": spheres * 1e39}, "single precision"),
        ({"path": "s.usda", "spheres": spheres, "frames_per_second": 0}, "not above 0"),
    ]:
        arguments = {**arguments, "path": tmp_path / arguments["path"]}
        with pytest.raises(ValueError, match=words):
            morula.usd.write_spheres(**arguments)
    with pytest.raises(ValueError, match="frames: shape"):
        morula.usd.write_mesh(tmp_path / "m.usda", morula.sample_body("bar", 4), numpy.zeros((2, 3, 3)))
    with pytest.raises(OSError):
        morula.usd.write_spheres(tmp_path / "nowhere" / "s.usda", spheres)
    assert list(tmp_path.iterdir()) == []
